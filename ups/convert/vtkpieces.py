"""Files of VTK XML that hold data: the particles of a time step, or a box of cells of a level of the grid."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from ups.archive import Box, GridField, Level, Variable
from ups.archive.markup import attributes, number
from ups.archive.reader import PART
from ups.archive.variables import ELEMENTS, FACES, NODE
from ups.convert.glyphs import box_corners
from ups.convert.selection import ParticleSet, Selection, plain_title
from ups.convert.vtkxml import Array, counting, save

_HEXAHEDRON, _VERTEX = 12, 1
"""VTK's numbers of these cells."""

HIDDEN = 32
"""VTK's mark of a cell that is not shown."""


def write_vertices(path: Path, particles: ParticleSet, time: float, threads: int) -> None:
    """Write the particles of a time step as vertices, of a PolyData."""
    count = sum(particles.counts)
    piece = attributes(
        NumberOfPoints=count, NumberOfVerts=count, NumberOfLines=0, NumberOfStrips=0, NumberOfPolys=0
    )
    body = [
        "<PolyData>",
        f"<Piece{piece}>",
        *_data("PointData", particles),
        *_points(count, particles.position_parts),
        "<Verts>",
        counting("connectivity", 0, count),
        counting("offsets", 1, count + 1),
        "</Verts>",
        "</Piece>",
        "</PolyData>",
    ]
    save(path, "PolyData", body, time, threads)


def write_cells(path: Path, particles: ParticleSet, time: float, threads: int, *, boxes: bool) -> None:
    """Write the particles of a time step as an UnstructuredGrid, of vertices or of the boxes that they fill."""
    count, corners = sum(particles.counts), 8 if boxes else 1
    kind = _HEXAHEDRON if boxes else _VERTEX

    def types() -> Iterator[np.ndarray]:
        return (np.full(len(part), kind, dtype=np.uint8) for part in particles.material_parts())

    def corner_parts() -> Iterator[np.ndarray]:
        for centres, edges in zip(particles.position_parts(), particles.edge_parts(), strict=True):
            yield box_corners(centres, edges)

    body = [
        "<UnstructuredGrid>",
        f"<Piece{attributes(NumberOfPoints=corners * count, NumberOfCells=count)}>",
        *_data("CellData" if boxes else "PointData", particles),
        *_points(corners * count, corner_parts if boxes else particles.position_parts),
        "<Cells>",
        counting("connectivity", 0, corners * count),
        counting("offsets", corners, corners * count + 1, corners),
        Array("types", np.dtype(np.uint8), count, 1, types),
        "</Cells>",
        "</Piece>",
        "</UnstructuredGrid>",
    ]
    save(path, "UnstructuredGrid", body, time, threads)


def _points(count: int, parts: Callable[[], Iterator[np.ndarray]]) -> list[str | Array]:
    names = ELEMENTS["Point"].component_names
    return ["<Points>", Array("Points", np.dtype(float), count, 3, parts, names), "</Points>"]


def _data(tag: str, particles: ParticleSet) -> list[str | Array]:
    """Material and selected variables of particles; the first vector and tensor are those of the data set."""
    count = sum(particles.counts)
    arrays = [Array("material", np.dtype(np.int32), count, 1, particles.material_parts)]
    arrays += [
        _array(v, plain_title(v.name), count, partial(particles.value_parts, v)) for v in particles.variables
    ]
    active = {
        role: plain_title(variable.name)
        for role, element in (("Tensors", "Matrix3"), ("Vectors", "Vector"))
        for variable in reversed(particles.variables)
        if variable.element == element
    }
    return [f"<{tag}{attributes(**active)}>", *arrays, f"</{tag}>"]


def _array(variable: Variable, name: str, rows: int, parts: Callable[[], Iterator[np.ndarray]]) -> Array:
    element = variable.element_type
    dtype = element.dtype.newbyteorder("=")
    return Array(name, dtype, rows, element.components, parts, element.component_names)


