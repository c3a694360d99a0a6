"""Making the particles of a material: where they lie, how large they are, and what they start with.

A body is filled cell by cell with a regular lattice of ``res`` points a cell; points inside the body become
particles. Pieces that list particles of their own (particle files, smooth cylinders) are taken as they come.
Particles are made in the order patch, object, cell (x fastest), sub-position (z fastest), as in Uintah, so
that the counter in a particle's id and everything drawn at random agree.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.declare import IntVector, Parameter, SubModel, Vector
from solver.geometry.piece import GeometryPiece, ParticleSource, as_vector, check_declared_bounds
from solver.geometry.tri import Tri
from solver.geometry.union import Union
from solver.grid import Grid, Patch
from solver.materials.constitutive import Material
from solver.particles import Particles, new_arrays
from solver.random import Births

Array = NDArray[Any]

LATTICE_BLOCK = 2_000_000
"""Lattice points that are tested at a time, which bounds the memory that filling a body takes."""


@dataclass(frozen=True)
class GeometryObject:
    """A body of a material (``<geom_object>``): its shape, how finely it is filled, and its initial state."""

    pieces: Annotated[tuple[Any, ...], SubModel("geometry", many=True)]
    res: Annotated[IntVector, Parameter("particles a cell in each direction", ge=1)]
    velocity: Annotated[Vector, Parameter("initial velocity", unit="m/s")]
    temperature: Annotated[float, Parameter("initial temperature", unit="K")]
    color: Annotated[float, Parameter("number that particles carry along, to tell them apart")] = 0.0
    volume_fraction: Annotated[
        float,
        Parameter("share of the particles' volume that is material", tag="volumeFraction", gt=0.0),
    ] = 1.0
    filling_levels: Annotated[
        int,
        Parameter(
            "sizes of particle, each half the one before, that fill the gaps at the surface; if negative, "
            "particles that stick out are replaced by smaller ones too",
            tag="numLevelsParticleFilling",
        ),
    ] = 1
    map_row_x: Annotated[
        Vector,
        Parameter("first row of A in the map x -> A x + b of the particles", tag="affineTransformation_A0"),
    ] = (1.0, 0.0, 0.0)
    map_row_y: Annotated[
        Vector, Parameter("second row of A in the map x -> A x + b", tag="affineTransformation_A1")
    ] = (0.0, 1.0, 0.0)
    map_row_z: Annotated[
        Vector, Parameter("third row of A in the map x -> A x + b", tag="affineTransformation_A2")
    ] = (0.0, 0.0, 1.0)
    map_shift: Annotated[
        Vector, Parameter("b in the map x -> A x + b", unit="m", tag="affineTransformation_b")
    ] = (0.0, 0.0, 0.0)
    concentration: Annotated[float, Parameter("concentration of a diffusing substance at the start")] = 0.0
    level: Annotated[int, Parameter("level of the grid", ignored="there is one level")] = 0
    density: Annotated[
        float, Parameter("density of a gas", unit="kg/m^3", ignored="the material gives its density")
    ] = 0.0
    pressure: Annotated[
        float, Parameter("pressure of a gas", unit="Pa", ignored="the material starts free of stress")
    ] = 0.0
    name: Annotated[
        str, Parameter("a name for the reader", attribute=True, ignored="it is for the reader of the deck")
    ] = ""

    def __post_init__(self) -> None:
        check_declared_bounds(self)
        if not self.pieces:
            raise ValueError("the geom_object has no shape in it")
        own = [isinstance(piece, ParticleSource) for piece in self.pieces]
        if any(own) and not all(own):
            raise ValueError(
                "pieces that list their own particles (file, smoothcyl) need a geom_object of their own"
            )
        if np.linalg.det(self.map) <= 0.0:
            raise ValueError("the affineTransformation turns particles inside out: det A must be positive")

    @property
    def shape(self) -> GeometryPiece:
        """The body as one piece."""
        piece: GeometryPiece = self.pieces[0] if len(self.pieces) == 1 else Union(self.pieces)
        return piece

    @property
    def map(self) -> Array:
        """The matrix A of the affine transformation, (3, 3)."""
        return np.array([self.map_row_x, self.map_row_y, self.map_row_z])

    @property
    def moves_particles(self) -> bool:
        """Whether the affine transformation is another than x -> x."""
        return not np.array_equal(self.map, np.eye(3)) or any(self.map_shift)

    def spacing(self, grid: Grid) -> Vector:
        """Distance between particles in each direction, before any transformation."""
        h, res = grid.spacing, self.res
        return (h[0] / res[0], h[1] / res[1], h[2] / res[2])


class ParticleIds:
    """Gives particles their ids: the cell in which a particle is born, and its number among those born there.

    id = number + 2^16 i + 2^32 j + 2^48 k for cell (i, j, k). One object serves all materials of a run.
    """

    LARGEST_NUMBER = 0xFFFF

    def __init__(self, grid: Grid) -> None:
        self._grid = grid
        low, high = (np.array(corner) for corner in grid.own_cells)
        self.born = np.zeros(np.prod(high - low), np.int32)
        """Particles born so far in each cell of this rank, x fastest."""

    def assign(self, positions: Array) -> Array:
        """Ids (n,) for particles born at positions (n, 3), in this order; ValueError if a cell is full."""
        i, j, k = self._grid.cell_of(positions).T
        low, high = self._grid.own_cells
        nx, ny = high[0] - low[0], high[1] - low[1]
        cell = (i - low[0]) + nx * ((j - low[1]) + ny * (k - low[2]))
        order = np.argsort(cell, kind="stable")
        cells, first, count = np.unique(cell[order], return_index=True, return_counts=True)
        number = np.empty(len(cell), np.int64)
        number[order] = np.arange(len(cell)) - np.repeat(first, count) + np.repeat(self.born[cells], count)
        self.born[cells] += count.astype(np.int32)
        if len(cells) and self.born[cells].max() > self.LARGEST_NUMBER + 1:
            raise ValueError(
                f"more than {self.LARGEST_NUMBER + 1} particles in a cell: lower <res>, or refine the grid"
            )
        return number | (i << 16) | (j << 32) | (k << 48)


class Creation(NamedTuple):
    """The particles of a material, and what is known of how they were made."""

    particles: Particles
    object: Array
    """(n,) which geom_object made a particle, counted from 0."""
    spacing: Array
    """(objects, 3) particle spacing of each geom_object."""
    patch: Array | Births
    """(n,) id of the patch in which a particle was born; where a rank makes only the particles of its own cells,
    with their numbers there."""
    loadable: Array
    """(n,) where load curves may take hold: on the surface of bodies that were filled, and anywhere in pieces
    that list their own particles, unless they list the load curves too."""
    normal: Array
    """(n, 3) surface normals that a particle file gave, else 0."""
    concentration: Array
    """(n,) of a diffusing substance, at the start."""


class _Filled(NamedTuple):
    """Lattice points that become particles."""

    position: Array
    """(n, 3) before any affine transformation."""
    level: Array
    """(n,) filling level: 0 for particles of the full size, then half as large on each level."""
    surface: Array
    """(n,) 1.0 at the surface, if that is looked for, else 0.0."""


class _Batch(NamedTuple):
    """Particles of one object; ``listed`` holds what the piece itself said of them, by name."""

    position: Array
    size: Array
    volume: Array
    patch: Array
    surface: Array
    loadable: Array
    listed: dict[str, Array]


def create_particles(
    objects: Sequence[GeometryObject],
    grid: Grid,
    material: Material,
    ids: ParticleIds,
    *,
    axisymmetric: bool = False,
    tetrahedral: bool = False,
    find_surface: bool = False,
) -> Creation:
    """Make the particles of a material that lie in the cells of this rank.

    Parameters
    ----------
    objects : the bodies of the material.
    grid : the grid whose cells are filled.
    material : gives the density.
    ids : counts the particles born in each cell; shared by all materials, which are made in deck order.
    axisymmetric : x is a radius, and volumes are those of one radian.
    tetrahedral : particle vectors in files span tetrahedra (the cpti interpolator).
    find_surface : mark the particles at the surface of bodies, for load curves and for contact.

    Raises
    ------
    ValueError
        If particles would lie outside the grid, or on the wrong side of the axis, or a cell is too full.
    """
    options = (axisymmetric, tetrahedral, find_surface)
    batches = _batches(objects, grid, *options)
    owner = np.repeat(np.arange(len(batches), dtype=np.int32), [len(b.position) for b in batches])
    patch = np.concatenate([b.patch for b in batches]) if batches else np.zeros(0, np.int32)
    # Patches are the outer loop: a stable sort moves patches together and keeps the rest.
    order = _patch_by_patch(patch, grid)
    particles, normal, concentration = _initial_state(batches, objects, material, order)
    particles.id[...] = ids.assign(particles.position)
    places: Any = np.array([p.id for p in grid.patches], np.int32)[patch[order]]
    if grid.window is not None:
        places = Births(places, lambda: _numbers(objects, grid, *options))
    return Creation(
        particles,
        owner[order],
        np.array([body.spacing(grid) for body in objects]).reshape(-1, 3),
        places,
        np.concatenate([b.loadable for b in batches])[order] if batches else np.zeros(0, bool),
        normal,
        concentration,
    )


def _batches(
    objects: Sequence[GeometryObject], grid: Grid, axisymmetric: bool, tetrahedral: bool, find_surface: bool
) -> list[_Batch]:
    """The particles of each object, in the order of creation but for the patches."""
    in_rows = all(isinstance(p, Tri) for o in objects for p in o.pieces) and not any(
        abs(o.filling_levels) > 1 for o in objects
    )
    batches = []
    for body in objects:
        if isinstance(body.pieces[0], ParticleSource):
            batch = _listed_particles(body, grid, axisymmetric, tetrahedral, find_surface)
        else:
            batch = _filled_particles(body, grid, axisymmetric, find_surface, in_rows)
        batches.append(batch if grid.window is None else _only_own(batch, grid))
    return batches


def _only_own(batch: _Batch, grid: Grid) -> _Batch:
    """The particles in the cells of this rank."""
    own = np.flatnonzero(_in_own_cells(batch.position, grid))
    return batch._replace(
        **{name: getattr(batch, name)[own] for name in _Batch._fields if name != "listed"},
        listed={name: values[own] for name, values in batch.listed.items()},
    )


def _in_own_cells(positions: Array, grid: Grid) -> Array:
    low, high = grid.own_cells
    cells = grid.cell_of(positions)
    return np.asarray(((cells >= low) & (cells < high)).all(axis=1))


def _patch_by_patch(patch: Array, grid: Grid) -> Any:
    """The order in which particles are kept, given the index of the patch of each."""
    return np.argsort(patch, kind="stable") if len(grid.patches) > 1 else slice(None)


def _numbers(objects: Sequence[GeometryObject], grid: Grid, *options: bool) -> tuple[Array, Array]:
    """For the particles of this rank their numbers in their patch, and among all particles of the material.

    All particles are made for that, and forgotten.
    """
    whole = replace(grid, window=None)
    batches = _batches(objects, whole, *options)
    if not batches:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    patch = np.concatenate([b.patch for b in batches])
    order = _patch_by_patch(patch, grid)
    patch = patch[order]
    overall = np.arange(len(patch))
    own = _in_own_cells(np.concatenate([b.position for b in batches])[order], grid)
    return (overall - np.searchsorted(patch, patch))[own], overall[own]


def _initial_state(
    batches: Sequence[_Batch], objects: Sequence[GeometryObject], material: Material, order: Any
) -> tuple[Particles, Array, Array]:
    """All particles in their final order, at their initial values, their listed normals, and concentrations."""
    count = sum(len(b.position) for b in batches)
    made = new_arrays(Particles, count)
    beside = {"normal": np.zeros((count, 3)), "concentration": np.zeros(count)}
    start = 0
    for batch, body in zip(batches, objects, strict=True):
        here = slice(start, start + len(batch.position))
        made.position[here] = batch.position
        made.size[here] = batch.size
        made.volume[here] = batch.volume
        made.mass[here] = material.density * batch.volume * body.volume_fraction
        made.velocity[here] = body.velocity
        made.temperature[here] = body.temperature
        made.color[here] = body.color
        made.surface[here] = batch.surface
        beside["concentration"][here] = body.concentration
        for name, values in batch.listed.items():
            target = beside[name] if name in beside else getattr(made, name)
            target[here] = values
        start = here.stop
    made.previous_temperature[...] = made.temperature
    if isinstance(order, slice):
        return made, beside["normal"], beside["concentration"]
    particles = Particles(*(np.ascontiguousarray(array[order]) for array in made))
    return particles, beside["normal"][order], beside["concentration"][order]


def _filled_particles(
    body: GeometryObject, grid: Grid, axisymmetric: bool, find_surface: bool, in_rows: bool
) -> _Batch:
    """The particles of a body that is filled with lattice points.

    ``in_rows``: particles come row by row through the whole patch instead of cell by cell, which is Uintah's
    order for materials whose pieces are all triangulated surfaces.
    """
    shape = body.shape
    offsets = _neighbours(body.spacing(grid), grid) if find_surface else []
    blocks = []
    for patch in grid.patches:
        filled = _joined(list(_fill(body, shape, grid, patch, offsets)))
        if in_rows:
            by_row = np.lexsort(filled.position.T)
            filled = _Filled(*(array[by_row] for array in filled))
        blocks.append(filled)
    patches = np.repeat(np.arange(len(blocks), dtype=np.int32), [len(b.level) for b in blocks])
    position, level, surface = _joined(blocks)
    depth = np.arange(max(abs(body.filling_levels), 1))
    size = body.map @ (np.diag(1.0 / np.array(body.res)) * 0.5 ** depth[:, None, None])
    volume = _volumes(size, grid, axisymmetric)[level]
    position, patch_index = _place(body, position, patches, grid)
    if axisymmetric:
        volume = _radius(position) * volume
    return _Batch(position, size[level], volume, patch_index, surface, surface > 0.0, {})


def _listed_particles(
    body: GeometryObject, grid: Grid, axisymmetric: bool, tetrahedral: bool, find_surface: bool
) -> _Batch:
    """The particles that the pieces of a body list themselves."""
    pieces = [piece.particles(grid.spacing, tetrahedral) for piece in body.pieces]
    if any(piece.keys() != pieces[0].keys() for piece in pieces):
        raise ValueError("the file pieces of a geom_object must have the same variables")
    listed = {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}
    reference = listed.pop("position")
    count = len(reference)
    given_size = listed.pop("size", None)
    size = body.map @ (np.diag(1.0 / np.array(body.res)) if given_size is None else given_size)
    position, patch = _place(body, reference, None, grid)
    volume = listed.pop("volume", None)
    if volume is not None:
        volume = volume * float(_determinant(body.map))
    else:
        volume = np.broadcast_to(_volumes(size, grid, axisymmetric), count)
        if axisymmetric:
            volume = _radius(position) * volume
    surface = np.zeros(count)
    if find_surface:
        neighbours = [reference + offset for offset in _neighbours(body.spacing(grid), grid)]
        surface[~np.all([body.shape.inside(points) for points in neighbours], axis=0)] = 1.0
    return _Batch(
        position,
        np.broadcast_to(size, (count, 3, 3)),
        volume,
        patch,
        surface,
        np.full(count, "load_curve" not in listed),
        listed,
    )


def _place(body: GeometryObject, reference: Array, patch: Array | None, grid: Grid) -> tuple[Array, Array]:
    """Positions after the body's affine transformation, and the index of the patch that holds each."""
    position = reference
    if body.moves_particles:
        position = reference @ body.map.T + np.array(body.map_shift)
    elif patch is not None:
        return position, patch
    cells = grid.cell_of(position)
    holder = np.full(len(position), -1, np.int32)
    for index, candidate in enumerate(grid.patches):
        holder[np.all((cells >= candidate.low) & (cells < candidate.high), axis=1)] = index
    lost = np.flatnonzero(holder < 0)
    if len(lost):
        where = ", ".join(f"{c:g}" for c in position[lost[0]])
        raise ValueError(
            f"{len(lost)} of {len(position)} particles lie outside the grid, the first at ({where}): "
            "move the body or enlarge the grid"
        )
    return position, holder


