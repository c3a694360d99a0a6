"""Quadratic B-splines (Steffen, Kirby and Berzins 2008); the deck's name counts the order as Uintah does."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, inline
from solver.interpolation.stencil import Stencil, direction, separable
from solver.lanes import Lanes, above


@model("interpolator", "3rdorderBS")
@separable
class BSpline(NamedTuple):
    """Particles are points; S is the product of quadratic B-splines, smooth across cell faces."""

    @staticmethod
    def for_deck(axisymmetric: bool, critical_length: float) -> BSpline:
        """The interpolator that a deck's flags ask for; there is no axisymmetric form."""
        if axisymmetric:
            raise ValueError("3rdorderBS has no axisymmetric form; use linear, gimp or cpdi")
        return BSpline()


@implements(direction, BSpline)
def _(interpolator: BSpline, f: Lanes, width: Lanes) -> Stencil:
    return quadratic_spline(f)


@inline
def quadratic_spline(f: Lanes) -> Stencil:
    """Weights and gradients on the three nearest nodes, 0 <= f < 1 measured from node i in cells.

    With e the distance from the nearest node: 3/4 - e^2 there, (1/2 - e)^2 / 2 below and (1/2 + e)^2 / 2 above it.
    """
    outer = above(0.5, f)
    e = f - (1.0 - outer)
    return Stencil(
        outer,
        0.5 * ((0.5 - e) * (0.5 - e)),
        0.75 - e * e,
        0.5 * ((0.5 + e) * (0.5 + e)),
        e - 0.5,
        -2.0 * e,
        e + 0.5,
    )
