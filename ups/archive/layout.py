"""The grid of an archive: levels, patches, and which cells, nodes and faces each patch stores.

A level is a regular lattice of cells cut into patches. A patch stores the values of its own
interior and, where it touches the edge of the level, of the extra cells outside; it never stores
a neighbour's. What lies between two patches, a node or a face, is stored once, by the patch on
its plus side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ups.archive.variables import CELL, FACES, NODE

IntVector = tuple[int, int, int]
FloatVector = tuple[float, float, float]

_OUTER_LAYER: dict[str, IntVector] = {
    CELL: (0, 0, 0),
    NODE: (1, 1, 1),
    FACES[0]: (1, 0, 0),
    FACES[1]: (0, 1, 0),
    FACES[2]: (0, 0, 1),
}
"""Layers beyond the last cell that close a box of cells, by container and axis."""


class Box(NamedTuple):
    """A half-open box of indices: `low` is inside, `high` is not."""

    low: IntVector
    high: IntVector

    @property
    def shape(self) -> IntVector:
        """Number of indices along each axis."""
        lo, hi = self.low, self.high
        return hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]

    @property
    def size(self) -> int:
        """Number of indices inside."""
        nx, ny, nz = self.shape
        return nx * ny * nz

    def within(self, origin: IntVector) -> tuple[slice, slice, slice]:
        """Slices that pick this box out of an array whose first element has the index `origin`."""
        lo, hi, o = self.low, self.high, origin
        return (
            slice(lo[0] - o[0], hi[0] - o[0]),
            slice(lo[1] - o[1], hi[1] - o[1]),
            slice(lo[2] - o[2], hi[2] - o[2]),
        )

    def split(self, parts: IntVector) -> list[Box]:
        """Cut the box into ``parts`` boxes along each axis, in the order of Uintah's patches.

        The cuts are at the integer part of ``i * cells / parts``; the last axis runs fastest.
        """
        cuts = [
            [low + (high - low) * i // n for i in range(n + 1)]
            for low, high, n in zip(self.low, self.high, parts, strict=True)
        ]
        return [
            Box((cuts[0][i], cuts[1][j], cuts[2][k]), (cuts[0][i + 1], cuts[1][j + 1], cuts[2][k + 1]))
            for i in range(parts[0])
            for j in range(parts[1])
            for k in range(parts[2])
        ]


@dataclass(frozen=True)
class Patch:
    """A box of cells of one level, owned by one process.

    Attributes
    ----------
    id
        Number of the patch; ascending without gaps on a level and unique over the levels.
    proc
        Rank that owns the patch, and so the number of the data file that holds it.
    low, high
        First cell inside and first cell beyond, extra cells excluded.
    """

    id: int
    proc: int
    low: IntVector
    high: IntVector

    @property
    def interior(self) -> Box:
        """The cells of the patch, extra cells excluded."""
        return Box(self.low, self.high)


@dataclass(frozen=True)
class Level:
    """A regular lattice of cells, cut into patches.

    Attributes
    ----------
    index
        Position among the levels of the grid, the coarsest being 0.
    anchor
        Position of the node (0, 0, 0).
    spacing
        Edge lengths of a cell.
    extra_cells
        Layers of cells beyond the edge of the level, by axis.
    periodic
        Axes along which the level continues on its other side.
    patches
        Patches by ascending number.

    Raises
    ------
    ValueError
        Where there is no patch, a number is missing or out of order, a patch is empty, patches
        overlap, a spacing is not positive, or extra cells lie along a periodic axis.
    """

    index: int
    anchor: FloatVector
    spacing: FloatVector
    extra_cells: IntVector
    periodic: tuple[bool, bool, bool]
    patches: tuple[Patch, ...]
    _owners: _OwnerTable = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        where = f"level {self.index}"
        if not self.patches:
            raise ValueError(f"{where} has no patch")
        if not all(np.isfinite(self.anchor)) or not all(0.0 < h < np.inf for h in self.spacing):
            raise ValueError(f"{where}: anchor {self.anchor} or cell spacing {self.spacing} is not usable")
        if any(e < 0 or (e > 0 and p) for e, p in zip(self.extra_cells, self.periodic, strict=True)):
            raise ValueError(
                f"{where}: extra cells {self.extra_cells} along the periodic axes {self.periodic}"
            )
        first = self.patches[0].id
        for position, patch in enumerate(self.patches):
            if patch.id != first + position:
                raise ValueError(f"{where}: patch {patch.id} stands where patch {first + position} is due")
            if patch.proc < 0 or min(patch.interior.shape) < 1:
                raise ValueError(f"{where}: patch {patch.id} is empty or owned by the process {patch.proc}")
        object.__setattr__(self, "_owners", _OwnerTable.build(self))  # finds overlaps, too

    @cached_property
    def _lows(self) -> np.ndarray:
        return np.array([patch.low for patch in self.patches], dtype=np.int64)

    @cached_property
    def _highs(self) -> np.ndarray:
        return np.array([patch.high for patch in self.patches], dtype=np.int64)

    @cached_property
    def interior(self) -> Box:
        """The smallest box around all patches, extra cells excluded."""
        return _around([patch.interior for patch in self.patches])

    @cached_property
    def neighbours(self) -> np.ndarray:
        """Whether a patch of this level lies beyond a face, by patch position, axis and side (low, high).

        A face has a neighbour where any cell of the layer just outside it, within the patch's own
        cross-section, belongs to a patch of the level; across a periodic edge that may be the patch
        itself. Boolean array of shape (patches, 3, 2).
        """
        found = np.zeros((len(self.patches), 3, 2), dtype=bool)
        period = self.interior.shape
        for position, patch in enumerate(self.patches):
            for axis in range(3):
                for side, layer in enumerate((patch.low[axis] - 1, patch.high[axis])):
                    shifts = (0, period[axis], -period[axis]) if self.periodic[axis] else (0,)
                    found[position, axis, side] = any(
                        self._touches(patch, axis, layer + shift) for shift in shifts
                    )
        return found

    def _touches(self, patch: Patch, axis: int, layer: int) -> bool:
        """Whether any patch holds a cell of the cross-section of `patch` moved to `layer` of `axis`."""
        low, high = np.array(patch.low), np.array(patch.high)
        low[axis], high[axis] = layer, layer + 1
        return bool(np.all((self._lows < high) & (self._highs > low), axis=1).any())

    def extent(self, position: int, container: str, extra_cells: IntVector | None = None) -> Box:
        """Box of the cells, nodes or faces that one patch stores.

        Parameters
        ----------
        position
            Position of the patch in `patches`.
        container
            One of `ups.archive.variables.GRID_CONTAINERS`.
        extra_cells
            Layers to use in place of the level's own, for a variable with its own boundary layer.
        """
        if extra_cells is None:
            return self._stored[container][position]
        return self._extent(position, container, extra_cells)

    @cached_property
    def _stored(self) -> dict[str, list[Box]]:
        """Box of each patch by container, with the level's own extra cells."""
        everywhere = range(len(self.patches))
        return {
            container: [self._extent(position, container, self.extra_cells) for position in everywhere]
            for container in _OUTER_LAYER
        }

    def _extent(self, position: int, container: str, layers: IntVector) -> Box:
        patch, neighbour = self.patches[position], self.neighbours[position]
        closing = _OUTER_LAYER[container]
        low = [patch.low[d] - (0 if neighbour[d, 0] else layers[d]) for d in range(3)]
        high = [patch.high[d] + (0 if neighbour[d, 1] else layers[d] + closing[d]) for d in range(3)]
        return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))

    def whole(self, container: str, extra_cells: IntVector | None = None, rank: int | None = None) -> Box:
        """Smallest box around what all patches store: the shape of an array over the level.

        Parameters
        ----------
        container, extra_cells
            As for `extent`.
        rank
            Only the patches of this rank, which must own one; None for all.
        """
        if extra_cells is None and rank is None:
            return self._whole[container]
        return _around([self.extent(p, container, extra_cells) for p in self.positions_of(rank)])

    def positions_of(self, rank: int | None) -> list[int]:
        """Positions in `patches` of those that a rank owns; of all for None."""
        return [p for p, patch in enumerate(self.patches) if rank in (None, patch.proc)]

    @cached_property
    def _whole(self) -> dict[str, Box]:
        return {container: _around(boxes) for container, boxes in self._stored.items()}

    @property
    def total_cells(self) -> int:
        """Cells of all patches, extra cells included."""
        return sum(self.extent(position, CELL).size for position in range(len(self.patches)))

    def bounds(self, box: Box) -> tuple[FloatVector, FloatVector]:
        """Positions of the lower and upper corner of a box of cells."""
        a, h = self.anchor, self.spacing
        low, high = box.low, box.high
        return (
            (a[0] + low[0] * h[0], a[1] + low[1] * h[1], a[2] + low[2] * h[2]),
            (a[0] + high[0] * h[0], a[1] + high[1] * h[1], a[2] + high[2] * h[2]),
        )

    def coordinates(self, container: str, box: Box) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions along each axis of the nodes, cell centres or face centres in a box of indices."""
        closing = _OUTER_LAYER[container]
        x, y, z = (
            self.anchor[d]
            + (np.arange(box.low[d], box.high[d]) + (0.0 if closing[d] else 0.5)) * self.spacing[d]
            for d in range(3)
        )
        return x, y, z

    def patch_of_position(self, points: np.ndarray) -> np.ndarray:
        """Patch whose interior holds each point, as a position in `patches`; -1 where none does.

        A point belongs to the cell ``floor((point - anchor) / spacing)``.

        Parameters
        ----------
        points
            Positions, shape (n, 3).
        """
        return self._owners.lookup(self._cells(points))

    def nearest_patch(self, points: np.ndarray) -> np.ndarray:
        """Like `patch_of_position`, a point beyond the level's edge taken as in the cell next to it.

        Only a point that is not a number, or in a hole of the level, has no patch (-1).
        """
        last = np.array(self.interior.high) - 1
        return self._owners.lookup(np.clip(self._cells(points), self.interior.low, last))

    def _cells(self, points: np.ndarray) -> np.ndarray:
        return np.floor((points - np.array(self.anchor)) / np.array(self.spacing))


def _around(boxes: Sequence[Box]) -> Box:
    """Smallest box that holds all of `boxes`."""
    low, high = (
        np.min([box.low for box in boxes], axis=0).tolist(),
        np.max([box.high for box in boxes], axis=0).tolist(),
    )
    return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))


class _OwnerTable(NamedTuple):
    """Which patch owns a cell: a table over the boxes between the planes that bound patches."""

    cuts: tuple[np.ndarray, np.ndarray, np.ndarray]
    table: np.ndarray

    @classmethod
    def build(cls, level: Level) -> _OwnerTable:
        cuts = tuple(
            np.array(sorted({cut for p in level.patches for cut in (p.low[d], p.high[d])})) for d in range(3)
        )
        table = np.full([len(cut) - 1 for cut in cuts], -1, dtype=np.int32)
        for position, patch in enumerate(level.patches):
            i, j, k = (np.searchsorted(cuts[d], (patch.low[d], patch.high[d])) for d in range(3))
            owned = table[i[0] : i[1], j[0] : j[1], k[0] : k[1]]
            if (owned >= 0).any():
                other = level.patches[int(owned.max())].id
                raise ValueError(f"level {level.index}: the patches {patch.id} and {other} overlap")
            owned[...] = position
        return cls((cuts[0], cuts[1], cuts[2]), table)

    def lookup(self, cells: np.ndarray) -> np.ndarray:
        """Patch of each cell, given as floats of shape (n, 3); -1 where there is none (or a NaN)."""
        slots = [np.searchsorted(cut, cells[:, d], side="right") - 1 for d, cut in enumerate(self.cuts)]
        inside = np.ones(len(cells), dtype=bool)
        for slot, cut in zip(slots, self.cuts, strict=True):
            inside &= (slot >= 0) & (slot < len(cut) - 1)
        owner = np.full(len(cells), -1, dtype=np.int64)
        owner[inside] = self.table[slots[0][inside], slots[1][inside], slots[2][inside]]
        return owner


@dataclass(frozen=True)
class Grid:
    """The levels of a grid, the coarsest first.

    Raises
    ------
    ValueError
        Where there is no level or a level's index is not its position.
    """

    levels: tuple[Level, ...]

    def __post_init__(self) -> None:
        if not self.levels:
            raise ValueError("a grid needs a level")
        for position, level in enumerate(self.levels):
            if level.index != position:
                raise ValueError(f"level {level.index} stands where level {position} is due")

    @classmethod
    def single_level(
        cls,
        boxes: Sequence[Box],
        *,
        spacing: FloatVector,
        anchor: FloatVector = (0.0, 0.0, 0.0),
        extra_cells: IntVector = (0, 0, 0),
        periodic: tuple[bool, bool, bool] = (False, False, False),
        procs: int = 1,
    ) -> Grid:
        """Grid of one level whose patches are `boxes`, numbered in order and dealt to `procs` ranks in runs.

        >>> grid = Grid.single_level(Box((0, 0, 0), (20, 20, 1)).split((2, 2, 1)), spacing=(0.05, 0.05, 0.05))
        >>> grid.levels[0].extent(0, NODE)
        Box(low=(0, 0, 0), high=(10, 10, 2))
        """
        patches = tuple(
            Patch(number, number * procs // len(boxes), box.low, box.high) for number, box in enumerate(boxes)
        )
        return cls((Level(0, anchor, spacing, extra_cells, periodic, patches),))

    @property
    def number_of_processes(self) -> int:
        """One more than the highest rank that owns a patch."""
        return 1 + max(patch.proc for level in self.levels for patch in level.patches)
