"""Trilinear shape functions: the original material point method (Sulsky, Chen and Schreyer 1994)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from solver.declare import model
from solver.dispatch import implements, inline
from solver.grid import GridIndex, NodeBlock
from solver.interpolation.shape import (
    Content,
    Gathered,
    Room,
    Sums,
    gather,
    nothing,
    particle_domain,
    reach,
    scatter,
    shape_functions,
)
from solver.interpolation.stencil import Corner, G, Stencil, W, corner, direction, separable, undeformed
from solver.lanes import Lanes, add_scaled, every, lanes_at, put_lanes
from solver.particles import Particles
from solver.tensor import Tensor


@model("interpolator", "linear")
@separable
class Linear(NamedTuple):
    """Particles are points: S is the product of the hat functions 1 - |x - x_i| / dx of the three directions."""

    @staticmethod
    def for_deck(axisymmetric: bool, critical_length: float) -> Linear | LinearAxisymmetric:
        """The interpolator that a deck's flags ask for."""
        return LinearAxisymmetric() if axisymmetric else Linear()


class LinearAxisymmetric(NamedTuple):
    """Bilinear in (r, z) = (x, y); the two layers of nodes of the one cell in the third direction share alike."""


implements(particle_domain, LinearAxisymmetric)(undeformed)


@implements(reach, Linear, LinearAxisymmetric)
def _(interpolator: Any, domain: Tensor) -> float:
    return 1.0


@implements(direction, Linear)
def _(interpolator: Linear, f: Lanes, width: Lanes) -> Stencil:
    none, one = every(0.0), every(1.0)
    return Stencil(none, 1.0 - f, f, none, -1.0 * one, one, none)


class NodeWeights(NamedTuple):
    """Weight and gradient of one of the eight nodes."""

    node: Any
    """Where it is stored."""
    S: float
    gx: float
    gy: float
    gz: float


@inline
def at_node(grid: GridIndex, at: Corner, a: int, b: int, c: int, factors: Any, lane: int) -> NodeWeights:
    """The node a, b, c = 0 or 1 after the first in x, y, z.

    Products are taken and fused in Uintah's order, and nodes visited with z fastest, as there: so even the rounding
    noise of bodies that are not strained yet agrees.
    """
    wx, wy, wz = factors[W + a, lane], factors[8 + W + b, lane], factors[16 + W + c, lane]
    gx, gy, gz = factors[G + a, lane], factors[8 + G + b, lane], factors[16 + G + c, lane]
    node = np.uint64(at.i + a + grid.nodes[0] * (at.j + b + grid.nodes[1] * (at.k + c)))
    return NodeWeights(node, wx * wy * wz, wy * wz * gx, wx * wz * gy, wx * wy * gz)


@implements(scatter, Linear)
def _(
    interpolator: Linear,
    grid: GridIndex,
    block: NodeBlock,
    particles: Particles,
    p: int,
    lane: int,
    content: Content,
    sums: Sums,
    room: Room,
) -> None:
    at, low, high, rows = corner(room.factors, lane), block.low, block.high, sums.rows
    for a in range(2):
        for b in range(2):
            for c in range(2):
                if low[1] <= at.j + b < high[1] and low[2] <= at.k + c < high[2]:
                    n = at_node(grid, at, a, b, c, room.factors, lane)
                    sums.touched[n.node] = 1
                    plain = add_scaled(lanes_at(rows, n.node, 0), content.plain, n.S)
                    put_lanes(rows, n.node, 0, plain)
                    by_G = add_scaled(content.by_x * n.gx, content.by_y, n.gy)
                    mixed = add_scaled(add_scaled(by_G, content.by_z, n.gz), content.mixed, n.S)
                    put_lanes(rows, n.node, 8, lanes_at(rows, n.node, 8) + mixed)


@implements(gather, Linear)
def _(
    interpolator: Linear, grid: GridIndex, particles: Particles, p: int, lane: int, rows: Any, room: Room
) -> Gathered:
    at = corner(room.factors, lane)
    value, by_x, by_y, by_z = nothing(), nothing(), nothing(), nothing()
    for a in range(2):
        for b in range(2):
            for c in range(2):
                n = at_node(grid, at, a, b, c, room.factors, lane)
                row = lanes_at(rows, n.node, 0)
                value = add_scaled(value, row, n.S)
                by_x = add_scaled(by_x, row, n.gx)
                by_y = add_scaled(by_y, row, n.gy)
                by_z = add_scaled(by_z, row, n.gz)
    return Gathered(value, by_x, by_y, by_z)


@implements(shape_functions, LinearAxisymmetric)
def _(
    interpolator: LinearAxisymmetric,
    grid: GridIndex,
    x: float,
    y: float,
    z: float,
    domain: Tensor,
    nodes: Any,
    weights: Any,
    gradients: Any,
) -> int:
    hx, hy = grid.spacing[0], grid.spacing[1]
    qx, qy = (x - grid.anchor[0]) / hx, (y - grid.anchor[1]) / hy
    i, j = math.floor(qx), math.floor(qy)
    fx, fy = qx - i, qy - j
    row = grid.nodes[0]
    layer = row * grid.nodes[1]
    first = (i - grid.first[0]) + row * (j - grid.first[1]) - layer * grid.first[2]
    n = 0
    for b in range(2):
        wy, gy = (fy, 0.5 / hy) if b else (1.0 - fy, -0.5 / hy)
        for a in range(2):
            wx, gx = (fx, 0.5 / hx) if a else (1.0 - fx, -0.5 / hx)
            for c in range(2):
                nodes[n] = first + a + row * b + layer * c
                weights[n] = 0.5 * wx * wy
                gradients[n, 0] = gx * wy
                gradients[n, 1] = wx * gy
                gradients[n, 2] = 0.5 * wx * wy / x
                n += 1
    return n
