"""Heat flux through the surface of a box, a cylinder or a sphere."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from solver.declare import Parameter, Vector, model
from solver.geometry.box import Box
from solver.geometry.cylinder import Cylinder
from solver.geometry.piece import Array
from solver.geometry.sphere import Sphere
from solver.grid import Grid
from solver.loads.load import Load
from solver.loads.surface import (
    LoadedSurface,
    face_area,
    in_widened_box,
    near_side,
    near_sphere,
    require_piece,
    side_area,
    sphere_area,
)


@model("load", "heat_flux")
@dataclass(frozen=True, kw_only=True)
class HeatFlux(Load):
    """A heat flux q(t) into the body, shared equally by the N surface particles near a surface: q A / N.

    A is the area of a box across its shortest side, of the curved side of a cylinder, or of a sphere. The
    attributes of a cylinder that choose its ends do not count here.
    """

    geom_object: Annotated[LoadedSurface, Parameter("the heated surface: a box, cylinder or sphere")]

    tag: ClassVar[str] = "heat_flux"
    rank: ClassVar[int] = 4
    heats: ClassVar[bool] = True

    def __post_init__(self) -> None:
        require_piece(self.piece, self.tag, Box, Cylinder, Sphere)

    @property
    def piece(self) -> Any:
        """The geometry piece whose surface is heated."""
        return self.geom_object.piece

    @property
    def area(self) -> float:
        """The area that the flux goes through."""
        piece = self.piece
        if isinstance(piece, Box):
            return face_area(piece)
        return sphere_area(piece) if isinstance(piece, Sphere) else side_area(piece)

    def near(self, points: Array, spacing: Vector) -> Array:
        """Which surface particles (n, 3) are heated.

        Box: inside it or within a particle spacing in every direction. Cylinder: within half the diagonal of
        the spacing of the side. Sphere: within the diagonal.
        """
        piece, diagonal = self.piece, math.hypot(*spacing)
        if isinstance(piece, Box):
            return in_widened_box(piece, points, spacing)
        if isinstance(piece, Sphere):
            return near_sphere(piece, points, diagonal)
        return near_side(piece, points, 0.5 * diagonal)

    def law(self, grid: Grid) -> Any:
        """Heat has no direction."""
        return None

    def magnitude(self, time: float, count: int) -> float:
        """Rate of heat of each of ``count`` particles."""
        return float(self.load_curve.at(time)) * self.area / count
