"""Principal values and axes of symmetric tensors, for laws that are written in principal stresses."""

from __future__ import annotations

import math
from typing import NamedTuple

from solver.dispatch import inline
from solver.lanes import anywhere, like, where
from solver.tensor import Tensor, double_dot, from_symmetric, isotropic


class Spectrum(NamedTuple):
    """Principal values, largest first, and the axes that belong to them as the columns of a rotation."""

    first: float
    second: float
    third: float
    axes: Tensor


class Turned(NamedTuple):
    """A symmetric tensor in a frame, and the axes of that frame as the columns of a rotation."""

    tensor: Tensor
    axes: Tensor


@inline
def turn_in_plane(a: Tensor, axes: Tensor, turns: bool) -> Turned:
    """Turn the first two axes of the frame until they are principal ones of their plane, where it ``turns``.

    By Jacobi's rotation, at most 45 degrees (Golub and Van Loan, Matrix Computations). Then the axes change their
    names, the first to the last, so that the next plane takes its turn.
    """
    xy, difference = where(turns, a.xy, 0.0), a.xx - a.yy
    size = abs(difference) + math.sqrt(difference * difference + 4.0 * xy * xy)
    tangent = 2.0 * where(difference < 0.0, -xy, xy) / where(size > 0.0, size, 1.0)
    c = 1.0 / math.sqrt(1.0 + tangent * tangent)
    s = tangent * c
    normal = a.yy - tangent * xy, a.zz, a.xx + tangent * xy
    turned = from_symmetric(*normal, c * a.yz - s * a.xz, where(turns, 0.0, a.xy), c * a.xz + s * a.yz)
    q = axes
    turned_axes = Tensor(
        c * q.xy - s * q.xx,
        q.xz,
        c * q.xx + s * q.xy,
        c * q.yy - s * q.yx,
        q.yz,
        c * q.yx + s * q.yy,
        c * q.zy - s * q.zx,
        q.zz,
        c * q.zx + s * q.zy,
    )
    return Turned(turned, turned_axes)


@inline
def spectrum(a: Tensor) -> Spectrum:
    """Spectral decomposition of a symmetric tensor by Jacobi's rotations.

    Accurate to rounding for repeated values too. Each sweep turns the three planes; convergence is quadratic, so
    12 sweeps are more than ever needed.
    """
    turned = Turned(a, isotropic(like(1.0, a.xx)))
    smallest = 1.0e-34 * double_dot(a, a)
    for _ in range(12):
        a = turned.tensor
        turns = a.xy * a.xy + a.xz * a.xz + a.yz * a.yz > smallest
        if not anywhere(turns):
            break
        for _ in range(3):
            turned = turn_in_plane(turned.tensor, turned.axes, turns)
    x, y, z, axes = turned.tensor.xx, turned.tensor.yy, turned.tensor.zz, turned.axes
    falls = x < y
    x, y, axes = where(falls, y, x), where(falls, x, y), where(falls, exchange_xy(axes), axes)
    falls = x < z
    x, z, axes = where(falls, z, x), where(falls, x, z), where(falls, exchange_xz(axes), axes)
    falls = y < z
    y, z, axes = where(falls, z, y), where(falls, y, z), where(falls, exchange_yz(axes), axes)
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
