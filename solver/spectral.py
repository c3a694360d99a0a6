"""Principal values and axes of symmetric tensors, for laws that are written in principal stresses."""

from __future__ import annotations

import math
from typing import NamedTuple

from solver.dispatch import inline
from solver.tensor import Tensor, double_dot, isotropic


class Spectrum(NamedTuple):
    """Principal values, largest first, and the axes that belong to them as the columns of a rotation."""

    first: float
    second: float
    third: float
    axes: Tensor


@inline
def plane_angle(off_diagonal: float, first: float, second: float) -> float:
    """The angle that turns two axes to principal ones, the larger value on the first."""
    return 0.5 * math.atan2(2.0 * off_diagonal, first - second)


@inline
def spectrum(a: Tensor) -> Spectrum:
    """Spectral decomposition of a symmetric tensor by Jacobi's rotations.

    Accurate to rounding for repeated values too. Each sweep turns the xy, xz and yz planes; convergence is
    quadratic, so 12 sweeps are more than ever needed.
    """
    axes = isotropic(1.0)
    smallest = 1.0e-34 * double_dot(a, a)
    for _ in range(12):
        if a.xy * a.xy + a.xz * a.xz + a.yz * a.yz <= smallest:
            break
        angle = plane_angle(a.xy, a.xx, a.yy)
        c, s = math.cos(angle), math.sin(angle)
        turn = Tensor(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
        a, axes = turn.T @ a @ turn, axes @ turn
        angle = plane_angle(a.xz, a.xx, a.zz)
        c, s = math.cos(angle), math.sin(angle)
        turn = Tensor(c, 0.0, -s, 0.0, 1.0, 0.0, s, 0.0, c)
        a, axes = turn.T @ a @ turn, axes @ turn
        angle = plane_angle(a.yz, a.yy, a.zz)
        c, s = math.cos(angle), math.sin(angle)
        turn = Tensor(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
        a, axes = turn.T @ a @ turn, axes @ turn
    x, y, z = a.xx, a.yy, a.zz
    if x < y:
        x, y, axes = y, x, exchange_xy(axes)
    if x < z:
        x, z, axes = z, x, exchange_xz(axes)
    if y < z:
        y, z, axes = z, y, exchange_yz(axes)
    return Spectrum(x, y, z, axes)


@inline
def exchange_xy(a: Tensor) -> Tensor:
    """The tensor with its first two columns exchanged, the third reversed to stay a rotation."""
    return Tensor(a.xy, a.xx, -a.xz, a.yy, a.yx, -a.yz, a.zy, a.zx, -a.zz)


@inline
def exchange_xz(a: Tensor) -> Tensor:
    """The tensor with its outer columns exchanged, the second reversed to stay a rotation."""
    return Tensor(a.xz, -a.xy, a.xx, a.yz, -a.yy, a.yx, a.zz, -a.zy, a.zx)


@inline
def exchange_yz(a: Tensor) -> Tensor:
    """The tensor with its last two columns exchanged, the first reversed to stay a rotation."""
    return Tensor(-a.xx, a.xz, a.xy, -a.yx, a.yz, a.yy, -a.zx, a.zz, a.zy)


@inline
def compose(first: float, second: float, third: float, axes: Tensor) -> Tensor:
    """The symmetric tensor with given principal values on given axes."""
    return axes @ Tensor(first, 0.0, 0.0, 0.0, second, 0.0, 0.0, 0.0, third) @ axes.T
