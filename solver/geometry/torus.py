"""Tori."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from solver.declare import Parameter, Vector, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, relative_to


@model("geometry", "torus")
@dataclass(frozen=True)
class Torus(GeometryPiece):
    """The points nearer to a circle than the minor radius; the surface is not included.

    The circle lies around ``axis`` and can be tilted by ``theta``: for the axes z, y and x, about y, x and z.
    """

    center: Annotated[Vector, Parameter("centre of the circle", unit="m")]
    major_radius: Annotated[float, Parameter("radius of the circle", unit="m", ge=0.0)]
    minor_radius: Annotated[float, Parameter("radius of the ring's cross-section", unit="m", gt=0.0)]
    axis: Annotated[str, Parameter("direction around which the circle runs", choices=("x", "y", "z"))]
    theta: Annotated[float, Parameter("angle by which the axis is tilted", unit="rad")] = 0.0

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the torus."""
        x, y, z = relative_to(points, self.center)
        # (p, q) is the plane in which the axis tilts; the third direction is left as it is.
        p, q, third = {"x": (x, y, z), "y": (y, z, x), "z": (x, z, y)}[self.axis]
        c, s = math.cos(-self.theta), math.sin(-self.theta)
        p, q = p * c - q * s, p * s + q * c
        along, across = (q, p) if self.axis == "z" else (p, q)
        from_circle = self.major_radius - np.sqrt(across * across + third * third)
        return from_circle * from_circle + along * along < self.minor_radius * self.minor_radius

    def bounding_box(self) -> BoundingBox:
        """The box around the sphere that holds the torus however it is tilted."""
        (x, y, z), r = self.center, self.major_radius + self.minor_radius
        return BoundingBox((x - r, y - r, z - r), (x + r, y + r, z + r))
