"""The background grid: one level of equal cells, made of boxes, cut into patches."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.declare import IntVector, Vector

Array = NDArray[Any]


class GridIndex(NamedTuple):
    """What kernels know of the grid. Node (i, j, k) lies at anchor + (i, j, k) * spacing.

    Nodes are stored flat, x fastest: ``(i - first_x) + nodes_x * ((j - first_y) + nodes_y * (k - first_z))``,
    extra nodes around the domain included, so ``first`` is -1 where there is a layer of extra cells.
    """

    anchor: Vector
    spacing: Vector
    first: IntVector
    nodes: IntVector


class NodeBlock(NamedTuple):
    """The nodes low <= (i, j, k) < high, counted in storage, that one loop adds to."""

    low: IntVector
    high: IntVector
    whole: bool
    """Whether that is all nodes."""


@dataclass(frozen=True)
class Patch:
    """A block of cells low <= (i, j, k) < high, extra cells not included."""

    id: int
    low: IntVector
    high: IntVector


class Window(NamedTuple):
    """The part of a grid that one rank of several holds: its own cells and a halo around them.

    A rank keeps the particles in its own cells, low <= (i, j, k) < high, and the nodes that they can reach: those
    of ``halo`` more layers of cells on every side. In periodic directions indices of nodes go on beyond the domain.
    """

    low: IntVector
    high: IntVector
    halo: int


FACES = ("x-", "x+", "y-", "y+", "z-", "z+")
"""The six faces in the order in which boundary conditions are applied."""


@dataclass(frozen=True)
class Grid:
    """A level of the grid.

    Attributes
    ----------
    anchor : position of node (0, 0, 0).
    spacing : cell sizes.
    cells : number of cells of the bounding box in each direction, extra cells not included.
    extra_cells : layers of cells around the domain that belong to no body, in each direction.
    periodic : 1 in the directions in which the domain repeats, else 0.
    patches : the blocks that tile the domain.
    window : the part that this rank holds, or None for all of it. Only what is stored (``index``,
        ``number_of_nodes``, ``flat``, ``as_box``, ``node_positions``) depends on it.
    """

    anchor: Vector
    spacing: Vector
    cells: IntVector
    extra_cells: IntVector
    periodic: IntVector
    patches: tuple[Patch, ...]
    window: Window | None = None

    @property
    def own_cells(self) -> tuple[IntVector, IntVector]:
        """First and past-last cells of this rank."""
        return ((0, 0, 0), self.cells) if self.window is None else (self.window.low, self.window.high)

    @property
    def ghost(self) -> IntVector:
        """Layers of nodes stored outside the domain: the extra cells, or images where it is periodic."""
        e, p = self.extra_cells, self.periodic
        return (max(e[0], p[0]), max(e[1], p[1]), max(e[2], p[2]))

    @cached_property
    def index(self) -> GridIndex:
        """The view of the grid for kernels."""
        (x0, x1), (y0, y1), (z0, z1) = (self._stored(axis) for axis in range(3))
        return GridIndex(self.anchor, self.spacing, (x0, y0, z0), (x1 - x0, y1 - y0, z1 - z0))

    def _stored(self, axis: int) -> tuple[int, int]:
        """First and past-last stored nodes in a direction."""
        low, high = -self.ghost[axis], self.cells[axis] + self.ghost[axis] + 1
        if self.window is None:
            return low, high
        own_low, own_high = (
            self.window.low[axis] - self.window.halo,
            self.window.high[axis] + self.window.halo + 1,
        )
        if self.periodic[axis]:
            return own_low, own_high
        return max(low, own_low), min(high, own_high)

    def node_indices(self, axis: int) -> Array:
        """Indices of the stored nodes in a direction; a rank's images have the index of the node they repeat."""
        low, high = self._stored(axis)
        indices = np.arange(low, high)
        repeats = self.window is not None and self.periodic[axis]
        return indices % self.cells[axis] if repeats else indices

    @property
    def all_nodes(self) -> NodeBlock:
        """The block of all stored nodes."""
        return NodeBlock((0, 0, 0), self.index.nodes, True)

    @property
    def number_of_nodes(self) -> int:
        """Stored nodes, extra nodes included."""
        nodes = self.index.nodes
        return nodes[0] * nodes[1] * nodes[2]

    @property
    def cell_volume(self) -> float:
        """Volume of a cell."""
        return self.spacing[0] * self.spacing[1] * self.spacing[2]

    @property
    def dimensions(self) -> int:
        """The number of directions with more than one cell."""
        return sum(n > 1 for n in self.cells)

    @property
    def upper(self) -> Vector:
        """The corner of the bounding box opposite to the anchor."""
        a, h, n = self.anchor, self.spacing, self.cells
        return (a[0] + n[0] * h[0], a[1] + n[1] * h[1], a[2] + n[2] * h[2])

    def has_neighbor(self, patch: Patch, face: str) -> bool:
        """Whether another patch (or a periodic image) lies across a face of a patch, even in part."""
        axis, plus = FACES.index(face) // 2, face.endswith("+")
        if self.periodic[axis] and (patch.high[axis] == self.cells[axis] if plus else patch.low[axis] == 0):
            return True
        low, high = list(patch.low), list(patch.high)
        low[axis] = patch.high[axis] if plus else patch.low[axis] - 1
        high[axis] = low[axis] + 1
        return any(
            all(other.low[a] < high[a] and low[a] < other.high[a] for a in range(3)) for other in self.patches
        )

    def flat(self, i: Any, j: Any, k: Any) -> Any:
        """Storage index of node (i, j, k); works on arrays."""
        first, nodes = self.index.first, self.index.nodes
        return (i - first[0]) + nodes[0] * ((j - first[1]) + nodes[1] * (k - first[2]))

    def as_box(self, nodal: Array) -> Array:
        """A view [i, j, k(, component)] of flat nodal values; [0, 0, 0] is the first stored node."""
        nx, ny, nz = self.index.nodes
        box = nodal.reshape((nz, ny, nx, *nodal.shape[1:]))
        return box.transpose((2, 1, 0, *range(3, box.ndim)))

    def node_positions(self) -> Array:
        """Positions of all stored nodes in storage order, shape (nodes, 3)."""
        axes = [self.anchor[axis] + self.node_indices(axis) * self.spacing[axis] for axis in range(3)]
        z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
        return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)

    def cell_of(self, positions: Array) -> Array:
        """Cell indices (n, 3) of positions (n, 3)."""
        relative = (positions - np.array(self.anchor)) / np.array(self.spacing)
        return np.floor(relative).astype(np.int64)

    def owned_nodes(self) -> Array:
        """(N,) True for the nodes that belong to a patch, and for a rank's copies of them."""
        owned = np.zeros(self.number_of_nodes, dtype=np.bool_)
        box = self.as_box(owned)
        for patch in self.patches:
            inside = []
            for axis in range(3):
                indices = self.node_indices(axis)
                last = patch.high[axis] - int(self.has_neighbor(patch, FACES[2 * axis + 1]))
                inside.append(np.flatnonzero((indices >= patch.low[axis]) & (indices <= last)))
            box[np.ix_(*inside)] = True
        return owned

    def inner_nodes(self) -> Array:
        """(N,) True for the nodes strictly inside the bounding box."""
        x, y, z = (
            (self.node_indices(axis) > 0) & (self.node_indices(axis) < self.cells[axis]) for axis in range(3)
        )
        return np.asarray(z[:, None, None] & y[:, None] & x).ravel()

    def owned_cells(self) -> Array:
        """True for the cells that belong to a patch, x fastest; takes no memory where all do."""
        nx, ny, nz = self.cells
        if (
            sum(math.prod(b - a for a, b in zip(p.low, p.high, strict=True)) for p in self.patches)
            == nx * ny * nz
        ):
            return np.broadcast_to(np.array([True]), nx * ny * nz)
        owned = np.zeros((nz, ny, nx), dtype=np.bool_)
        for patch in self.patches:
            x, y, z = (slice(a, b) for a, b in zip(patch.low, patch.high, strict=True))
            owned[z, y, x] = True
        return owned.ravel()
