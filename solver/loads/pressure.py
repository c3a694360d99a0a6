"""Pressure on the surface of a box, a cylinder or a sphere."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from solver.declare import IntVector, Parameter, Vector, model
from solver.geometry.box import Box
from solver.geometry.cylinder import Cylinder
from solver.geometry.piece import Array
from solver.geometry.sphere import Sphere
from solver.grid import Grid
from solver.loads.direction import Fixed, Radial, Spherical, WedgeEnd
from solver.loads.load import Load
from solver.loads.surface import (
    LoadedSurface,
    along_axis,
    face_area,
    in_lengthened,
    in_widened_box,
    near_side,
    near_sphere,
    require_piece,
    side_area,
    sphere_area,
    thinnest_direction,
)

CYLINDER_TOLERANCE = 1.2
"""How far from a cylinder particles still count as on it, in (smallest) particle spacings."""


@model("load", "pressure")
@dataclass(frozen=True, kw_only=True)
class Pressure(Load):
    """A pressure p(t), shared by the N surface particles near a surface: each gets p A / N along its normal.

    The normal, along which a positive load pushes, is that of the piece, wherever the body lies:

    - box: the positive direction of its shortest side, A the area across it;
    - cylinder: away from the axis, A = 2 pi R L; with ``cylinder_end`` from bottom to top, A = pi R^2;
    - cylinder with ``axisymmetric_side``: away from the axis, A = R L, for a wedge of one radian;
    - cylinder with ``axisymmetric_end``: from bottom to top, and f = p x dx / res_x with the radius x;
    - sphere: away from the centre, A = 4 pi R^2.

    With ``axisymmetric_side`` the distance of the particles from the axis in z counts in the direction, as in
    Uintah; an axis in the middle of the cell's thickness gives the pressure its full radial force.

    N is counted once, at the start, and the area stays the initial one. ``outward_normal`` says, for
    ``use_CBDI_boundary_condition`` only, which face of the particle lies on the boundary; it does not turn
    the force.
    """

    geom_object: Annotated[LoadedSurface, Parameter("the loaded surface: a box, cylinder or sphere")]
    outward_normal: Annotated[
        bool | None,
        Parameter(
            "whether the normal of the piece points out of the body; required with CBDI, unused without"
        ),
    ] = None
    res: Annotated[
        IntVector | None,
        Parameter("particles in a cell in x, y, z; required with axisymmetric_end, unused without", ge=1),
    ] = None

    tag: ClassVar[str] = "pressure"
    rank: ClassVar[int] = 0
    follows_rotation: ClassVar[bool] = True

    def __post_init__(self) -> None:
        require_piece(self.piece, self.tag, Box, Cylinder, Sphere)
        if self._on_wedge_end and self.res is None:
            raise ValueError("<pressure> on an axisymmetric_end needs <res>, the particles in a cell: add it")

    @property
    def piece(self) -> Any:
        """The geometry piece whose surface is loaded."""
        return self.geom_object.piece

    @property
    def surface_normal_points_outward(self) -> bool | None:
        """Whether the normal of the piece points out of the body, if the deck says so."""
        return self.outward_normal

    @property
    def _on_wedge_end(self) -> bool:
        return isinstance(self.piece, Cylinder) and self.piece.axisymmetric_end

    @property
    def _on_end(self) -> bool:
        return isinstance(self.piece, Cylinder) and (self.piece.cylinder_end or self.piece.axisymmetric_end)

    @property
    def area(self) -> float:
        """The area that the pressure acts on; of a wedge of one radian for an axisymmetric surface."""
        piece = self.piece
        if isinstance(piece, Box):
            return face_area(piece)
        if isinstance(piece, Sphere):
            return sphere_area(piece)
        if piece.cylinder_end:
            return math.pi * piece.radius * piece.radius
        if piece.axisymmetric_end:
            return 0.5 * piece.radius * piece.radius
        return side_area(piece) / (2.0 * math.pi) if piece.axisymmetric_side else side_area(piece)

    def near(self, points: Array, spacing: Vector) -> Array:
        """Which surface particles (n, 3) carry the load.

        Box: inside it, or beyond its two large faces by at most a particle spacing. Cylinder: within 1.2 of
        the smallest spacing of the side, or in the cylinder lengthened by that for an end. Sphere: within the
        diagonal of the spacing.
        """
        piece = self.piece
        if isinstance(piece, Box):
            thin = thinnest_direction(piece)
            margin = tuple(spacing[axis] if axis == thin else 0.0 for axis in range(3))
            return in_widened_box(piece, points, (margin[0], margin[1], margin[2]))
        if isinstance(piece, Sphere):
            return near_sphere(piece, points, math.hypot(*spacing))
        tolerance = CYLINDER_TOLERANCE * min(spacing)
        return (in_lengthened if self._on_end else near_side)(piece, points, tolerance)

    def law(self, grid: Grid) -> Any:
        """The direction law: fixed, radial, spherical, or by the area of a wedge."""
        piece = self.piece
        if isinstance(piece, Box):
            thin = thinnest_direction(piece)
            return Fixed((float(thin == 0), float(thin == 1), float(thin == 2)))
        if isinstance(piece, Sphere):
            return Spherical(piece.origin)
        if self._on_wedge_end and self.res is not None:
            return WedgeEnd(along_axis(piece), grid.spacing[0] / self.res[0])
        return Fixed(along_axis(piece)) if self._on_end else Radial(piece.bottom, piece.axis)

    def magnitude(self, time: float, count: int) -> float:
        """Force on each of ``count`` particles, or the pressure itself at the end of a wedge."""
        pressure = float(self.load_curve.at(time))
        return pressure if self._on_wedge_end else pressure * self.area / count
