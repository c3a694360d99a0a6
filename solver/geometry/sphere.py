"""Spheres."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from solver.declare import Parameter, Vector, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, relative_to


@model("geometry", "sphere")
@dataclass(frozen=True)
class Sphere(GeometryPiece):
    """The points whose distance from the origin is at most the radius."""

    origin: Annotated[Vector, Parameter("centre", unit="m", old_tags=("center",))]
    radius: Annotated[float, Parameter("radius", unit="m", gt=0.0)]

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the sphere or on its surface."""
        x, y, z = relative_to(points, self.origin)
        return x * x + y * y + z * z <= self.radius * self.radius

    def bounding_box(self) -> BoundingBox:
        """The cube around the sphere."""
        (x, y, z), r = self.origin, self.radius
        return BoundingBox((x - r, y - r, z - r), (x + r, y + r, z + r))
