"""The piece that holds nothing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.declare import model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece


@model("geometry", "null")
@dataclass(frozen=True)
class Null(GeometryPiece):
    """No point at all, for a material whose particles come later."""

    def inside(self, points: Array) -> Array:
        """False for all points (n, 3)."""
        return np.zeros(len(points), bool)

    def bounding_box(self) -> BoundingBox:
        """A box of no size."""
        return BoundingBox((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
