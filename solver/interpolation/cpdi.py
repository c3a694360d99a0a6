"""Convected particle domain interpolation (Sadeghirad, Brannon and Burghardt 2011)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.declare import model
from solver.dispatch import implements, inline, lanewise
from solver.grid import GridIndex
from solver.interpolation.corners import DomainCorner, cornered, domain_corner, number_of_corners
from solver.interpolation.shape import particle_domain, reach
from solver.lanes import where
from solver.tensor import Tensor, determinant


@model("interpolator", "cpdi", "fast_cpdi")
@cornered
class Cpdi(NamedTuple):
    """Particles are parallelepipeds that deform with F; S is averaged over their eight corners."""

    critical_length: float = 1.0e10
    """Longest allowed half diagonal of a particle in cells; longer domains are shrunk (cpdi_lcrit)."""

    @staticmethod
    def for_deck(axisymmetric: bool, critical_length: float) -> Cpdi | CpdiAxisymmetric:
        """The interpolator that a deck's flags ask for."""
        return CpdiAxisymmetric() if axisymmetric else Cpdi(critical_length)


@cornered
class CpdiAxisymmetric(NamedTuple):
    """Particles are parallelograms in (r, z) = (x, y); S is averaged over their four corners."""


class Diagonal(NamedTuple):
    """A vector from a particle's centre to a corner, in cells."""

    x: float
    y: float
    z: float


@inline
def shortened(x: float, y: float, z: float, longest: float) -> Diagonal:
    """The vector, or one of length ``longest`` in its direction where it is longer."""
    length = math.sqrt(x * x + y * y + z * z)
    s = where(length > longest, longest / max(length, longest), 1.0)
    return Diagonal(s * x, s * y, s * z)


@inline
def half_diagonal(r: Tensor, s1: float, s2: float, longest: float) -> Diagonal:
    """Centre to the corner (s1 r1 + s2 r2 + r3) / 2, shortened where needed."""
    return shortened(
        0.5 * (s1 * r.xx + s2 * r.xy + r.xz),
        0.5 * (s1 * r.yx + s2 * r.yy + r.yz),
        0.5 * (s1 * r.zx + s2 * r.zy + r.zz),
        longest,
    )


@implements(particle_domain, Cpdi)
@lanewise
def _(interpolator: Cpdi, deformation_gradient: Tensor, size: Tensor) -> Tensor:
    r = deformation_gradient @ size
    longest = interpolator.critical_length
    a, b = half_diagonal(r, 1.0, 1.0, longest), half_diagonal(r, 1.0, -1.0, longest)
    c, d = half_diagonal(r, -1.0, 1.0, longest), half_diagonal(r, -1.0, -1.0, longest)
    return 0.5 * Tensor(
        a.x + b.x - c.x - d.x,
        a.x - b.x + c.x - d.x,
        a.x + b.x + c.x + d.x,
        a.y + b.y - c.y - d.y,
        a.y - b.y + c.y - d.y,
        a.y + b.y + c.y + d.y,
        a.z + b.z - c.z - d.z,
        a.z - b.z + c.z - d.z,
        a.z + b.z + c.z + d.z,
    )


@implements(particle_domain, CpdiAxisymmetric)
@lanewise
def _(interpolator: CpdiAxisymmetric, deformation_gradient: Tensor, size: Tensor) -> Tensor:
    return deformation_gradient @ size


@implements(reach, Cpdi, CpdiAxisymmetric)
def _(interpolator: Any, domain: Tensor) -> float:
    return largest_extent(domain)


@inline
def largest_extent(r: Tensor) -> float:
    """From the centre of a parallelepiped to the farthest node of the cell of a corner, at most, in cells."""
    x = abs(r.xx) + abs(r.xy) + abs(r.xz)
    y = abs(r.yx) + abs(r.yy) + abs(r.yz)
    z = abs(r.zx) + abs(r.zy) + abs(r.zz)
    return 1.0 + 0.5 * max(x, y, z)


@implements(number_of_corners, Cpdi)
def _(interpolator: Cpdi) -> int:
    return 8


@implements(number_of_corners, CpdiAxisymmetric)
def _(interpolator: CpdiAxisymmetric) -> int:
    return 4


@inline
def sign(n: int, bit: int) -> float:
    """On which side of the particle corner ``n`` lies in one direction."""
    return 1.0 if n & bit else -1.0


@implements(domain_corner, Cpdi)
@lanewise
def _(interpolator: Cpdi, grid: GridIndex, x: float, z: float, domain: Tensor, n: int) -> DomainCorner:
    """G = (s1 r2 x r3 + s2 r3 x r1 + s3 r1 x r2) / 4V, divided by the spacing for 1/length."""
    r, s1, s2, s3 = domain, sign(n, 1), sign(n, 2), sign(n, 4)
    scale = 1.0 / (4.0 * determinant(r))
    ax = (
        s1 * (r.yy * r.zz - r.zy * r.yz) + s2 * (r.yz * r.zx - r.zz * r.yx) + s3 * (r.yx * r.zy - r.zx * r.yy)
    )
    ay = (
        s1 * (r.zy * r.xz - r.xy * r.zz) + s2 * (r.zz * r.xx - r.xz * r.zx) + s3 * (r.zx * r.xy - r.xx * r.zy)
    )
    az = (
        s1 * (r.xy * r.yz - r.yy * r.xz) + s2 * (r.xz * r.yx - r.yz * r.xx) + s3 * (r.xx * r.yy - r.yx * r.xy)
    )
    return DomainCorner(
        0.5 * (s1 * r.xx + s2 * r.xy + s3 * r.xz),
        0.5 * (s1 * r.yx + s2 * r.yy + s3 * r.yz),
        0.5 * (s1 * r.zx + s2 * r.zy + s3 * r.zz),
        0.125,
        scale * ax / grid.spacing[0],
        scale * ay / grid.spacing[1],
        scale * az / grid.spacing[2],
    )


@implements(domain_corner, CpdiAxisymmetric)
@lanewise
def _(
    interpolator: CpdiAxisymmetric, grid: GridIndex, x: float, z: float, domain: Tensor, n: int
) -> DomainCorner:
    """As Uintah: V holds the hoop stretch F33 although r3 is taken as the unit vector.

    The linear function holds the half that each of the two layers of nodes takes; each gets the whole gradient.
    """
    r, s1, s2 = domain, sign(n, 1), sign(n, 2)
    scale = 2.0 / (4.0 * determinant(r))
    return DomainCorner(
        0.5 * (s1 * r.xx + s2 * r.xy),
        0.5 * (s1 * r.yx + s2 * r.yy),
        0.5 - (z - grid.anchor[2]) / grid.spacing[2],
        0.25,
        scale * (s1 * r.yy - s2 * r.yx) / grid.spacing[0],
        scale * (s2 * r.xx - s1 * r.xy) / grid.spacing[1],
        0.25 / x,
    )
