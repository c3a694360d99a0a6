"""Convected particle domain interpolation (Sadeghirad, Brannon and Burghardt 2011)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.declare import model
from solver.dispatch import implements, inline
from solver.grid import GridIndex
from solver.interpolation.shape import particle_domain, reach, shape_functions
from solver.tensor import Tensor, determinant


@model("interpolator", "cpdi", "fast_cpdi")
class Cpdi(NamedTuple):
    """Particles are parallelepipeds that deform with F; S is averaged over their eight corners."""

    critical_length: float = 1.0e10
    """Longest allowed half diagonal of a particle in cells; longer domains are shrunk (cpdi_lcrit)."""

    @staticmethod
    def for_deck(axisymmetric: bool, critical_length: float) -> Cpdi | CpdiAxisymmetric:
        """The interpolator that a deck's flags ask for."""
        return CpdiAxisymmetric() if axisymmetric else Cpdi(critical_length)


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
    s = longest / length if length > longest else 1.0
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
def _(interpolator: CpdiAxisymmetric, deformation_gradient: Tensor, size: Tensor) -> Tensor:
    return deformation_gradient @ size


@inline
def corner_cell(q: float, first: int, nodes: int) -> int:
    """The cell of a corner; a corner beyond the stored nodes uses the outermost cell."""
    return min(max(math.floor(q), first), first + nodes - 2)


@inline
def add_corner(
    grid: GridIndex,
    qx: float,
    qy: float,
    qz: float,
    weight: float,
    alpha: Diagonal,
    n: int,
    nodes: Any,
    weights: Any,
    gradients: Any,
) -> int:
    """Append the eight nodes around a corner: S = weight phi(corner), gradient alpha phi(corner)."""
    i = corner_cell(qx, grid.first[0], grid.nodes[0])
    j = corner_cell(qy, grid.first[1], grid.nodes[1])
    k = corner_cell(qz, grid.first[2], grid.nodes[2])
    row = grid.nodes[0]
    layer = row * grid.nodes[1]
    first = (i - grid.first[0]) + row * (j - grid.first[1]) + layer * (k - grid.first[2])
    fx, fy, fz = qx - i, qy - j, qz - k
    for c in range(2):
        wz = fz if c else 1.0 - fz
        for b in range(2):
            wyz = (fy if b else 1.0 - fy) * wz
            for a in range(2):
                phi = (fx if a else 1.0 - fx) * wyz
                nodes[n] = first + a + row * b + layer * c
                weights[n] = weight * phi
                gradients[n, 0] = alpha.x * phi
                gradients[n, 1] = alpha.y * phi
                gradients[n, 2] = alpha.z * phi
                n += 1
    return n


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


@implements(shape_functions, Cpdi)
def _(
    interpolator: Cpdi,
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
    qx = (x - grid.anchor[0]) / grid.spacing[0]
    qy = (y - grid.anchor[1]) / grid.spacing[1]
    qz = (z - grid.anchor[2]) / grid.spacing[2]
    scale = 1.0 / (4.0 * determinant(r))
    n = 0
    for corner in range(8):
        s1 = 1.0 if corner & 1 else -1.0
        s2 = 1.0 if corner & 2 else -1.0
        s3 = 1.0 if corner & 4 else -1.0
        # alpha = (s1 r2 x r3 + s2 r3 x r1 + s3 r1 x r2) / 4V, divided by the spacing for 1/length
        ax = (
            s1 * (r.yy * r.zz - r.zy * r.yz)
            + s2 * (r.yz * r.zx - r.zz * r.yx)
            + s3 * (r.yx * r.zy - r.zx * r.yy)
        )
        ay = (
            s1 * (r.zy * r.xz - r.xy * r.zz)
            + s2 * (r.zz * r.xx - r.xz * r.zx)
            + s3 * (r.zx * r.xy - r.xx * r.zy)
        )
        az = (
            s1 * (r.xy * r.yz - r.yy * r.xz)
            + s2 * (r.xz * r.yx - r.yz * r.xx)
            + s3 * (r.xx * r.yy - r.yx * r.xy)
        )
        alpha = Diagonal(
            scale * ax / grid.spacing[0], scale * ay / grid.spacing[1], scale * az / grid.spacing[2]
        )
        n = add_corner(
            grid,
            qx + 0.5 * (s1 * r.xx + s2 * r.xy + s3 * r.xz),
            qy + 0.5 * (s1 * r.yx + s2 * r.yy + s3 * r.yz),
            qz + 0.5 * (s1 * r.zx + s2 * r.zy + s3 * r.zz),
            0.125,
            alpha,
            n,
            nodes,
            weights,
            gradients,
        )
    return n


@implements(shape_functions, CpdiAxisymmetric)
def _(
    interpolator: CpdiAxisymmetric,
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
    hx, hy = grid.spacing[0], grid.spacing[1]
    qx, qy = (x - grid.anchor[0]) / hx, (y - grid.anchor[1]) / hy
    # As in Uintah, V holds the hoop stretch F33 although r3 is taken as the unit vector.
    scale = 1.0 / (4.0 * determinant(r))
    n = 0
    for corner in range(4):
        s1 = 1.0 if corner & 1 else -1.0
        s2 = 1.0 if corner & 2 else -1.0
        alpha = Diagonal(scale * (s1 * r.yy - s2 * r.yx) / hx, scale * (s2 * r.xx - s1 * r.xy) / hy, 0.0)
        start = n
        n = add_corner(
            grid,
            qx + 0.5 * (s1 * r.xx + s2 * r.xy),
            qy + 0.5 * (s1 * r.yx + s2 * r.yy),
            0.5,
            0.25,
            alpha,
            n,
            nodes,
            weights,
            gradients,
        )
        for m in range(start, n):
            # phi holds the half that each of the two layers takes; Uintah gives each layer the whole gradient.
            gradients[m, 0] *= 2.0
            gradients[m, 1] *= 2.0
            gradients[m, 2] = weights[m] / x
    return n
