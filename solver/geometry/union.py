"""Unions of pieces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from solver.declare import SubModel, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, as_vector, lattice_window


@model("geometry", "union")
@dataclass(frozen=True)
class Union(GeometryPiece):
    """The points that lie in at least one of the pieces."""

    pieces: Annotated[tuple[Any, ...], SubModel("geometry", many=True)]

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.pieces:
            raise ValueError("a union needs at least one piece in it")

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in any of the pieces."""
        # Sorted by x, the points that a small piece can hold are a short slice, so many pieces cost little.
        order = np.argsort(points[:, 0])
        ordered = points[order]
        found = np.zeros(len(points), bool)
        for piece in self.pieces:
            lower, upper = piece.bounding_box()
            first = max(int(np.searchsorted(ordered[:, 0], lower[0], "left")) - 1, 0)
            near = slice(first, int(np.searchsorted(ordered[:, 0], upper[0], "right")) + 1)
            found[near] |= piece.inside(ordered[near])
        result = np.empty_like(found)
        result[order] = found
        return result

    def bounding_box(self) -> BoundingBox:
        """The box around the boxes of the pieces."""
        boxes = np.array([piece.bounding_box() for piece in self.pieces])
        return BoundingBox(as_vector(boxes[:, 0].min(axis=0)), as_vector(boxes[:, 1].max(axis=0)))

    def on_lattice(self, x: Array, y: Array, z: Array) -> Array:
        """Whether lattice points lie in any piece; each piece is asked about the points near it only."""
        found = np.zeros((len(z), len(y), len(x)), bool)
        for piece in self.pieces:
            window = lattice_window(piece.bounding_box(), x, y, z)
            found[window] |= piece.on_lattice(x[window[2]], y[window[1]], z[window[0]])
        return found
