"""Conditions on the faces of the domain for nodal velocities, forces, normals and temperatures.

A face may carry conditions on the whole side or on a circle, rectangle, ... of it, for all materials or one.
They are compiled once into lists of node operations; applying them is one kernel call.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.grid import FACES, Grid, Patch

Array = NDArray[Any]


@dataclass(frozen=True)
class Condition:
    """One condition on a face region.

    Attributes
    ----------
    label : ``Velocity``, ``Symmetric``, ``Temperature`` or ``SD-Type``, a concentration (others have no effect on
        particles).
    kind : ``Dirichlet``, ``Neumann`` or ``symmetry``.
    material : material index, or -1 for all.
    value : (3,) velocity, or a scalar or its gradient in all three places.
    """

    label: str
    kind: str
    material: int
    value: tuple[float, float, float]


@dataclass(frozen=True)
class Region:
    """A part of a face with its conditions; ``shape`` is None for the whole side.

    ``shape(points)`` gives True for the (n, 3) points inside.
    """

    face: str
    conditions: tuple[Condition, ...]
    shape: Any = None


class Operations(NamedTuple):
    """Node operations in order: operation o acts on entries start[o] .. start[o + 1] of ``node`` and ``source``."""

    kind: Array
    axis: Array
    value: Array
    start: Array
    node: Array
    source: Array


SCALARS = ("Temperature", "SD-Type")
"""Labels of scalars, whose gradient may be given in place of their value."""

SET, ZERO_NORMAL, MIRROR, GRADIENT = range(4)
"""Kinds of operation: set to the value; zero the normal component; copy the source with the normal component
negated; scalar of the source node less the value."""


EVERYWHERE = np.ones(0, dtype=np.uint8)
"""In place of a mask of nodes: conditions act at all of them."""


class BoundaryConditions:
    """The conditions of all faces, compiled for each material.

    Parameters
    ----------
    regions : the conditions of the deck in its order.
    grid : the grid.
    materials : number of materials.
    extra_nodes : whether the interpolator uses the layer of extra nodes (all but linear do).
    """

    def __init__(self, regions: Sequence[Region], grid: Grid, materials: int, extra_nodes: bool) -> None:
        self._given = (regions, materials)
        self._grid = grid
        self._extra_nodes = extra_nodes
        self._regions = {face: [r for r in regions if r.face == face] for face in FACES}
        self._operations = {
            (label, m): self._compile(label, m)
            for label in ("Velocity", "Symmetric", *SCALARS)
            for m in range(materials)
        }

    def on(self, grid: Grid) -> BoundaryConditions:
        """The same conditions for another window of the grid."""
        regions, materials = self._given
        return BoundaryConditions(regions, grid, materials, self._extra_nodes)

    def apply_velocity(self, velocity: Array, material: int, touched: Array = EVERYWHERE) -> None:
        """Impose prescribed velocities on nodal vectors (N, 3) in place.

        Here and below, ``touched`` (N or more,) says at which nodes conditions need not act: where it is zero.
        """
        self._run("Velocity", velocity, material, touched)

    def apply_symmetry(self, vectors: Array, material: int, touched: Array = EVERYWHERE) -> None:
        """Make nodal vectors (N, 3) mirror-symmetric about the symmetry faces, in place."""
        self._run("Symmetric", vectors, material, touched)

    def apply_temperature(self, temperature: Array, material: int, touched: Array = EVERYWHERE) -> None:
        """Impose temperatures, or their gradient, on nodal values (N,) in place."""
        self._run("Temperature", temperature.reshape(-1, 1), material, touched)

    def apply_concentration(self, concentration: Array, material: int, touched: Array = EVERYWHERE) -> None:
        """Impose concentrations, or their gradient, on nodal values (N,) in place."""
        self._run("SD-Type", concentration.reshape(-1, 1), material, touched)

    def node_to_cell_weight(self) -> Array:
        """1/8 at every node, doubled for each symmetry face (of material 0) that the node lies on, (N,)."""
        weight = np.full(self._grid.number_of_nodes, 0.125)
        for face in FACES:
            if any(c.kind == "symmetry" for _, c in self._conditions(face, "Symmetric", 0)):
                for patch in self._boundary_patches(face):
                    weight[self._face_nodes(patch, face, extra=False)] *= 2.0
        return weight

    def _run(self, label: str, field: Array, material: int, touched: Array) -> None:
        operations = self._operations[label, material]
        if len(operations.kind):
            self._apply(operations, touched, field)

    @cached_property
    def _apply(self) -> Callable[[Operations, Array, Array], None]:
        from solver.jit.calls import Calls
        from solver.kernels.nodes import apply_operations

        return partial(Calls(), apply_operations)

    def _conditions(self, face: str, label: str, material: int) -> list[tuple[Region, Condition]]:
        """The conditions in force for a material: its own, else those for all materials."""
        found = []
        for region in self._regions[face]:
            own = [c for c in region.conditions if c.label == label and c.material == material]
            common = [c for c in region.conditions if c.label == label and c.material == -1]
            found += [(region, c) for c in (own or common)[-1:]]
        return found

    def _boundary_patches(self, face: str) -> list[Patch]:
        return [p for p in self._grid.patches if not self._grid.has_neighbor(p, face)]

    def _range(self, patch: Patch, extra: bool) -> tuple[list[int], list[int]]:
        """First and past-last node indices that belong to a patch, with its extra nodes or without."""
        low, high = list(patch.low), list(patch.high)
        for axis in range(3):
            layers = self._grid.extra_cells[axis] if extra else 0
            if not self._grid.has_neighbor(patch, FACES[2 * axis]):
                low[axis] -= layers
            if not self._grid.has_neighbor(patch, FACES[2 * axis + 1]):
                high[axis] += 1 + layers
        return low, high

    def _face_nodes(self, patch: Patch, face: str, extra: bool, shift: int = 0) -> Array:
        """Storage indices of the outermost layer of nodes at a face, shifted inwards by ``shift`` layers.

        Those that this rank stores; copies in periodic directions count too.
        """
        low, high = self._range(patch, extra)
        axis, plus = FACES.index(face) // 2, face.endswith("+")
        at = high[axis] - 1 - shift if plus else low[axis] + shift
        low[axis], high[axis] = at, at + 1
        first = self._grid.index.first
        stored = []
        for a in range(3):
            indices = self._grid.node_indices(a)
            stored.append(first[a] + np.flatnonzero((indices >= low[a]) & (indices < high[a])))
        i, j, k = np.meshgrid(*stored, indexing="ij")
        return np.asarray(self._grid.flat(i, j, k)).ravel()

    def _region_nodes(self, patch: Patch, region: Region) -> Array:
        """The face nodes of a region; a whole side leaves out what other regions of the face cover."""
        nodes = self._face_nodes(patch, region.face, extra=False)
        positions = self._grid.node_positions()[nodes]
        if region.shape is not None:
            return nodes[region.shape(positions)]
        covered = np.zeros(len(nodes), dtype=bool)
        for other in self._regions[region.face]:
            if other.shape is not None:
                covered |= other.shape(positions)
        return nodes[~covered]

    def _compile(self, label: str, material: int) -> Operations:
        rows: list[tuple[int, int, tuple[float, float, float], Array, Array]] = []
        for face in FACES:
            for region, condition in self._conditions(face, label, material):
                for patch in self._boundary_patches(face):
                    rows += self._face_operations(patch, region, condition)
        start = np.cumsum([0] + [len(nodes) for *_, nodes, _ in rows])
        empty = np.zeros(0, dtype=np.int64)
        return Operations(
            kind=np.array([r[0] for r in rows], dtype=np.int64),
            axis=np.array([r[1] for r in rows], dtype=np.int64),
            value=np.array([r[2] for r in rows], dtype=np.float64).reshape(-1, 3),
            start=start.astype(np.int64),
            node=np.concatenate([empty] + [r[3] for r in rows]).astype(np.uintp),
            source=np.concatenate([empty] + [r[4] for r in rows]).astype(np.uintp),
        )

    def _face_operations(
        self, patch: Patch, region: Region, condition: Condition
    ) -> list[tuple[int, int, tuple[float, float, float], Array, Array]]:
        face, value = region.face, condition.value
        axis, plus = FACES.index(face) // 2, face.endswith("+")
        zero = (0.0, 0.0, 0.0)
        inner = self._region_nodes(patch, region)
        if condition.kind == "symmetry":
            if not self._extra_nodes:
                return [(ZERO_NORMAL, axis, zero, inner, inner)]
            boundary = self._face_nodes(patch, face, extra=True, shift=1)
            rows = [(ZERO_NORMAL, axis, zero, boundary, boundary)]
            # As in Uintah, the extra nodes above z mirror only where the domain is one cell thick.
            if axis < 2 or not plus or self._range(patch, extra=True)[1][2] == 3:
                outer = self._face_nodes(patch, face, extra=True)
                mirrored = self._face_nodes(patch, face, extra=True, shift=2)
                if len(outer):  # else a rank stores the nodes inside only
                    rows.append((MIRROR, axis, zero, outer, mirrored))
            return rows
        outer = self._face_nodes(patch, face, extra=True) if self._extra_nodes else inner[:0]
        if condition.kind == "Dirichlet":
            return [(SET, axis, value, inner, inner), (SET, axis, value, outer, outer)]
        if condition.kind == "Neumann" and condition.label in SCALARS:
            drop = value[0] * self._grid.spacing[axis]
            first = self._grid.flat(*(int(axis == a) for a in range(3))) - self._grid.flat(0, 0, 0)
            inwards = -first if plus else first
            gradient = (drop, drop, drop)
            return [(GRADIENT, axis, gradient, nodes, nodes + inwards) for nodes in (inner, outer)]
        return []