def _determinant(a: Array) -> Array:
    """Determinants of matrices (.., 3, 3)."""
    result: Array = (
        a[..., 0, 0] * (a[..., 1, 1] * a[..., 2, 2] - a[..., 1, 2] * a[..., 2, 1])
        + a[..., 0, 1] * (a[..., 1, 2] * a[..., 2, 0] - a[..., 1, 0] * a[..., 2, 2])
        + a[..., 0, 2] * (a[..., 1, 0] * a[..., 2, 1] - a[..., 1, 1] * a[..., 2, 0])
    )
    return result


def _volumes(size: Array, grid: Grid, axisymmetric: bool) -> Array:
    """Volumes of particles whose vectors are the columns of ``size`` (.., 3, 3), in cell units.

    In axisymmetric calculations the area in the x-y plane, which times the radius is the volume of a radian.
    """
    if axisymmetric:
        area = size[..., 0, 0] * size[..., 1, 1] - size[..., 0, 1] * size[..., 1, 0]
        return np.asarray(area * grid.spacing[0] * grid.spacing[1])
    return _determinant(size) * grid.cell_volume


def _radius(position: Array) -> Array:
    """Distances of particles from the axis x = 0; ValueError where there are none on the positive side."""
    radius: Array = position[:, 0]
    if len(radius) and radius.min() <= 0.0:
        raise ValueError("an axisymmetric body must lie at x > 0: x is the distance from the axis")
    return radius