def write_grid(
    path: Path, fields: LevelFields, cells: Box, time: float, threads: int, *, alone: bool = True
) -> None:
    """Write the grid variables in a box of cells of a level as an image with node and cell data.

    An image that stands alone has the indices of the level and marks its hidden cells; in a hierarchy readers
    expect it to begin at the index zero, and mark cells themselves.
    """
    nodes: list[Array] = []
    inside: list[Array] = []
    for variable, material in fields.found:
        name = f"{plain_title(variable.name)}_{material}"
        at_nodes = variable.container == NODE
        i, j, k = (length + at_nodes for length in cells.shape)
        parts = partial(_slabs, fields, variable, material, cells)
        (nodes if at_nodes else inside).append(_array(variable, name, i * j * k, parts))
    level = fields.level
    if alone and (hidden := hidden_cells(fields.levels, level, cells)).any():
        marks = (HIDDEN * hidden).astype(np.uint8).transpose(2, 1, 0).reshape(-1)
        inside.append(Array("vtkGhostType", marks.dtype, marks.size, 1, lambda: [marks]))
    corner, ends = level.anchor, cells
    if not alone:
        corner, ends = level.bounds(cells)[0], Box((0, 0, 0), cells.shape)
    extent = " ".join(f"{a} {b}" for a, b in zip(*ends, strict=True))
    origin, spacing = (" ".join(map(number, triple)) for triple in (corner, level.spacing))
    body: list[str | Array] = [
        f"<ImageData{attributes(WholeExtent=extent, Origin=origin, Spacing=spacing)}>",
        f"<Piece{attributes(Extent=extent)}>",
        "<PointData>",
        *nodes,
        "</PointData>",
        "<CellData>",
        *inside,
        "</CellData>",
        "</Piece>",
        "</ImageData>",
    ]
    save(path, "ImageData", body, time, threads)


class LevelFields:
    """The selected grid variables of a level at a time step.

    Attributes
    ----------
    level, levels
        The level, and all of the grid.
    found
        Variables and materials.
    """

    def __init__(self, selection: Selection, step: int, level: Level, *, keep: bool = False) -> None:
        self.level = level
        self.levels = selection.archive.grid(step).levels
        self.found = [
            (variable, material)
            for variable in selection.variables
            if variable.is_grid
            for material in selection.materials_of(step, variable.name, level.index)
        ]
        self._read = partial(selection.archive.grid_variable, step)
        self._kept: dict[tuple[str, int], GridField] | None = {} if keep else None

    def __call__(self, variable: Variable, material: int) -> GridField:
        """Read a variable, or take what was read where it is kept for several boxes."""
        key = variable.name, material
        if self._kept is None:
            return self._read(*key, self.level.index)
        if key not in self._kept:
            self._kept[key] = self._read(*key, self.level.index)
        return self._kept[key]


def _slabs(fields: LevelFields, variable: Variable, material: int, cells: Box) -> Iterator[np.ndarray]:
    """Values of a variable in a box of cells, some layers at a time, indexed [z, y, x, ...]."""
    found, (low, high) = fields(variable, material), cells
    layers = max(1, PART // (cells.shape[0] * cells.shape[1]))
    for bottom in range(low[2], high[2], layers):
        top = min(bottom + layers, high[2])
        values = interior_values(found, Box((*low[:2], bottom), (*high[:2], top)))
        if variable.container == NODE and top < high[2]:
            values = values[:, :, :-1]  # the next layers have these nodes, too
        yield values.transpose(2, 1, 0, *range(3, values.ndim))


def interior_values(grid_field: GridField, cells: Box) -> np.ndarray:
    """Values at the nodes of a box of cells of the interior, or in them; of faces the mean of a cell's two."""
    container, origin = grid_field.variable.container, grid_field.origin
    faces = FACES.index(container) if container in FACES else None
    values = grid_field.values
    for axis in (2, 1, 0):
        first = cells.low[axis] - origin[axis]
        last = cells.high[axis] + (container == NODE or axis == faces) - origin[axis]
        before = (slice(None),) * axis
        wraps = last > values.shape[axis]  # the far end of a periodic axis is stored at the near one only
        near = values[(*before, slice(0, 1))]
        values = values[(*before, slice(first, last))]
        if wraps:
            values = np.concatenate([values, near], axis=axis)
    if faces is None:
        return values
    before = (slice(None),) * faces
    behind, ahead = values[(*before, slice(None, -1))], values[(*before, slice(1, None))]
    return (behind / 2 + ahead / 2).astype(values.dtype)


def hidden_cells(levels: Sequence[Level], level: Level, cells: Box) -> np.ndarray:
    """Whether each cell of a box is in no patch of its level, or in one of a finer level; indexed [x, y, z]."""
    hidden = np.ones(cells.shape, dtype=bool)

    def mark(low: Sequence[int], high: Sequence[int], value: bool) -> None:
        ends = (
            slice(max(0, a - first), max(0, b - first))
            for a, b, first in zip(low, high, cells.low, strict=True)
        )
        hidden[tuple(ends)] = value

    for patch in level.patches:
        mark(patch.low, patch.high, False)
    for finer in levels[level.index + 1 :]:
        ratio = np.rint(np.array(level.spacing) / finer.spacing).astype(int)
        for patch in finer.patches:
            mark((np.array(patch.low) // ratio).tolist(), (np.array(patch.high) // ratio).tolist(), True)
    return hidden
