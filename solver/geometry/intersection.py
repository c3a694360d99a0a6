"""Intersections of pieces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from typing import Annotated, Any

import numpy as np

from solver.declare import SubModel, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, as_vector


@model("geometry", "intersection")
@dataclass(frozen=True)
class Intersection(GeometryPiece):
    """The points that lie in all of the pieces."""

    pieces: Annotated[tuple[Any, ...], SubModel("geometry", many=True)]

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.pieces:
            raise ValueError("an intersection needs at least one piece in it")

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in all of the pieces."""
        return reduce(np.logical_and, (piece.inside(points) for piece in self.pieces))

    def bounding_box(self) -> BoundingBox:
        """What the boxes of the pieces have in common; a box of no size if that is nothing."""
        boxes = np.array([piece.bounding_box() for piece in self.pieces])
        upper = boxes[:, 1].min(axis=0)
        return BoundingBox(as_vector(np.minimum(boxes[:, 0].max(axis=0), upper)), as_vector(upper))

    def on_lattice(self, x: Array, y: Array, z: Array) -> Array:
        """Whether lattice points lie in all of the pieces."""
        return reduce(np.logical_and, (piece.on_lattice(x, y, z) for piece in self.pieces))
