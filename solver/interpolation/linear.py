"""Trilinear shape functions: the original material point method (Sulsky, Chen and Schreyer 1994)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.declare import model
from solver.dispatch import implements
from solver.grid import GridIndex
from solver.interpolation.shape import particle_domain, shape_functions
from solver.interpolation.stencil import Stencil, direction, nodes_across, separable, undeformed
from solver.lanes import Lanes, every
from solver.tensor import Tensor


@model("interpolator", "linear")
@separable
class Linear(NamedTuple):
    """Particles are points: S is the product of the hat functions 1 - |x - x_i| / dx of the three direction."""

    @staticmethod
    def for_deck(axisymmetric: bool, critical_length: float) -> Linear | LinearAxisymmetric:
        """The interpolator that a deck's flags ask for."""
        return LinearAxisymmetric() if axisymmetric else Linear()


class LinearAxisymmetric(NamedTuple):
    """Bilinear in (r, z) = (x, y); the two layers of nodes of the one cell in the third direction share alike."""


implements(particle_domain, LinearAxisymmetric)(undeformed)


@implements(nodes_across, Linear)
def _(interpolator: Linear) -> int:
    return 2


@implements(direction, Linear)
def _(interpolator: Linear, f: Lanes, width: Lanes) -> Stencil:
    none, one = every(0.0), every(1.0)
    return Stencil(none, 1.0 - f, f, none, -1.0 * one, one, none)


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
