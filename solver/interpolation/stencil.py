"""Shape functions that are products of weights of the three directions."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import numpy as np

from solver.dispatch import generic, implements, inline, lanewise
from solver.grid import GridIndex, NodeBlock
from solver.interpolation.shape import (
    Content,
    Gathered,
    Room,
    Sums,
    gather,
    is_near,
    nothing,
    particle_domain,
    prepare,
    scatter,
    shape_functions,
)
from solver.lanes import Lanes, UpToEight, above, anywhere, every, floor, lanes_at, put_lanes
from solver.particles import Particles
from solver.tensor import Tensor


class Stencil(NamedTuple):
    """Weights of eight particles, one a lane, in one direction on up to three nodes next to each other."""

    below: Lanes
    """Nodes from the lower node of the particle's cell down to the first of the three: 0 or 1."""
    w0: Lanes
    w1: Lanes
    w2: Lanes
    """May be zero."""
    g0: Lanes
    """Derivatives of the weights, per cell."""
    g1: Lanes
    g2: Lanes


@inline
def stencil(outer: Lanes, w0: Lanes, w1: Lanes, w2: Lanes, g0: Lanes, g1: Lanes, g2: Lanes) -> Stencil:
    """Put the third weight below the two of the cell, where ``outer`` is 1, or above them, where it is 0."""
    inner = 1.0 - outer
    return Stencil(
        outer,
        outer * w2 + inner * w0,
        outer * w0 + inner * w1,
        outer * w1 + inner * w2,
        outer * g2 + inner * g0,
        outer * g0 + inner * g1,
        outer * g1 + inner * g2,
    )


@lanewise
@generic
def direction(interpolator: Any, f: Lanes, width: Lanes) -> Stencil:
    """The weights of particles that wide, 0 <= f < 1 from the lower node of their cell; both in cells."""
    raise NotImplementedError


W, G, FIRST, COUNT = 0, 3, 6, 7
"""Rows of ``Room.factors`` of one direction, counted from 8 times its axis: three weights, their derivatives in
1/length, the first node and the number of nodes that count."""


@inline
def prepare_direction(
    interpolator: Any, grid: GridIndex, particles: Particles, first: int, axis: int, factors: Any
) -> None:
    """Store the weights of the particles ``first`` to ``first + 7`` in one direction."""
    p: Any = UpToEight(first, particles.mass.shape[0] - 1)
    h = grid.spacing[axis]
    q = (particles.position[p, axis] - grid.anchor[axis]) / h
    cell = floor(q)
    s = direction(interpolator, q - cell, particles.size[p, axis, axis])
    row, per_length = 8 * axis, 1.0 / h
    put_lanes(factors, row + W, 0, s.w0)
    put_lanes(factors, row + W + 1, 0, s.w1)
    put_lanes(factors, row + W + 2, 0, s.w2)
    put_lanes(factors, row + G, 0, s.g0 * per_length)
    put_lanes(factors, row + G + 1, 0, s.g1 * per_length)
    put_lanes(factors, row + G + 2, 0, s.g2 * per_length)
    put_lanes(factors, row + FIRST, 0, cell - s.below - float(grid.first[axis]))
    put_lanes(factors, row + COUNT, 0, above(s.w2, 0.0) + 2.0)


@inline
def prepare_product(
    interpolator: Any, grid: GridIndex, block: NodeBlock, particles: Particles, first: int, room: Room
) -> bool:
    """The weights of eight particles in the three directions; short chains of divisions, side by side."""
    factors = room.factors
    prepare_direction(interpolator, grid, particles, first, 1, factors)
    prepare_direction(interpolator, grid, particles, first, 2, factors)
    if not (block.whole or (any_reach(block, 1, factors) and any_reach(block, 2, factors))):
        return False
    prepare_direction(interpolator, grid, particles, first, 0, factors)
    return True


