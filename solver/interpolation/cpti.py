"""Convected particle domains that are tetrahedra (Leavy, Guilkey, Phung, Spear and Brannon 2019)."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.declare import model
from solver.dispatch import implements
from solver.grid import GridIndex
from solver.interpolation.cpdi import Diagonal, add_corner, largest_extent, shortened
from solver.interpolation.shape import particle_domain, reach, shape_functions
from solver.tensor import Tensor, determinant


@model("interpolator", "cpti")
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
    return 2.0 * largest_extent(domain)


@implements(shape_functions, Cpti)
def _(
    interpolator: Cpti,
    grid: GridIndex,
    x: float,
    y: float,
    z: float,
    domain: Tensor,
    nodes: Any,
    weights: Any,
    gradients: Any,
) -> int:
    r = domain
    hx, hy, hz = grid.spacing
    qx = (x - grid.anchor[0]) / hx - 0.25 * (r.xx + r.xy + r.xz)
    qy = (y - grid.anchor[1]) / hy - 0.25 * (r.yx + r.yy + r.yz)
    qz = (z - grid.anchor[2]) / hz - 0.25 * (r.zx + r.zy + r.zz)
    # Gradients of the tetrahedron's barycentric coordinates: faces r2 x r3, r3 x r1, r1 x r2 over 6V = det r.
    s = 1.0 / determinant(r)
    a1 = Diagonal(
        s * (r.yy * r.zz - r.zy * r.yz) / hx,
        s * (r.zy * r.xz - r.xy * r.zz) / hy,
        s * (r.xy * r.yz - r.yy * r.xz) / hz,
    )
    a2 = Diagonal(
        s * (r.yz * r.zx - r.zz * r.yx) / hx,
        s * (r.zz * r.xx - r.xz * r.zx) / hy,
        s * (r.xz * r.yx - r.yz * r.xx) / hz,
    )
    a3 = Diagonal(
        s * (r.yx * r.zy - r.zx * r.yy) / hx,
        s * (r.zx * r.xy - r.xx * r.zy) / hy,
        s * (r.xx * r.yy - r.yx * r.xy) / hz,
    )
    a0 = Diagonal(-(a1.x + a2.x + a3.x), -(a1.y + a2.y + a3.y), -(a1.z + a2.z + a3.z))
    n = add_corner(grid, qx, qy, qz, 0.25, a0, 0, nodes, weights, gradients)
    n = add_corner(grid, qx + r.xx, qy + r.yx, qz + r.zx, 0.25, a1, n, nodes, weights, gradients)
    n = add_corner(grid, qx + r.xy, qy + r.yy, qz + r.zy, 0.25, a2, n, nodes, weights, gradients)
    return add_corner(grid, qx + r.xz, qy + r.yz, qz + r.zz, 0.25, a3, n, nodes, weights, gradients)
