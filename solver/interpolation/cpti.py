"""Convected particle domains that are tetrahedra (Leavy, Guilkey, Phung, Spear and Brannon 2019)."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.grid import GridIndex
from solver.interpolation.corners import DomainCorner, cornered, domain_corner, number_of_corners
from solver.interpolation.cpdi import largest_extent, shortened
from solver.interpolation.shape import particle_domain, reach
from solver.tensor import Tensor, determinant


@model("interpolator", "cpti")
@cornered
class Cpti(NamedTuple):
    """Particles are tetrahedra with edges r1, r2, r3 from one corner; S is averaged over their four corners."""

    critical_length: float = 1.0e10
    """Longest allowed distance from centre to corner in cells (cpdi_lcrit)."""

    @staticmethod
    def for_deck(axisymmetric: bool, critical_length: float) -> Cpti:
        """The interpolator that a deck's flags ask for; there is no axisymmetric form here."""
        if axisymmetric:
            raise ValueError("cpti has no axisymmetric form; use linear, gimp or cpdi")
        return Cpti(critical_length)


@implements(particle_domain, Cpti)
@lanewise
def _(interpolator: Cpti, deformation_gradient: Tensor, size: Tensor) -> Tensor:
    r = deformation_gradient @ size
    longest = interpolator.critical_length
    x, y, z = -0.25 * (r.xx + r.xy + r.xz), -0.25 * (r.yx + r.yy + r.yz), -0.25 * (r.zx + r.zy + r.zz)
    a = shortened(x, y, z, longest)
    b = shortened(x + r.xx, y + r.yx, z + r.zx, longest)
    c = shortened(x + r.xy, y + r.yy, z + r.zy, longest)
    d = shortened(x + r.xz, y + r.yz, z + r.zz, longest)
    return Tensor(
        b.x - a.x,
        c.x - a.x,
        d.x - a.x,
        b.y - a.y,
        c.y - a.y,
        d.y - a.y,
        b.z - a.z,
        c.z - a.z,
        d.z - a.z,
    )


@implements(reach, Cpti)
def _(interpolator: Cpti, domain: Tensor) -> float:
    return 1.0 + 1.5 * (largest_extent(domain) - 1.0)  # a corner is up to three quarters of the edges away


@implements(number_of_corners, Cpti)
def _(interpolator: Cpti) -> int:
    return 4


@implements(domain_corner, Cpti)
@lanewise
def _(interpolator: Cpti, grid: GridIndex, x: float, z: float, domain: Tensor, n: int) -> DomainCorner:
    """G is that of the tetrahedron's barycentric coordinates: faces r2 x r3, r3 x r1, r1 x r2 over 6V = det r."""
    r, (hx, hy, hz) = domain, grid.spacing
    s = 1.0 / determinant(r)
    x0, y0, z0 = -0.25 * (r.xx + r.xy + r.xz), -0.25 * (r.yx + r.yy + r.yz), -0.25 * (r.zx + r.zy + r.zz)
    x1, y1 = s * (r.yy * r.zz - r.zy * r.yz) / hx, s * (r.zy * r.xz - r.xy * r.zz) / hy
    z1 = s * (r.xy * r.yz - r.yy * r.xz) / hz
    x2, y2 = s * (r.yz * r.zx - r.zz * r.yx) / hx, s * (r.zz * r.xx - r.xz * r.zx) / hy
    z2 = s * (r.xz * r.yx - r.yz * r.xx) / hz
    x3, y3 = s * (r.yx * r.zy - r.zx * r.yy) / hx, s * (r.zx * r.xy - r.xx * r.zy) / hy
    z3 = s * (r.xx * r.yy - r.yx * r.xy) / hz
    if n == 0:
        return DomainCorner(
            x0, y0, z0, 0.25, -1.0 * (x1 + x2 + x3), -1.0 * (y1 + y2 + y3), -1.0 * (z1 + z2 + z3)
        )
    if n == 1:
        return DomainCorner(x0 + r.xx, y0 + r.yx, z0 + r.zx, 0.25, x1, y1, z1)
    if n == 2:
        return DomainCorner(x0 + r.xy, y0 + r.yy, z0 + r.zy, 0.25, x2, y2, z2)
    return DomainCorner(x0 + r.xz, y0 + r.yz, z0 + r.zz, 0.25, x3, y3, z3)