@inline
def any_reach(block: NodeBlock, axis: int, factors: Any) -> bool:
    """Whether any of eight particles has nodes between the bounds of a block in one direction."""
    start, count = lanes_at(factors, 8 * axis + FIRST, 0), lanes_at(factors, 8 * axis + COUNT, 0)
    return anywhere((start < 1.0 * block.high[axis]) & (start + count > 1.0 * block.low[axis]))


class Corner(NamedTuple):
    """The first node (i, j, k) of a particle, counted in storage, and how many it has in x, y and z."""

    i: int
    j: int
    k: int
    count_x: int
    count_y: int
    count_z: int


@inline
def corner(factors: Any, lane: int) -> Corner:
    """The nodes of a prepared particle."""
    return Corner(
        int(factors[FIRST, lane]),
        int(factors[8 + FIRST, lane]),
        int(factors[16 + FIRST, lane]),
        int(factors[COUNT, lane]),
        int(factors[8 + COUNT, lane]),
        int(factors[16 + COUNT, lane]),
    )


@inline
def product_is_near(
    interpolator: Any, grid: GridIndex, block: NodeBlock, particles: Particles, p: int, lane: int, room: Room
) -> bool:
    """As ``is_near``, for a prepared particle."""
    if block.whole:
        return True
    at = corner(room.factors, lane)
    low, high = block.low, block.high
    return at.j < high[1] and low[1] < at.j + at.count_y and at.k < high[2] and low[2] < at.k + at.count_z


@inline
def add_to_node(sums: Sums, node: Any, plain: Lanes, mixed: Lanes, by_x: Lanes, wx: float, gx: float) -> None:
    """Add to a node of a row what the row has in common, times the weight in x."""
    rows = sums.rows
    sums.touched[node] = 1
    put_lanes(rows, node, 0, lanes_at(rows, node, 0) + plain * wx)
    put_lanes(rows, node, 8, lanes_at(rows, node, 8) + mixed * wx + by_x * gx)


