"""Trilinear shape functions: the original material point method (Sulsky, Chen and Schreyer 1994)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solver.declare import model
from solver.dispatch import implements, inline
from solver.grid import GridIndex, NodeBlock
from solver.interpolation.revolved import Radial, of_revolution, radial
from solver.interpolation.shape import (
    Content,
    Gathered,
    Room,
    Sums,
    gather,
    nothing,
    reach,
    scatter,
)
from solver.interpolation.stencil import Corner, G, Stencil, W, corner, direction, separable
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


@of_revolution
class LinearAxisymmetric(NamedTuple):
    """Bilinear in (r, z) = (x, y)."""


@implements(reach, Linear, LinearAxisymmetric)
def _(interpolator: Any, domain: Tensor) -> float:
    return 1.0


@implements(direction, Linear, LinearAxisymmetric)
def _(interpolator: Any, f: Lanes, width: Lanes) -> Stencil:
    none, one = every(0.0), every(1.0)
    return Stencil(none, 1.0 - f, f, none, -1.0 * one, one, none)


@implements(radial, LinearAxisymmetric)
def _(interpolator: Any, f: Lanes, width: Lanes, node: Lanes, x: Lanes, h: float) -> Radial:
    none, one, e = every(0.0), every(1.0), 1.0 - f
    return Radial(none, e, f, none, e, f, none, -1.0 * one, one, none, e / x, f / x, none)


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
