"""Circular cones and their frusta."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from solver.declare import Parameter, Vector, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, difference, dot, relative_to


@model("geometry", "cone")
@dataclass(frozen=True)
class Cone(GeometryPiece):
    """A body of revolution whose radius goes linearly from one end to the other; the surface is included."""

    bottom: Annotated[Vector, Parameter("centre of one end", unit="m")]
    top: Annotated[Vector, Parameter("centre of the other end", unit="m")]
    bottom_radius: Annotated[float, Parameter("radius at the bottom", unit="m", ge=0.0)] = 0.0
    top_radius: Annotated[float, Parameter("radius at the top", unit="m", ge=0.0)] = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not math.dist(self.bottom, self.top) > 0.0:
            raise ValueError("top and bottom are the same point; a cone needs a height")
        if self.bottom_radius == 0.0 and self.top_radius == 0.0:
            raise ValueError("bottom_radius and top_radius are both 0; one of them must be greater")

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the cone or on its surface."""
        axis = difference(self.top, self.bottom)
        x, y, z = relative_to(points, self.bottom)
        t = (axis[0] * x + axis[1] * y + axis[2] * z) / dot(axis, axis)
        radius = self.bottom_radius * (1.0 - t) + self.top_radius * t
        off_axis = points - (np.outer(1.0 - t, self.bottom) + np.outer(t, self.top))
        distance = np.sqrt(np.einsum("ij,ij->i", off_axis, off_axis))
        return (t >= 0.0) & (t <= 1.0) & (distance <= radius)

    def bounding_box(self) -> BoundingBox:
        """A box around the spheres about both ends."""
        rb, rt = self.bottom_radius, self.top_radius
        ends = list(zip(self.bottom, self.top, strict=True))
        x, y, z = ((min(b - rb, t - rt), max(b + rb, t + rt)) for b, t in ends)
        return BoundingBox((x[0], y[0], z[0]), (x[1], y[1], z[1]))