def _neighbours(spacing: Vector, grid: Grid) -> list[Vector]:
    """Where the neighbours of a particle lie that are inside unless it is at the surface, seen from it.

    In a grid one cell thick in z the neighbours in z do not count.
    """
    axes = range(3 if grid.cells[2] > 1 else 2)
    return [as_vector(step * spacing[axis] * np.eye(3)[axis]) for axis in axes for step in (-1.0, 1.0)]


def _joined(blocks: Sequence[_Filled]) -> _Filled:
    """Blocks of particles one after the other."""
    none = _Filled(np.zeros((0, 3)), np.zeros(0, np.int8), np.zeros(0))
    return _Filled(*(np.concatenate(arrays) for arrays in zip(none, *blocks, strict=True)))


def _fill(
    body: GeometryObject, shape: GeometryPiece, grid: Grid, patch: Patch, offsets: list[Vector]
) -> Iterator[_Filled]:
    """The lattice points of a patch in a shape, block by block."""
    lower, upper = (np.array(corner) for corner in shape.bounding_box())
    anchor, h = np.array(grid.anchor), np.array(grid.spacing)
    least, most = np.array(patch.low), np.array(patch.high)
    if not body.moves_particles:
        own_low, own_high = grid.own_cells
        most = np.minimum(most, own_high)
        least = np.minimum(np.maximum(least, own_low), most)
    # A cell more on every side, to be safe from rounding; clipped to the patch before it is made an integer.
    low = np.clip(np.floor((lower - anchor) / h) - 1.0, least, most).astype(int)
    high = np.clip(np.floor((upper - anchor) / h) + 2.0, least, most).astype(int)
    if np.any(high <= low):
        return
    finest = 2 ** (max(abs(body.filling_levels), 1) - 1)
    points_a_cell = body.res[0] * body.res[1] * body.res[2] * finest**3
    for block_low, block_high in _blocks(low, high, points_a_cell):
        yield _fill_block(body, shape, grid, block_low, block_high, offsets)


