"""Generalized interpolation shape functions (Bardenhagen and Kober 2004), uniform particle domains (uGIMP)."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.declare import model
from solver.dispatch import implements, inline
from solver.interpolation.revolved import Radial, of_revolution, radial
from solver.interpolation.stencil import Stencil, direction, separable, stencil
from solver.lanes import Lanes, above, every, where


@model("interpolator", "gimp")
@separable
class Gimp(NamedTuple):
    """Particles are boxes of their initial size; S is the hat function averaged over the box."""

    @staticmethod
    def for_deck(axisymmetric: bool, critical_length: float) -> Gimp | GimpAxisymmetric:
        """The interpolator that a deck's flags ask for."""
        return GimpAxisymmetric() if axisymmetric else Gimp()


@of_revolution
class GimpAxisymmetric(NamedTuple):
    """Averages over the particle's cross-section weighted with the radius (Nairn and Guilkey 2015)."""


@implements(direction, Gimp, GimpAxisymmetric)
def _(interpolator: Any, f: Lanes, width: Lanes) -> Stencil:
    return averaged_hat(f, 0.5 * width)


@inline
def averaged_hat(f: Lanes, half: Lanes) -> Stencil:
    """The hat function averaged over [f - half, f + half], 0 <= f < 1 measured from node i in cells.

    Where the particle reaches over node i by a, or over node i + 1 by b, the linear weights 1 - f and f lose
    twice a^2 / 4 half (or b^2 / 4 half) at that node and its neighbours on both sides gain it.
    """
    # Measured from the far node, as Uintah does: at a touch, rounding decides alike whether that node takes part.
    a = (1.0 + half - (f + 1.0)) * (1.0 - above(f, half))
    b = (1.0 + half + (f - 2.0)) * above(f, 1.0 - half)
    q = 0.25 / half
    return stencil(
        above(a, 0.0),
        1.0 - f - (2.0 * a * a - b * b) * q,
        f + (a * a - 2.0 * b * b) * q,
        (a * a + b * b) * q,
        (4.0 * a + 2.0 * b) * q - 1.0,
        1.0 - (2.0 * a + 4.0 * b) * q,
        2.0 * (b - a) * q,
    )


class Around(NamedTuple):
    """Numbers at a node and at those below and above it."""

    lower: Lanes
    middle: Lanes
    upper: Lanes


class AtNodes(NamedTuple):
    """The four numbers of :class:`solver.interpolation.revolved.Radial`, each at a node and its neighbours."""

    w: Around
    v: Around
    g: Around
    t: Around


@inline
def from_lower(starts: Any, s: Around) -> Around:
    """The same from the lower node on where that counts, else from the middle node on, with nothing at the end."""
    return Around(
        where(starts, s.lower, s.middle),
        where(starts, s.middle, s.upper),
        where(starts, s.upper, 0.0),
    )


@inline
def straddled(xi: Lanes, r: Lanes, lp: Lanes) -> Lanes:
    """Weight of a node inside the particle: xi is the offset in half cells, r the node's radius in cells."""
    return ((4.0 - lp) * lp - xi * xi) / (4.0 * lp) + xi * (xi * xi - 3.0 * lp * lp) / (
        12.0 * lp * (2.0 * r + xi)
    )


@inline
def reached(distance: Lanes, side: float, xi: Lanes, r: Lanes, lp: Lanes) -> Lanes:
    """Weight of a node that the particle only partly reaches; side is +1 where the node lies above the particle."""
    return distance * distance / (8.0 * lp) * (1.0 - (xi + side * 2.0 * (1.0 - lp)) / (3.0 * (2.0 * r + xi)))


@inline
def slope_reached(distance: Lanes, side: float, xi: Lanes, r: Lanes, lp: Lanes) -> Lanes:
    """Derivative of that, per cell."""
    return side * distance / (2.0 * lp) * (1.0 - (xi + side * (2.0 - lp)) / (2.0 * (2.0 * r + xi)))


@inline
def straddling(xi: Lanes, r: Lanes, lp: Lanes, x: Lanes) -> AtNodes:
    """A particle that straddles its nearest node: xi is its offset in half cells, r the node's radius in cells."""
    # Measured from the far nodes, as Uintah does (see averaged_hat).
    up, down = 2.0 + lp + (xi - 2.0), 2.0 + lp - (xi + 2.0)
    w = Around(
        reached(down, -1.0, xi + 2.0, r - 1.0, lp),
        straddled(xi, r, lp),
        reached(up, 1.0, xi - 2.0, r + 1.0, lp),
    )
    g = Around(
        slope_reached(down, -1.0, xi + 2.0, r - 1.0, lp),
        -xi / lp - (lp * lp - xi * xi) / (2.0 * lp * (2.0 * r + xi)),
        slope_reached(up, 1.0, xi - 2.0, r + 1.0, lp),
    )
    t = Around(
        down * down / (8.0 * lp) / x, ((4.0 - lp) * lp - xi * xi) / (4.0 * lp) / x, up * up / (8.0 * lp) / x
    )
    return AtNodes(w, w, g, t)


@inline
def inside_cell(f: Lanes, node: Lanes, lp: Lanes, x: Lanes) -> AtNodes:
    """A particle between two nodes. The width 1/2 is built in to v, as in Uintah."""
    none, low, high, c = every(0.0), 1.0 - f, f, 1.0 / (2.0 * (node + f))
    return AtNodes(
        Around(none, low - lp * lp / 6.0 * c, high + lp * lp / 6.0 * c),
        Around(none, low - c / 24.0, high + c / 24.0),
        Around(none, none - 1.0, none + 1.0),
        Around(none, low / x, high / x),
    )


@inline
def beside_axis(f: Lanes, lp: Lanes, h: float) -> AtNodes:
    """The first particle beyond the axis."""
    none, up = every(0.0), 2.0 + lp + (2.0 * f - 2.0)
    w = Around(none, (3.0 - up) / 3.0, up / 3.0)
    t = Around(none, (4.0 / up - 1.0) / h, 1.0 / h + none)
    return AtNodes(w, w, Around(none, none - 1.0, none + 1.0), t)


@implements(radial, GimpAxisymmetric)
def _(interpolator: Any, f: Lanes, width: Lanes, node: Lanes, x: Lanes, h: float) -> Radial:
    """Radius-weighted averages of the hat function (Nairn and Guilkey 2015, their equations for axisymmetric GIMP)."""
    upper = above(f, 0.75)  # 1 where the upper node of the cell is nearest
    at = straddling(2.0 * (f - upper), node + upper, width, x)
    at = where((f > 0.25) & (f <= 0.75), inside_cell(f, node, width, x), at)
    at = where((f <= 0.25) & (x < 0.5 * width * h), beside_axis(f, width, h), at)
    starts = at.w.lower > 0.0
    w, v, g, t = (
        from_lower(starts, at.w),
        from_lower(starts, at.v),
        from_lower(starts, at.g),
        from_lower(starts, at.t),
    )
    below = where(starts, 1.0, 0.0) - upper
    return Radial(
        below,
        w.lower,
        w.middle,
        w.upper,
        v.lower,
        v.middle,
        v.upper,
        g.lower,
        g.middle,
        g.upper,
        t.lower,
        t.middle,
        t.upper,
    )
