"""Shape functions of bodies of revolution: products of weights along the radius x and along the axis y.

The grid is one cell thick in the third direction; the two layers of nodes share alike. In place of a gradient there
the nodes get S / x, which the hoop components need.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solver.dispatch import generic, inline, lanewise
from solver.grid import GridIndex, NodeBlock
from solver.interpolation.shape import Content, Gathered, Room, Sums, nothing
from solver.interpolation.stencil import (
    COUNT,
    FIRST,
    G,
    Interpolator,
    W,
    add_to_node,
    alone,
    any_reach,
    corner,
    prepare_direction,
    prepared_by_eight,
)
from solver.lanes import Lanes, UpToEight, above, every, floor, lanes_at, put_lanes
from solver.particles import Particles
from solver.tensor import Tensor

LAYERS = 2
"""Layers of nodes in the third direction."""


class Radial(NamedTuple):
    """Weights of eight particles, one a lane, along the radius on up to three nodes next to each other."""

    below: Lanes
    """Nodes from the lower node of the particle's cell down to the first of the three: 0 or 1, or -1 for one up."""
    w0: Lanes
    w1: Lanes
    w2: Lanes
    """May be zero."""
    v0: Lanes
    """The weights that meet the derivative along the axis."""
    v1: Lanes
    v2: Lanes
    g0: Lanes
    """Derivatives of the weights, per cell."""
    g1: Lanes
    g2: Lanes
    t0: Lanes
    """Averages of the weights over the radius, in 1/length."""
    t1: Lanes
    t2: Lanes


@lanewise
@generic
def radial(interpolator: Any, f: Lanes, width: Lanes, node: Lanes, x: Lanes, h: float) -> Radial:
    """The weights of particles at the radius ``x`` in cells of size ``h``.

    0 <= f < 1 from the lower node of their cell, the particles' width and the radius of that node are in cells.
    """
    raise NotImplementedError


class Weighed(NamedTuple):
    """The weights of eight particles along the radius, and where they begin."""

    first: Lanes
    """The first of the three nodes, counted in storage."""
    weights: Radial


@inline
def weigh(interpolator: Any, grid: GridIndex, x: Lanes, width: Lanes) -> Weighed:
    """The weights of particles at the radius x, in each of the layers, with derivatives in 1/length."""
    h = grid.spacing[0]
    q = (x - grid.anchor[0]) / h
    cell = floor(q)
    s = radial(interpolator, q - cell, width, cell + grid.anchor[0] / h, x, h)
    share, slope = 1.0 / LAYERS, 1.0 / LAYERS / h
    return Weighed(
        cell - s.below - float(grid.first[0]),
        Radial(
            s.below,
            s.w0 * share,
            s.w1 * share,
            s.w2 * share,
            s.v0 * share,
            s.v1 * share,
            s.v2 * share,
            s.g0 * slope,
            s.g1 * slope,
            s.g2 * slope,
            s.t0 * share,
            s.t1 * share,
            s.t2 * share,
        ),
    )


V, T = 16, 24
"""Rows of ``Room.factors`` for the weights along the radius that a plane lacks: those that meet the derivative along
the axis, and those over the radius. The other rows are those of a plane, as far as there are any."""


@inline
def prepare_revolved(
    interpolator: Any, grid: GridIndex, block: NodeBlock, particles: Particles, first: int, room: Room
) -> bool:
    """As ``prepare``: the weights of eight particles in the two directions."""
    factors = room.factors
    prepare_direction(interpolator, grid, particles, first, 1, factors)
    if not (block.whole or any_reach(block, 1, factors)):
        return False
    p: Any = UpToEight(first, particles.mass.shape[0] - 1)
    at = weigh(interpolator, grid, particles.position[p, 0], particles.size[p, 0, 0])
    s = at.weights
    put_lanes(factors, W, 0, s.w0)
    put_lanes(factors, W + 1, 0, s.w1)
    put_lanes(factors, W + 2, 0, s.w2)
    put_lanes(factors, G, 0, s.g0)
    put_lanes(factors, G + 1, 0, s.g1)
    put_lanes(factors, G + 2, 0, s.g2)
    put_lanes(factors, V, 0, s.v0)
    put_lanes(factors, V + 1, 0, s.v1)
    put_lanes(factors, V + 2, 0, s.v2)
    put_lanes(factors, T, 0, s.t0)
    put_lanes(factors, T + 1, 0, s.t1)
    put_lanes(factors, T + 2, 0, s.t2)
    put_lanes(factors, FIRST, 0, at.first)
    put_lanes(factors, COUNT, 0, above(s.w2, 0.0) + 2.0)
    put_lanes(factors, 16 + FIRST, 0, -float(grid.first[2]))
    put_lanes(factors, 16 + COUNT, 0, float(LAYERS))
    return True


