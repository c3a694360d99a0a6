"""Shape functions of particle domains: linear functions averaged over the corners of a particle."""

from __future__ import annotations

from typing import Any, NamedTuple, TypeVar

import numpy as np

from solver.dispatch import generic, implements, inline
from solver.grid import GridIndex, NodeBlock
from solver.interpolation.shape import (
    Content,
    Gathered,
    Room,
    Sums,
    gather,
    nothing,
    particle_domain,
    prepare,
    scatter,
    shape_functions,
)
from solver.lanes import UpToEight, floor, lanes_at, put_lanes
from solver.particles import Particles
from solver.tensor import Tensor, tensor_at


class DomainCorner(NamedTuple):
    """A corner of a particle: S gets ``weight`` phi and G (gx, gy, gz) phi, with phi the linear function there."""

    x: float
    """From the particle to the corner, in cells."""
    y: float
    z: float
    weight: float
    gx: float
    """In 1/length."""
    gy: float
    gz: float


@generic
def number_of_corners(interpolator: Any) -> int:
    """How many corners a particle has."""
    raise NotImplementedError


@generic
def domain_corner(
    interpolator: Any, grid: GridIndex, x: float, z: float, domain: Tensor, n: int
) -> DomainCorner:
    """Corner ``n`` of a particle at ``x`` and ``z`` in the first and third direction."""
    raise NotImplementedError


class CornerCell(NamedTuple):
    """The cell of a corner: its first node, counted in storage, and where the corner lies in it, in cells."""

    i: float
    """A whole number, as are the next two."""
    j: float
    k: float
    fx: float
    fy: float
    fz: float


@inline
def corner_cell(grid: GridIndex, x: float, y: float, z: float, corner: DomainCorner) -> CornerCell:
    """The cell of a corner of a particle at (x, y, z); beyond the stored nodes the outermost cell goes on."""
    qx = (x - grid.anchor[0]) / grid.spacing[0] + corner.x
    qy = (y - grid.anchor[1]) / grid.spacing[1] + corner.y
    qz = (z - grid.anchor[2]) / grid.spacing[2] + corner.z
    i = stored_cell(qx, 1.0 * grid.first[0], grid.nodes[0])
    j = stored_cell(qy, 1.0 * grid.first[1], grid.nodes[1])
    k = stored_cell(qz, 1.0 * grid.first[2], grid.nodes[2])
    return CornerCell(i - grid.first[0], j - grid.first[1], k - grid.first[2], qx - i, qy - j, qz - k)


@inline
def stored_cell(q: float, first: float, nodes: int) -> float:
    """The cell of a position in cells, among those between stored nodes; a whole number."""
    return min(max(floor(q), first), first + (nodes - 2))


@inline
def side(f: float, upper: int) -> float:
    """The linear weight of the lower (0) or upper (1) node of a cell."""
    return f if upper else 1.0 - f


@inline
def corner_shape_functions(
    interpolator: Any,
    grid: GridIndex,
    x: float,
    y: float,
    z: float,
    domain: Tensor,
    nodes: Any,
    weights: Any,
    gradients: Any,
) -> int:
    """Eight entries for each corner, one after the other; a node may turn up in several."""
    count = 0
    for n in range(number_of_corners(interpolator)):
        corner = domain_corner(interpolator, grid, x, z, domain, n)
        at = corner_cell(grid, x, y, z, corner)
        i, j, k = int(at.i), int(at.j), int(at.k)
        for c in range(2):
            for b in range(2):
                wyz = side(at.fy, b) * side(at.fz, c)
                for a in range(2):
                    phi = side(at.fx, a) * wyz
                    nodes[count] = i + a + grid.nodes[0] * (j + b + grid.nodes[1] * (k + c))
                    weights[count] = corner.weight * phi
                    gradients[count, 0] = corner.gx * phi
                    gradients[count, 1] = corner.gy * phi
                    gradients[count, 2] = corner.gz * phi
                    count += 1
    return count


ROWS = 10
"""Rows of ``Room.factors`` of a corner: its :class:`CornerCell`, weight and gradient."""


