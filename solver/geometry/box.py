"""Boxes along the axes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from solver.declare import Parameter, Vector, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece


@model("geometry", "box")
@dataclass(frozen=True)
class Box(GeometryPiece):
    """The box min <= x <= max, its faces included."""

    min: Annotated[Vector, Parameter("lower corner", unit="m")]
    max: Annotated[Vector, Parameter("upper corner", unit="m")]

    def __post_init__(self) -> None:
        super().__post_init__()
        for axis, low, high in zip("xyz", self.min, self.max, strict=True):
            if not high > low:
                raise ValueError(f"max is {high:g} in {axis}; it must be greater than min, which is {low:g}")

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the box or on its faces."""
        found = np.ones(len(points), bool)
        for axis in range(3):
            found &= (points[:, axis] >= self.min[axis]) & (points[:, axis] <= self.max[axis])
        return found

    def bounding_box(self) -> BoundingBox:
        """The box itself."""
        return BoundingBox(self.min, self.max)
