"""Circular cylinders."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from solver.declare import Parameter, Vector, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, difference, dot, relative_to


@model("geometry", "cylinder")
@dataclass(frozen=True)
class Cylinder(GeometryPiece):
    """The points within a distance of the line from bottom to top, between its ends; the surface is included.

    The last three parameters say which part of the surface a load acts on; they mean nothing for a body.
    """

    bottom: Annotated[Vector, Parameter("centre of one end", unit="m")]
    top: Annotated[Vector, Parameter("centre of the other end", unit="m")]
    radius: Annotated[float, Parameter("radius", unit="m", gt=0.0)]
    cylinder_end: Annotated[bool, Parameter("a load acts on the flat ends instead of the curved side")] = (
        False
    )
    axisymmetric_end: Annotated[
        bool, Parameter("a load acts on the flat ends, in an axisymmetric calculation")
    ] = False
    axisymmetric_side: Annotated[
        bool, Parameter("a load acts on the curved side, in an axisymmetric calculation")
    ] = False

    def __post_init__(self) -> None:
        super().__post_init__()
        if not math.dist(self.bottom, self.top) > 0.0:
            raise ValueError("top and bottom are the same point; a cylinder needs a length")

    @property
    def axis(self) -> Vector:
        """The vector from bottom to top."""
        return difference(self.top, self.bottom)

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the cylinder or on its surface."""
        ax, ay, az = self.axis
        length2 = dot(self.axis, self.axis)
        x, y, z = relative_to(points, self.bottom)
        along = x * ax + y * ay + z * az
        found = (along >= 0.0) & (along <= length2)
        distance2 = ((ay * z - az * y) ** 2 + (az * x - ax * z) ** 2 + (ax * y - ay * x) ** 2) / length2
        found &= distance2 <= self.radius * self.radius
        return found

    def bounding_box(self) -> BoundingBox:
        """The tightest box around the cylinder."""
        length2 = dot(self.axis, self.axis)
        reach = [self.radius * math.sqrt(max(length2 - a * a, 0.0) / length2) for a in self.axis]
        pairs = list(zip(self.bottom, self.top, reach, strict=True))
        x, y, z = ((min(b, t) - r, max(b, t) + r) for b, t, r in pairs)
        return BoundingBox((x[0], y[0], z[0]), (x[1], y[1], z[1]))
