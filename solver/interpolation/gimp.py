"""Generalized interpolation shape functions (Bardenhagen and Kober 2004), uniform particle domains (uGIMP)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.declare import model
from solver.dispatch import implements, inline
from solver.grid import GridIndex
from solver.interpolation.shape import particle_domain, shape_functions
from solver.interpolation.stencil import Stencil, alone, direction, separable, stencil, undeformed
from solver.lanes import Lanes, above
from solver.tensor import Tensor


@model("interpolator", "gimp")
@separable
class Gimp(NamedTuple):
    """Particles are boxes of their initial size; S is the hat function averaged over the box."""

    @staticmethod
    def for_deck(axisymmetric: bool, critical_length: float) -> Gimp | GimpAxisymmetric:
        """The interpolator that a deck's flags ask for."""
        return GimpAxisymmetric() if axisymmetric else Gimp()


class GimpAxisymmetric(NamedTuple):
    """Averages over the particle's cross-section weighted with the radius (Nairn and Guilkey 2015)."""


implements(particle_domain, GimpAxisymmetric)(undeformed)


@implements(direction, Gimp)
def _(interpolator: Gimp, f: Lanes, width: Lanes) -> Stencil:
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


class Radial(NamedTuple):
    """Radial weights w on nodes i, i + 1, i + third; gradients g (per cell), hoop weights t = S/r without the z split.

    ``v`` are the weights that multiply the axial gradient; Uintah writes them with the particle width 1/2 built
    in where the particle lies inside the cell, and so does this.
    """

    third: int
    w0: float
    w1: float
    w2: float
    v0: float
    v1: float
    g0: float
    g1: float
    g2: float
    t0: float
    t1: float
    t2: float


@inline
def straddled(xi: float, r: float, lp: float) -> float:
    """Weight of a node inside the particle: xi is the offset in half cells, r the node's radius in cells."""
    return ((4.0 - lp) * lp - xi * xi) / (4.0 * lp) + xi * (xi * xi - 3.0 * lp * lp) / (
        12.0 * lp * (2.0 * r + xi)
    )


@inline
def reached(distance: float, side: float, xi: float, r: float, lp: float) -> float:
    """Weight of a node that the particle only partly reaches; side is +1 where the node lies above the particle."""
    return distance * distance / (8.0 * lp) * (1.0 - (xi + side * 2.0 * (1.0 - lp)) / (3.0 * (2.0 * r + xi)))


@inline
def radial_average(xi: float, node: float, third: int, half: float, r: float, h: float) -> Radial:
    """Radius-weighted averages of the hat function (Nairn and Guilkey 2015, their equations for axisymmetric GIMP).

    xi : particle's position from node i in half cells; node : radius of node i in cells; half : particle half width
    in cells; r : radius of the particle; h : cell size.
    """
    lp = 2.0 * half
    xi1, node1 = xi - 2.0, node + 1.0
    xi2, node2 = xi - 2.0 * third, node + third
    if xi <= 0.5 and r < half * h:
        w0, w1 = (3.0 - lp - xi) / 3.0, (2.0 + lp + xi1) / 3.0
        t0, t1 = (4.0 / (lp + xi) - 1.0) / h, 1.0 / h
        return Radial(third, w0, w1, 0.0, w0, w1, -0.5, 0.5, 0.0, t0, t1, 0.0)
    if xi <= 0.5:
        d1, d2 = 2.0 + lp + xi1, 2.0 + lp - xi2
        w0, w1 = straddled(xi, node, lp), reached(d1, 1.0, xi1, node1, lp)
        return Radial(
            third,
            w0,
            w1,
            reached(d2, -1.0, xi2, node2, lp),
            w0,
            w1,
            -xi / (2.0 * lp) - (lp * lp - xi * xi) / (4.0 * lp * (2.0 * node + xi)),
            d1 / (4.0 * lp) * (1.0 - (xi1 + 2.0 - lp) / (2.0 * (2.0 * node1 + xi1))),
            -d2 / (4.0 * lp) * (1.0 - (xi2 - 2.0 + lp) / (2.0 * (2.0 * node2 + xi2))),
            ((4.0 - lp) * lp - xi * xi) / (4.0 * lp) / r,
            d1 * d1 / (8.0 * lp) / r,
            d2 * d2 / (8.0 * lp) / r,
        )
    if xi <= 1.5:
        s0, s1 = 0.5 * (2.0 - xi), 0.5 * (2.0 + xi1)
        c0, c1 = 1.0 / (2.0 * node + xi), 1.0 / (2.0 * node1 + xi1)
        return Radial(
            third,
            s0 - lp * lp / 6.0 * c0,
            s1 + lp * lp / 6.0 * c1,
            0.0,
            s0 - c0 / 24.0,
            s1 + c1 / 24.0,
            -0.5,
            0.5,
            0.0,
            s0 / r,
            s1 / r,
            0.0,
        )
    d0, d2 = 2.0 + lp - xi, 2.0 + lp + xi2
    w0, w1 = reached(d0, -1.0, xi, node, lp), straddled(xi1, node1, lp)
    return Radial(
        third,
        w0,
        w1,
        reached(d2, 1.0, xi2, node2, lp),
        w0,
        w1,
        -d0 / (4.0 * lp) * (1.0 - (xi - 2.0 + lp) / (2.0 * (2.0 * node + xi))),
        -xi1 / (2.0 * lp) - (lp * lp - xi1 * xi1) / (4.0 * lp * (2.0 * node1 + xi1)),
        d2 / (4.0 * lp) * (1.0 - (xi2 + 2.0 - lp) / (2.0 * (2.0 * node2 + xi2))),
        d0 * d0 / (8.0 * lp) / r,
        ((4.0 - lp) * lp - xi1 * xi1) / (4.0 * lp) / r,
        d2 * d2 / (8.0 * lp) / r,
    )


@implements(shape_functions, GimpAxisymmetric)
def _(
    interpolator: GimpAxisymmetric,
    grid: GridIndex,
    x: float,
    y: float,
    z: float,
    domain: Tensor,
    nodes: Any,
    weights: Any,
    gradients: Any,
) -> int:
    hx = grid.spacing[0]
    qx = (x - grid.anchor[0]) / hx
    i = math.floor(qx)
    radius = grid.anchor[0] + i * hx
    third = -1 if qx - i <= 0.5 else 2
    R = radial_average(2.0 / hx * (x - radius), radius / hx, third, 0.5 * domain.xx, x, hx)
    Y = alone(Gimp(), grid, 1, y, domain.yy)
    row = grid.nodes[0]
    layer = row * grid.nodes[1]
    first = (i - grid.first[0]) + row * Y.first - layer * grid.first[2]
    w, v, ox = (R.w0, R.w1, R.w2), (R.v0, R.v1, R.w2), (0, 1, R.third)
    g, t = (R.g0 / hx, R.g1 / hx, R.g2 / hx), (R.t0, R.t1, R.t2)
    n = 0
    for b in range(Y.nodes):
        wy, gy = Y.w[b], Y.g[b]
        for a in range(3):
            if w[a] * wy <= 0.0:
                continue
            for c in range(2):
                nodes[n] = first + ox[a] + row * b + layer * c
                weights[n] = 0.5 * w[a] * wy
                gradients[n, 0] = g[a] * wy
                gradients[n, 1] = 0.5 * v[a] * gy
                gradients[n, 2] = 0.5 * t[a] * wy
                n += 1
    return n
