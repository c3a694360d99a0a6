"""Bodies in the plane given by their outline."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from solver.declare import Parameter, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, OpenFile
from solver.geometry.read_table import find_file, read_table

RAY = np.array([1.0 / math.pi, math.pi]) / math.hypot(1.0 / math.pi, math.pi)
"""Direction in which crossings of the outline are counted; no deck has an edge along it."""

PARALLEL = 1.0e-10


@model("geometry", "line_segment")
@dataclass(frozen=True)
class LineSegment(GeometryPiece):
    """The inside of a closed polygon in the x-y plane, at any z.

    A point is inside if a ray from it crosses the outline an odd number of times. (Uintah keeps only points
    within 1e-5 of z = 0.)
    """

    name: Annotated[str, Parameter("file with x y of each corner; the last is joined to the first")]
    corners: Array | None = field(default=None, repr=False, compare=False)

    def load(self, open_file: OpenFile) -> LineSegment:
        """The piece with its outline; ValueError if the file is missing or wrong."""
        path = find_file(open_file, self.name, "the corners of the outline")
        corners = read_table(path, 2)
        if len(corners) < 3:
            raise ValueError(f"{path}: an outline needs at least 3 corners, and this has {len(corners)}")
        return replace(self, corners=corners)

    def outline(self) -> Array:
        """The corners (n, 2); ValueError before they are loaded."""
        if self.corners is None:
            raise ValueError(f"the outline {self.name!r} has not been read")
        return self.corners

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the outline."""
        corners = self.outline()
        odd = np.zeros(len(points), bool)
        for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            edge_x, edge_y = x1 - x0, y1 - y0
            across = -edge_x * RAY[1] + edge_y * RAY[0]
            if abs(across) < PARALLEL:
                continue
            x, y = points[:, 0] - x0, points[:, 1] - y0
            along_ray = (edge_x * y - edge_y * x) / across
            along_edge = (-x * RAY[1] + y * RAY[0]) / across
            odd ^= (along_ray >= 0.0) & (along_edge >= 0.0) & (along_edge <= 1.0)
        return odd

    def bounding_box(self) -> BoundingBox:
        """The rectangle around the outline, without end in z."""
        (x0, y0), (x1, y1) = self.outline().min(axis=0), self.outline().max(axis=0)
        return BoundingBox((float(x0), float(y0), -math.inf), (float(x1), float(y1), math.inf))
