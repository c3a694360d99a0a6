"""Second-order tensors in three dimensions, for kernels that read like their equations.

:class:`Tensor` is a value of nine numbers with the operators of tensor algebra; in kernels it lives in
registers (``solver.jit`` tells numba how). Arrays of tensors have the shape (n, 3, 3); :func:`tensor_at`
and :func:`put_tensor` go between the two.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.dispatch import inline
from solver.lanes import anywhere, where


class Tensor:
    """A 3x3 tensor. ``a + b``, ``a - b``, ``s * a``, ``a * s``, ``a / s``, ``-a``, ``a @ b`` and ``a.T`` work."""

    __slots__ = ("xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz")

    def __init__(
        self,
        xx: float,
        xy: float,
        xz: float,
        yx: float,
        yy: float,
        yz: float,
        zx: float,
        zy: float,
        zz: float,
    ) -> None:
        self.xx, self.xy, self.xz = xx, xy, xz
        self.yx, self.yy, self.yz = yx, yy, yz
        self.zx, self.zy, self.zz = zx, zy, zz

    def __add__(self, other: Tensor) -> Tensor:
        return add(self, other)

    def __sub__(self, other: Tensor) -> Tensor:
        return subtract(self, other)

    def __mul__(self, factor: float) -> Tensor:
        return scale(self, factor)

    def __rmul__(self, factor: float) -> Tensor:
        return scale(self, factor)

    def __truediv__(self, divisor: float) -> Tensor:
        return scale(self, 1.0 / divisor)

    def __neg__(self) -> Tensor:
        return scale(self, -1.0)

    def __matmul__(self, other: Tensor) -> Tensor:
        return matmul(self, other)

    @property
    def T(self) -> Tensor:  # noqa: N802 - the transpose, as numpy names it
        """The transpose."""
        return transpose(self)

    def __repr__(self) -> str:
        return (
            f"Tensor([[{self.xx}, {self.xy}, {self.xz}], [{self.yx}, {self.yy}, {self.yz}], "
            f"[{self.zx}, {self.zy}, {self.zz}]])"
        )


@inline
def add(a: Tensor, b: Tensor) -> Tensor:
    """The sum of two tensors."""
    return Tensor(
        a.xx + b.xx,
        a.xy + b.xy,
        a.xz + b.xz,
        a.yx + b.yx,
        a.yy + b.yy,
        a.yz + b.yz,
        a.zx + b.zx,
        a.zy + b.zy,
        a.zz + b.zz,
    )


@inline
def subtract(a: Tensor, b: Tensor) -> Tensor:
    """The difference of two tensors."""
    return Tensor(
        a.xx - b.xx,
        a.xy - b.xy,
        a.xz - b.xz,
        a.yx - b.yx,
        a.yy - b.yy,
        a.yz - b.yz,
        a.zx - b.zx,
        a.zy - b.zy,
        a.zz - b.zz,
    )


@inline
def scale(a: Tensor, s: float) -> Tensor:
    """A tensor times a number."""
    return Tensor(
        a.xx * s,
        a.xy * s,
        a.xz * s,
        a.yx * s,
        a.yy * s,
        a.yz * s,
        a.zx * s,
        a.zy * s,
        a.zz * s,
    )


@inline
def matmul(a: Tensor, b: Tensor) -> Tensor:
    """The product a_ik b_kj."""
    return Tensor(
        a.xx * b.xx + a.xy * b.yx + a.xz * b.zx,
        a.xx * b.xy + a.xy * b.yy + a.xz * b.zy,
        a.xx * b.xz + a.xy * b.yz + a.xz * b.zz,
        a.yx * b.xx + a.yy * b.yx + a.yz * b.zx,
        a.yx * b.xy + a.yy * b.yy + a.yz * b.zy,
        a.yx * b.xz + a.yy * b.yz + a.yz * b.zz,
        a.zx * b.xx + a.zy * b.yx + a.zz * b.zx,
        a.zx * b.xy + a.zy * b.yy + a.zz * b.zy,
        a.zx * b.xz + a.zy * b.yz + a.zz * b.zz,
    )


@inline
def transpose(a: Tensor) -> Tensor:
    """The transpose."""
    return Tensor(a.xx, a.yx, a.zx, a.xy, a.yy, a.zy, a.xz, a.yz, a.zz)


@inline
def isotropic(s: float) -> Tensor:
    """The tensor s I."""
    return Tensor(s, 0.0, 0.0, 0.0, s, 0.0, 0.0, 0.0, s)


@inline
def trace(a: Tensor) -> float:
    """The trace."""
    return a.xx + a.yy + a.zz


@inline
def deviator(a: Tensor) -> Tensor:
    """The part of a tensor that is left when its mean is taken off the diagonal."""
    return a - isotropic(trace(a) / 3.0)


@inline
def symmetric(a: Tensor) -> Tensor:
    """The symmetric part."""
    xy, xz, yz = 0.5 * (a.xy + a.yx), 0.5 * (a.xz + a.zx), 0.5 * (a.yz + a.zy)
    return Tensor(a.xx, xy, xz, xy, a.yy, yz, xz, yz, a.zz)


@inline
def double_dot(a: Tensor, b: Tensor) -> float:
    """The full contraction a_ij b_ij."""
    return (
        a.xx * b.xx
        + a.xy * b.xy
        + a.xz * b.xz
        + a.yx * b.yx
        + a.yy * b.yy
        + a.yz * b.yz
        + a.zx * b.zx
        + a.zy * b.zy
        + a.zz * b.zz
    )


@inline
def norm(a: Tensor) -> float:
    """The Frobenius norm."""
    return math.sqrt(double_dot(a, a))


@inline
def determinant(a: Tensor) -> float:
    """The determinant, by the rule of Sarrus."""
    return (
        a.xx * a.yy * a.zz
        + a.xy * a.yz * a.zx
        + a.xz * a.yx * a.zy
        - a.xx * a.yz * a.zy
        - a.xy * a.yx * a.zz
        - a.xz * a.yy * a.zx
    )


@inline
def cofactor(a: Tensor) -> Tensor:
    """The cofactor tensor det(a) a^-T."""
    return Tensor(
        a.yy * a.zz - a.yz * a.zy,
        a.yz * a.zx - a.yx * a.zz,
        a.yx * a.zy - a.yy * a.zx,
        a.xz * a.zy - a.xy * a.zz,
        a.xx * a.zz - a.xz * a.zx,
        a.xy * a.zx - a.xx * a.zy,
        a.xy * a.yz - a.xz * a.yy,
        a.xz * a.yx - a.xx * a.yz,
        a.xx * a.yy - a.xy * a.yx,
    )


@inline
def inverse(a: Tensor) -> Tensor:
    """The inverse; the determinant must not vanish."""
    return transpose(cofactor(a)) * (1.0 / determinant(a))


MOST_ITERATIONS = 200
"""After so many the polar decomposition gives up: F is singular or nearly so."""

ROTATION_ERROR = 2.0**-53
"""Square of the norm of (R^T R - I) / 2 at which the polar decomposition ends, that of Uintah."""


@inline
def from_symmetric(xx: float, yy: float, zz: float, xy: float, xz: float, yz: float) -> Tensor:
    """The symmetric tensor of six components."""
    return Tensor(xx, xy, xz, xy, yy, yz, xz, yz, zz)


@inline
def green_strain(F: Tensor) -> Tensor:
    """(F^T F - I) / 2."""
    return from_symmetric(
        0.5 * (F.xx * F.xx + F.yx * F.yx + F.zx * F.zx - 1.0),
        0.5 * (F.xy * F.xy + F.yy * F.yy + F.zy * F.zy - 1.0),
        0.5 * (F.xz * F.xz + F.yz * F.yz + F.zz * F.zz - 1.0),
        0.5 * (F.xx * F.xy + F.yx * F.yy + F.zx * F.zy),
        0.5 * (F.xx * F.xz + F.yx * F.yz + F.zx * F.zz),
        0.5 * (F.xy * F.xz + F.yy * F.yz + F.zy * F.zz),
    )


@inline
def to_laboratory(R: Tensor, a: Tensor) -> Tensor:
    """R a R^T for a symmetric tensor, of which six components are enough."""
    b = R @ a
    return from_symmetric(
        b.xx * R.xx + b.xy * R.xy + b.xz * R.xz,
        b.yx * R.yx + b.yy * R.yy + b.yz * R.yz,
        b.zx * R.zx + b.zy * R.zy + b.zz * R.zz,
        b.xx * R.yx + b.xy * R.yy + b.xz * R.yz,
        b.xx * R.zx + b.xy * R.zy + b.xz * R.zz,
        b.yx * R.zx + b.yy * R.zy + b.yz * R.zz,
    )


@inline
def to_material(R: Tensor, a: Tensor) -> Tensor:
    """R^T a R for a symmetric tensor."""
    return to_laboratory(R.T, a)


@inline
def rotation(F: Tensor) -> Tensor:
    """The rotation R of the polar decomposition F = R U, for det F > 0.

    The iteration of Björck and Bowie (SIAM J. Numer. Anal. 8, 1971), R <- R (I - E) with E = (R^T R - I) / 2,
    started from F scaled to the norm of a rotation. As in Uintah it ends when E:E no longer counts beside 1,
    so R is orthogonal to about 1e-8 or better; going on would part from Uintah's results in the ninth digit.
    """
    identity = isotropic(1.0)
    R = F * math.sqrt(3.0 / double_dot(F, F))
    E = green_strain(R)
    error = double_dot(E, E)
    improves = error > ROTATION_ERROR
    for _ in range(MOST_ITERATIONS):
        if not anywhere(improves):
            break
        R = where(improves, R @ (identity - E), R)
        E = green_strain(R)
        improved = double_dot(E, E)
        improves = improves & (improved < error) & (improved > ROTATION_ERROR)
        error = improved
    return R


class Principal(NamedTuple):
    """Principal values, largest first, of a symmetric tensor."""

    first: float
    second: float
    third: float


LEAST_SHEAR = 1.0e-200
"""Where J2 is smaller, its square root has lost its digits and all principal values are the mean."""


@inline
def cosine_of_third(c: float) -> float:
    """The root x = cos(arccos(c) / 3) of 4 x^3 - 3 x = c for 0 <= c <= 1, to rounding.

    By Newton's iteration from the parabola through both ends, with the slope of the root at c = 0: off by at most
    2e-3, then 4e-6, 3e-11 and nothing.
    """
    low = math.sqrt(0.75)
    x = low + c * (1.0 / 6.0 + c * (5.0 / 6.0 - low))
    for _ in range(3):
        x = (8.0 * x * x * x + c) / (12.0 * x * x - 3.0)
    return x


@inline
def principal_values(a: Tensor) -> Principal:
    """The eigenvalues of a symmetric tensor, largest first, to the rounding of the tensor's size.

    The deviator over 2 sqrt(J2 / 3), u, has three values cos(t) with the same cos(3 t). The one apart is a root of
    4 x^3 - 3 x = cos(3 t); the others lie about -x / 2, each sqrt(3) / 2 sin(t) from it, where sin(3 t) = sin(t)
    (4 x^2 - 1). As sin(3 t) is the size of the part of u^2 beside I and u, two values that meet keep all digits.
    """
    mean = trace(a) / 3.0
    s = deviator(a)
    j2 = 0.5 * double_dot(s, s)
    r = where(j2 > LEAST_SHEAR, 2.0 * math.sqrt(j2 / 3.0), 0.0)
    u = s / where(j2 > LEAST_SHEAR, r, 1.0)
    q = deviator(u @ u)
    cos3 = 4.0 / 3.0 * double_dot(u, q)
    sin3 = math.sqrt(8.0 / 3.0) * norm(q - u * (0.5 * cos3))
    apart = cosine_of_third(abs(cos3))
    sine = sin3 / (4.0 * apart * apart - 1.0)
    far, near = 0.5 * (apart + math.sqrt(3.0) * sine), 0.5 * (apart - math.sqrt(3.0) * sine)
    extended = cos3 >= 0.0
    return Principal(
        mean + r * where(extended, apart, far),
        mean + r * where(extended, -near, near),
        mean - r * where(extended, far, apart),
    )


def tensor_at(array: Any, p: int) -> Tensor:
    """The p-th tensor of an array of shape (n, 3, 3)."""
    return Tensor(
        array[p, 0, 0],
        array[p, 0, 1],
        array[p, 0, 2],
        array[p, 1, 0],
        array[p, 1, 1],
        array[p, 1, 2],
        array[p, 2, 0],
        array[p, 2, 1],
        array[p, 2, 2],
    )


def put_tensor(array: Any, p: int, a: Tensor) -> None:
    """Store a tensor as the p-th of an array of shape (n, 3, 3)."""
    array[p, 0, 0] = a.xx
    array[p, 0, 1] = a.xy
    array[p, 0, 2] = a.xz
    array[p, 1, 0] = a.yx
    array[p, 1, 1] = a.yy
    array[p, 1, 2] = a.yz
    array[p, 2, 0] = a.zx
    array[p, 2, 1] = a.zy
    array[p, 2, 2] = a.zz
