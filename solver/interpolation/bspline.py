"""Quadratic B-splines (Steffen, Kirby and Berzins 2008); the deck's name counts the order as Uintah does."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.declare import model
from solver.dispatch import implements, inline
from solver.grid import GridIndex
from solver.interpolation.gimp import Axis, tensor_product
from solver.interpolation.shape import particle_domain, shape_functions
from solver.tensor import Tensor


@model("interpolator", "3rdorderBS")
class BSpline(NamedTuple):
    """Particles are points; S is the product of quadratic B-splines, smooth across cell faces."""

    @staticmethod
    def for_deck(axisymmetric: bool, critical_length: float) -> BSpline:
        """The interpolator that a deck's flags ask for; there is no axisymmetric form."""
        if axisymmetric:
            raise ValueError("3rdorderBS has no axisymmetric form; use linear, gimp or cpdi")
        return BSpline()


@implements(particle_domain, BSpline)
def _(interpolator: BSpline, deformation_gradient: Tensor, size: Tensor) -> Tensor:
    return size


@inline
def quadratic_spline(f: float) -> Axis:
    """Weights and gradients on the three nearest nodes, 0 <= f < 1 measured from node i in cells."""
    if f < 0.5:
        return Axis(-1, 0.75 - f * f, 0.5 * (f + 0.5) ** 2, 0.5 * (0.5 - f) ** 2, -2.0 * f, f + 0.5, f - 0.5)
    e = f - 1.0
    return Axis(2, 0.5 * (1.5 - f) ** 2, 0.75 - e * e, 0.5 * (f - 0.5) ** 2, f - 1.5, -2.0 * e, f - 0.5)


@implements(shape_functions, BSpline)
def _(
    interpolator: BSpline,
    grid: GridIndex,
    x: float,
    y: float,
    z: float,
    domain: Tensor,
    nodes: Any,
    weights: Any,
    gradients: Any,
) -> int:
    qx = (x - grid.anchor[0]) / grid.spacing[0]
    qy = (y - grid.anchor[1]) / grid.spacing[1]
    qz = (z - grid.anchor[2]) / grid.spacing[2]
    i, j, k = math.floor(qx), math.floor(qy), math.floor(qz)
    X, Y, Z = quadratic_spline(qx - i), quadratic_spline(qy - j), quadratic_spline(qz - k)
    first = (i - grid.first[0]) + grid.nodes[0] * ((j - grid.first[1]) + grid.nodes[1] * (k - grid.first[2]))
    return tensor_product(grid, first, X, Y, Z, nodes, weights, gradients)