def _blocks(low: Array, high: Array, points_a_cell: int) -> Iterator[tuple[Array, Array]]:
    """Cut cells low <= c < high into blocks of layers, or of rows of a layer, in the order of creation."""
    nx, ny, _ = high - low
    layers = max(1, LATTICE_BLOCK // int(nx * ny * points_a_cell))
    rows = ny if layers > 1 else max(1, LATTICE_BLOCK // int(nx * points_a_cell))
    for k in range(low[2], high[2], layers):
        for j in range(low[1], high[1], rows):
            end = np.array([high[0], min(j + rows, high[1]), min(k + layers, high[2])])
            yield np.array([low[0], j, k]), end


def _lattice(grid: Grid, res: IntVector, low: Array, high: Array) -> list[Array]:
    """Coordinates along x, y and z of the lattice points in the cells low <= c < high."""
    axes = []
    for axis in range(3):
        spacing = grid.spacing[axis] / res[axis]
        nodes = grid.anchor[axis] + grid.spacing[axis] * np.arange(low[axis], high[axis])
        axes.append(((nodes + 0.5 * spacing)[:, None] + spacing * np.arange(res[axis])).ravel())
    return axes


def _fill_block(
    body: GeometryObject, shape: GeometryPiece, grid: Grid, low: Array, high: Array, offsets: list[Vector]
) -> _Filled:
    """The particles in a block of cells, in the order of creation."""
    resolutions = [_refined(body.res, level) for level in range(max(abs(body.filling_levels), 1))]
    lattices = [_lattice(grid, res, low, high) for res in resolutions]
    masks = _lattice_masks(shape, lattices, body.filling_levels < 0)
    parts, cells = [], []
    for level, (mask, lattice, res) in enumerate(zip(masks, lattices, resolutions, strict=True)):
        i, j, k, cell = _in_order_of_creation(mask, res)
        x, y, z = lattice
        surface = np.zeros(len(i))
        if offsets and len(i):
            surface[~_all_inside(shape, lattice, offsets)[k, j, i]] = 1.0
        parts.append(_Filled(np.stack([x[i], y[j], z[k]], axis=1), np.full(len(i), level, np.int8), surface))
        cells.append(cell)
    if len(parts) == 1:
        return parts[0]
    cell_by_cell = np.argsort(np.concatenate(cells), kind="stable")
    return _Filled(*(array[cell_by_cell] for array in _joined(parts)))


def _refined(res: IntVector, level: int) -> IntVector:
    """Particles a cell in each direction on a filling level."""
    return (res[0] << level, res[1] << level, res[2] << level)


def _lattice_masks(shape: GeometryPiece, lattices: Sequence[list[Array]], trim: bool) -> list[Array]:
    """For each filling level the lattice points that become particles, [k, j, i].

    Level by level, the points of a lattice twice as fine that lie in the shape and in no larger particle.
    ``trim``: before each finer level, particles that reach out of the shape are taken away.
    """
    masks: list[Array] = []
    for level, lattice in enumerate(lattices):
        if trim and masks:
            # Half a spacing of this level is where the next smaller particles would lie.
            reach = np.array([0.5 * (axis[1] - axis[0]) for axis in lattice])
            corners = [as_vector(reach * (2.0 * np.array(sides) - 1.0)) for sides in np.ndindex(2, 2, 2)]
            masks = [m & _all_inside(shape, lattices[n], corners) for n, m in enumerate(masks)]
        mask = shape.on_lattice(*lattice)
        for coarser, larger in enumerate(masks):
            mask &= ~_magnified(larger, 2 ** (level - coarser))
        masks.append(mask)
    return masks


def _all_inside(shape: GeometryPiece, lattice: list[Array], offsets: Sequence[Vector]) -> Array:
    """Where all the points at the given offsets from a lattice point lie in the shape, [k, j, i]."""
    x, y, z = lattice
    return reduce(np.logical_and, (shape.on_lattice(x + dx, y + dy, z + dz) for dx, dy, dz in offsets))


def _magnified(mask: Array, factor: int) -> Array:
    """A mask on a lattice that is finer by a factor."""
    return mask.repeat(factor, axis=0).repeat(factor, axis=1).repeat(factor, axis=2)


def _in_order_of_creation(mask: Array, res: IntVector) -> tuple[Array, Array, Array, Array]:
    """Lattice indices i, j, k and cells of the points of a mask [k, j, i].

    Cells come with x fastest, the points in a cell with z fastest.
    """
    nz, ny, nx = (n // r for n, r in zip(mask.shape, reversed(res), strict=True))
    by_cell = mask.reshape(nz, res[2], ny, res[1], nx, res[0]).transpose(0, 2, 4, 5, 3, 1)
    flat = np.flatnonzero(by_cell)
    cell, inner = np.divmod(flat, res[0] * res[1] * res[2])
    row, cell_x = np.divmod(cell, nx)
    cell_z, cell_y = np.divmod(row, ny)
    column, inner_z = np.divmod(inner, res[2])
    inner_x, inner_y = np.divmod(column, res[1])
    return cell_x * res[0] + inner_x, cell_y * res[1] + inner_y, cell_z * res[2] + inner_z, cell