@inline
def prepare_corners(
    interpolator: Any, grid: GridIndex, block: NodeBlock, particles: Particles, first: int, room: Room
) -> bool:
    """Store the corners of the particles ``first`` to ``first + 7``."""
    p: Any = UpToEight(first, particles.mass.shape[0] - 1)
    factors = room.factors
    x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
    F, size = tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
    domain = particle_domain(interpolator, F, size)
    for n in range(number_of_corners(interpolator)):
        corner = domain_corner(interpolator, grid, x, z, domain, n)
        at = corner_cell(grid, x, y, z, corner)
        row = ROWS * n
        put_lanes(factors, row, 0, at.i)
        put_lanes(factors, row + 1, 0, at.j)
        put_lanes(factors, row + 2, 0, at.k)
        put_lanes(factors, row + 3, 0, at.fx)
        put_lanes(factors, row + 4, 0, at.fy)
        put_lanes(factors, row + 5, 0, at.fz)
        put_lanes(factors, row + 6, 0, corner.weight)
        put_lanes(factors, row + 7, 0, corner.gx)
        put_lanes(factors, row + 8, 0, corner.gy)
        put_lanes(factors, row + 9, 0, corner.gz)
    return True


class PreparedCorner(NamedTuple):
    """What was stored of a corner."""

    i: int
    j: int
    k: int
    fx: float
    fy: float
    fz: float
    weight: float
    gx: float
    gy: float
    gz: float


@inline
def prepared_corner(factors: Any, n: int, lane: int) -> PreparedCorner:
    """Corner ``n`` of the particle in a lane."""
    row = ROWS * n
    return PreparedCorner(
        int(factors[row, lane]),
        int(factors[row + 1, lane]),
        int(factors[row + 2, lane]),
        factors[row + 3, lane],
        factors[row + 4, lane],
        factors[row + 5, lane],
        factors[row + 6, lane],
        factors[row + 7, lane],
        factors[row + 8, lane],
        factors[row + 9, lane],
    )


@inline
def scatter_from_corners(
    interpolator: Any,
    grid: GridIndex,
    block: NodeBlock,
    particles: Particles,
    p: int,
    lane: int,
    content: Content,
    sums: Sums,
    room: Room,
) -> None:
    """As ``scatter``: what a corner gives to all its nodes is put together once."""
    low, high, rows = block.low, block.high, sums.rows
    for n in range(number_of_corners(interpolator)):
        at = prepared_corner(room.factors, n, lane)
        plain = content.plain * at.weight
        by_G = content.by_x * at.gx + content.by_y * at.gy + content.by_z * at.gz
        mixed = by_G + content.mixed * at.weight
        for c in range(2):
            for b in range(2):
                # Not by the bounds of the loops: loops of other lengths are compiled to other rounding.
                if low[1] <= at.j + b < high[1] and low[2] <= at.k + c < high[2]:
                    wyz = side(at.fy, b) * side(at.fz, c)
                    row = np.uint64(at.i + grid.nodes[0] * (at.j + b + grid.nodes[1] * (at.k + c)))
                    for a in range(2):
                        node, phi = row + np.uint64(a), side(at.fx, a) * wyz
                        sums.touched[node] = 1
                        put_lanes(rows, node, 0, lanes_at(rows, node, 0) + plain * phi)
                        put_lanes(rows, node, 8, lanes_at(rows, node, 8) + mixed * phi)


@inline
def gather_at_corners(
    interpolator: Any, grid: GridIndex, particles: Particles, p: int, lane: int, rows: Any, room: Room
) -> Gathered:
    """As ``gather``: the nodes of a corner are interpolated to it first."""
    value, by_x, by_y, by_z = nothing(), nothing(), nothing(), nothing()
    for n in range(number_of_corners(interpolator)):
        at = prepared_corner(room.factors, n, lane)
        there = nothing()
        for c in range(2):
            for b in range(2):
                wyz = side(at.fy, b) * side(at.fz, c)
                row = np.uint64(at.i + grid.nodes[0] * (at.j + b + grid.nodes[1] * (at.k + c)))
                for a in range(2):
                    there = there + lanes_at(rows, row + np.uint64(a), 0) * (side(at.fx, a) * wyz)
        value = value + there * at.weight
        by_x = by_x + there * at.gx
        by_y = by_y + there * at.gy
        by_z = by_z + there * at.gz
    return Gathered(value, by_x, by_y, by_z)


Interpolator = TypeVar("Interpolator", bound=type)


def cornered(interpolator: Interpolator) -> Interpolator:
    """Class decorator: shape functions are averages over what the class implements as ``domain_corner``."""
    implements(shape_functions, interpolator)(corner_shape_functions)
    implements(prepare, interpolator)(prepare_corners)
    implements(scatter, interpolator)(scatter_from_corners)
    implements(gather, interpolator)(gather_at_corners)
    return interpolator
