"""Cutting the grid into one box of cells for each rank, by recursive bisection."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.creation import GeometryObject
from solver.declare import IntVector
from solver.grid import Grid

Array = NDArray[Any]


class Domain(NamedTuple):
    """The cells low <= (i, j, k) < high that one rank owns."""

    low: IntVector
    high: IntVector

    @property
    def shape(self) -> IntVector:
        """Cells in each direction."""
        return (self.high[0] - self.low[0], self.high[1] - self.low[1], self.high[2] - self.low[2])

    @property
    def size(self) -> int:
        """Number of cells."""
        nx, ny, nz = self.shape
        return nx * ny * nz


CELL_WORK = 0.1
"""Work of a rank for a cell of its own, whether there are particles in it or not, over that for a particle."""

Profile = Callable[[Sequence[Domain]], list[list[Array]]]
"""The work in the layers of cells of some boxes: for each box three arrays, one a direction, of its shape."""


class TooManyRanksError(ValueError):
    """There are more ranks than cells to share out."""


def cut(
    grid: Grid, ranks: int, profile: Profile, along: Sequence[Sequence[int]] | None = None
) -> tuple[Domain, ...]:
    """Boxes of nearly equal work, one a rank, that tile the bounding box of the grid.

    A box for several ranks is cut across the direction in which its work is spread most, in the proportion of the
    ranks of its two parts (Berger and Bokhari, IEEE Trans. Comput. C-36, 1987), until each part has one rank. All
    cuts of a level are found from one call of ``profile``, so that ranks that know only their own particles can
    add theirs up.

    Parameters
    ----------
    grid : the grid.
    ranks : how many boxes.
    profile : the work in layers of cells. Where a box has none, its cells count.
    along : for each direction the indices of nodes at which cuts are wanted, where a box has some inside; None
        for cuts anywhere.

    Raises
    ------
    TooManyRanksError
        where a box would be left without a cell.
    """
    if ranks > grid.cells[0] * grid.cells[1] * grid.cells[2]:
        raise TooManyRanksError(f"{ranks} ranks are more than the {grid.cells} cells of the grid")
    boxes = [(Domain((0, 0, 0), grid.cells), ranks)]
    while any(share > 1 for _, share in boxes):
        many = [box for box, share in boxes if share > 1]
        layers = iter(profile(many))
        parts: list[tuple[Domain, int]] = []
        for box, share in boxes:
            parts += [(box, share)] if share == 1 else _halves(grid, box, share, next(layers), along)
        boxes = parts
    return tuple(box for box, _ in boxes)


def _halves(
    grid: Grid, box: Domain, ranks: int, layers: Sequence[Array], along: Sequence[Sequence[int]] | None
) -> list[tuple[Domain, int]]:
    """Two boxes in place of one, with the ranks of each."""
    first = ranks // 2
    axes = sorted(range(3), key=lambda a: -_spread(layers[a]) * grid.spacing[a])
    for axis in axes:
        cut_at = _place(box, axis, first, ranks, layers[axis], None if along is None else along[axis])
        if cut_at is not None:
            low, high = list(box.low), list(box.high)
            low[axis] = high[axis] = cut_at
            return [
                (Domain(box.low, (high[0], high[1], high[2])), first),
                (Domain((low[0], low[1], low[2]), box.high), ranks - first),
            ]
    if along is not None:
        return _halves(grid, box, ranks, layers, None)
    raise TooManyRanksError(
        f"{ranks} ranks are more than the {box.size} cells of a part of the grid can serve"
    )


def _spread(layer: Array) -> float:
    """How far the work in layers of cells lies from its middle, root mean square, in cells."""
    place, total = np.arange(len(layer)), layer.sum()
    if not total > 0.0:
        return len(layer) / math.sqrt(12.0)
    middle = (layer * place).sum() / total
    return float(np.sqrt((layer * (place - middle) ** 2).sum() / total + 1.0 / 12.0))


def _place(
    box: Domain, axis: int, first: int, ranks: int, layer: Array, wanted: Sequence[int] | None
) -> int | None:
    """Where to cut so that the lower part gets first / ranks of the work; None where it cannot be done.

    Both parts keep at least one cell for each of their ranks.
    """
    low, high = box.low[axis], box.high[axis]
    across = box.size // (high - low)
    least, most = low - (-first // across), high + (-(ranks - first) // across)
    inside = np.arange(max(least, low + 1), min(most, high - 1) + 1)
    if wanted is not None:
        inside = inside[np.isin(inside, wanted)]
    if not len(inside):
        return None
    work = layer if layer.any() else np.ones(high - low)
    below = np.concatenate([[0.0], np.cumsum(work)]) / work.sum()
    return int(inside[np.argmin(np.abs(below[inside - low] - first / ranks))])


def patch_planes(grid: Grid) -> list[list[int]]:
    """For each direction the indices of nodes where patches of the deck meet."""
    return [sorted({patch.low[a] for patch in grid.patches} - {0}) for a in range(3)]


def foreseen_work(
    grid: Grid, objects: Sequence[GeometryObject], boxes: Sequence[Domain]
) -> list[list[Array]]:
    """A :data:`Profile` before there are particles: those that would fill the boxes around the objects' shapes."""
    filled = []
    for body in objects:
        corners = body.shape.bounding_box()
        ends = (np.array([corners.lower, corners.upper]) - grid.anchor) / grid.spacing
        low = np.clip(np.floor(ends[0]), 0, grid.cells).astype(int)
        high = np.clip(np.ceil(ends[1]), 0, grid.cells).astype(int)
        filled.append((low, high, math.prod(body.res)))
    found = []
    for box in boxes:
        layers = [np.full(n, CELL_WORK * box.size / n) for n in box.shape]
        for low, high, number in filled:
            first, last = np.maximum(low, box.low), np.minimum(high, box.high)
            if (first < last).all():
                for axis in range(3):
                    there = slice(first[axis] - box.low[axis], last[axis] - box.low[axis])
                    layers[axis][there] += number * np.prod(np.delete(last - first, axis))
        found.append(layers)
    return found


def imbalance(counts: Sequence[float]) -> float:
    """The largest work of a rank over the mean, 1 where all have the same (or there is none)."""
    total = sum(counts)
    return max(counts) * len(counts) / total if total else 1.0