@inline
def scatter_product(
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
    """As ``scatter``, row of nodes by row: what the nodes of a row have in common is multiplied once.

    A row is never divided, so blocks have to be slabs across y or z.
    """
    factors = room.factors
    at = corner(factors, lane)
    low, high = block.low, block.high
    for c in range(max(0, low[2] - at.k), min(at.count_z, high[2] - at.k)):
        wz, gz = factors[16 + W + c, lane], factors[16 + G + c, lane]
        for b in range(max(0, low[1] - at.j), min(at.count_y, high[1] - at.j)):
            wy, gy = factors[8 + W + b, lane], factors[8 + G + b, lane]
            plain = content.plain * (wy * wz)
            mixed = content.mixed * (wy * wz) + content.by_y * (gy * wz) + content.by_z * (wy * gz)
            by_x = content.by_x * (wy * wz)
            row = np.uint64(at.i + grid.nodes[0] * (at.j + b + grid.nodes[1] * (at.k + c)))
            add_to_node(sums, row, plain, mixed, by_x, factors[W, lane], factors[G, lane])
            add_to_node(
                sums, row + np.uint64(1), plain, mixed, by_x, factors[W + 1, lane], factors[G + 1, lane]
            )
            if at.count_x > 2:
                add_to_node(
                    sums, row + np.uint64(2), plain, mixed, by_x, factors[W + 2, lane], factors[G + 2, lane]
                )


@inline
def gather_product(
    interpolator: Any, grid: GridIndex, particles: Particles, p: int, lane: int, rows: Any, room: Room
) -> Gathered:
    """As ``gather``, row of nodes by row."""
    factors = room.factors
    at = corner(factors, lane)
    value, by_x, by_y, by_z = nothing(), nothing(), nothing(), nothing()
    for c in range(at.count_z):
        wz, gz = factors[16 + W + c, lane], factors[16 + G + c, lane]
        for b in range(at.count_y):
            wy, gy = factors[8 + W + b, lane], factors[8 + G + b, lane]
            along, slope = nothing(), nothing()
            row = np.uint64(at.i + grid.nodes[0] * (at.j + b + grid.nodes[1] * (at.k + c)))
            for a in range(2):
                nodal = lanes_at(rows, row + np.uint64(a), 0)
                along = along + nodal * factors[W + a, lane]
                slope = slope + nodal * factors[G + a, lane]
            if at.count_x > 2:
                nodal = lanes_at(rows, row + np.uint64(2), 0)
                along = along + nodal * factors[W + 2, lane]
                slope = slope + nodal * factors[G + 2, lane]
            value = value + along * (wy * wz)
            by_x = by_x + slope * (wy * wz)
            by_y = by_y + along * (gy * wz)
            by_z = by_z + along * (wy * gz)
    return Gathered(value, by_x, by_y, by_z)


class Alone(NamedTuple):
    """Weights of one particle in one direction."""

    first: int
    """The first node, counted in storage."""
    nodes: int
    """How many count: 2 where the third weight is zero."""
    w: tuple[float, float, float]
    g: tuple[float, float, float]
    """Derivatives in 1/length."""


@inline
def alone(interpolator: Any, grid: GridIndex, axis: int, x: float, width: float) -> Alone:
    """The weights in one direction of a particle at ``x``."""
    q = (x - grid.anchor[axis]) / grid.spacing[axis]
    cell = math.floor(q)
    s, h = direction(interpolator, every(q - cell), every(width)), grid.spacing[axis]
    return Alone(
        cell - int(s.below[0]) - grid.first[axis],
        3 if s.w2[0] > 0.0 else 2,
        (s.w0[0], s.w1[0], s.w2[0]),
        (s.g0[0] / h, s.g1[0] / h, s.g2[0] / h),
    )


@inline
def product_shape_functions(
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
    """Products of the weights of three directions, without the third nodes whose weight is zero."""
    X = alone(interpolator, grid, 0, x, domain.xx)
    Y = alone(interpolator, grid, 1, y, domain.yy)
    Z = alone(interpolator, grid, 2, z, domain.zz)
    n = 0
    for c in range(Z.nodes):
        for b in range(Y.nodes):
            wyz, gyz, wgz = Y.w[b] * Z.w[c], Y.g[b] * Z.w[c], Y.w[b] * Z.g[c]
            first = X.first + grid.nodes[0] * (Y.first + b + grid.nodes[1] * (Z.first + c))
            for a in range(X.nodes):
                nodes[n] = first + a
                weights[n] = X.w[a] * wyz
                gradients[n, 0] = X.g[a] * wyz
                gradients[n, 1] = X.w[a] * gyz
                gradients[n, 2] = X.w[a] * wgz
                n += 1
    return n


Interpolator = TypeVar("Interpolator", bound=type)


def separable(interpolator: Interpolator) -> Interpolator:
    """Class decorator: shape functions are products of what the class implements as ``direction``."""
    return prepared_by_eight(
        interpolator, product_shape_functions, prepare_product, scatter_product, gather_product
    )


def prepared_by_eight(
    interpolator: Interpolator,
    functions: Callable[..., int],
    prepares: Callable[..., bool],
    scatters: Callable[..., None],
    gathers: Callable[..., Gathered],
) -> Interpolator:
    """Give a class the bodies of what an interpolator does, for particles that keep their initial size.

    ``prepares`` leaves in ``Room.factors`` where the nodes of each particle begin and how many there are, as
    :func:`corner` reads it.
    """
    implements(particle_domain, interpolator)(undeformed)
    implements(is_near, interpolator)(product_is_near)
    implements(shape_functions, interpolator)(functions)
    implements(prepare, interpolator)(prepares)
    implements(scatter, interpolator)(scatters)
    implements(gather, interpolator)(gathers)
    return interpolator


@inline
def undeformed(interpolator: Any, deformation_gradient: Tensor, size: Tensor) -> Tensor:
    """The domain of particles that keep their initial size."""
    return size