@inline
def scatter_revolved(
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
    """As ``scatter``; blocks have to be slabs across y or z."""
    factors = room.factors
    at = corner(factors, lane)
    low, high = block.low, block.high
    layer = np.uint64(grid.nodes[0] * grid.nodes[1])
    for b in range(max(0, low[1] - at.j), min(at.count_y, high[1] - at.j)):
        wy, gy = factors[8 + W + b, lane], factors[8 + G + b, lane]
        for a in range(at.count_x):
            S = factors[W + a, lane] * wy
            plain = content.plain * S
            along = content.mixed * S + content.by_y * (factors[V + a, lane] * gy)
            mixed = along + content.by_z * (factors[T + a, lane] * wy)
            node = np.uint64(at.i + a + grid.nodes[0] * (at.j + b + grid.nodes[1] * at.k))
            for c in range(max(0, low[2] - at.k), min(LAYERS, high[2] - at.k)):
                there = node + np.uint64(c) * layer
                add_to_node(sums, there, plain, mixed, content.by_x, 1.0, factors[G + a, lane] * wy)


@inline
def gather_revolved(
    interpolator: Any, grid: GridIndex, particles: Particles, p: int, lane: int, rows: Any, room: Room
) -> Gathered:
    """As ``gather``."""
    factors = room.factors
    at = corner(factors, lane)
    layer = np.uint64(grid.nodes[0] * grid.nodes[1])
    value, by_x, by_y, by_z = nothing(), nothing(), nothing(), nothing()
    for b in range(at.count_y):
        wy, gy = factors[8 + W + b, lane], factors[8 + G + b, lane]
        for a in range(at.count_x):
            node = np.uint64(at.i + a + grid.nodes[0] * (at.j + b + grid.nodes[1] * at.k))
            both = lanes_at(rows, node, 0) + lanes_at(rows, node + layer, 0)
            value = value + both * (factors[W + a, lane] * wy)
            by_x = by_x + both * (factors[G + a, lane] * wy)
            by_y = by_y + both * (factors[V + a, lane] * gy)
            by_z = by_z + both * (factors[T + a, lane] * wy)
    return Gathered(value, by_x, by_y, by_z)


@inline
def revolved_shape_functions(
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
    """As ``shape_functions``, without the third nodes whose weight is zero."""
    at = weigh(interpolator, grid, every(x), every(domain.xx))
    s, Y = at.weights, alone(interpolator, grid, 1, y, domain.yy)
    w, v = (s.w0[0], s.w1[0], s.w2[0]), (s.v0[0], s.v1[0], s.v2[0])
    g, t = (s.g0[0], s.g1[0], s.g2[0]), (s.t0[0], s.t1[0], s.t2[0])
    n = 0
    for b in range(Y.nodes):
        row = int(at.first[0]) + grid.nodes[0] * (Y.first + b - grid.nodes[1] * grid.first[2])
        for a in range(3 if w[2] > 0.0 else 2):
            for c in range(LAYERS):
                nodes[n] = row + a + grid.nodes[0] * grid.nodes[1] * c
                weights[n] = w[a] * Y.w[b]
                gradients[n, 0] = g[a] * Y.w[b]
                gradients[n, 1] = v[a] * Y.g[b]
                gradients[n, 2] = t[a] * Y.w[b]
                n += 1
    return n


def of_revolution(interpolator: Interpolator) -> Interpolator:
    """Class decorator: shape functions are products of what the class implements as ``radial`` and ``direction``."""
    return prepared_by_eight(
        interpolator, revolved_shape_functions, prepare_revolved, scatter_revolved, gather_revolved
    )
