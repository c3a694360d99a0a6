"""A piece with another one cut away."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from solver.declare import SubModel, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece


@model("geometry", "difference")
@dataclass(frozen=True)
class Difference(GeometryPiece):
    """The points that lie in the first piece and not in the second."""

    pieces: Annotated[tuple[Any, ...], SubModel("geometry", many=True)]

    def __post_init__(self) -> None:
        super().__post_init__()
        if len(self.pieces) != 2:
            raise ValueError(f"a difference needs exactly two pieces in it, and has {len(self.pieces)}")

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the first piece and not in the second."""
        return self.pieces[0].inside(points) & ~self.pieces[1].inside(points)

    def bounding_box(self) -> BoundingBox:
        """The box of the first piece."""
        return self.pieces[0].bounding_box()

    def on_lattice(self, x: Array, y: Array, z: Array) -> Array:
        """Whether lattice points lie in the first piece and not in the second."""
        return self.pieces[0].on_lattice(x, y, z) & ~self.pieces[1].on_lattice(x, y, z)
