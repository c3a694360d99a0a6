"""Parallelepipeds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from solver.declare import Parameter, Vector, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, as_vector


@model("geometry", "parallelepiped")
@dataclass(frozen=True)
class Parallelepiped(GeometryPiece):
    """A corner and the three corners next to it.

    As in Uintah, the three faces that meet in p1 are not part of the piece, and the other three are.
    """

    p1: Annotated[Vector, Parameter("a corner", unit="m")]
    p2: Annotated[Vector, Parameter("a corner next to p1", unit="m")]
    p3: Annotated[Vector, Parameter("a corner next to p1", unit="m")]
    p4: Annotated[Vector, Parameter("a corner next to p1", unit="m")]

    def __post_init__(self) -> None:
        super().__post_init__()
        edges = self.edges()
        lengths = np.sqrt((edges**2).sum(axis=0))
        if abs(np.linalg.det(edges)) <= 1.0e-12 * lengths.prod():
            raise ValueError("p1, p2, p3 and p4 lie in a plane; a parallelepiped needs a volume")

    def edges(self) -> Array:
        """The edges p2 - p1, p3 - p1, p4 - p1 as columns, (3, 3)."""
        return (np.array([self.p2, self.p3, self.p4]) - np.array(self.p1)).T

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the parallelepiped, by their coordinates along its edges."""
        coordinates = (points - np.array(self.p1)) @ np.linalg.inv(self.edges()).T
        return np.all((coordinates > 0.0) & (coordinates <= 1.0), axis=1)

    def bounding_box(self) -> BoundingBox:
        """The box around all eight corners."""
        edges = self.edges()
        lower = np.array(self.p1) + np.minimum(edges, 0.0).sum(axis=1)
        upper = np.array(self.p1) + np.maximum(edges, 0.0).sum(axis=1)
        return BoundingBox(as_vector(lower), as_vector(upper))
