"""Ellipsoids, along the axes or turned."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated

import numpy as np

from solver.declare import Parameter, Vector, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, as_vector, dot

TOLERANCE = 1.0e-12


@model("geometry", "ellipsoid")
@dataclass(frozen=True)
class Ellipsoid(GeometryPiece):
    """The points x with (x - c)·E (x - c) <= 1, E having the eigenvalues 1/r² along the semi-axes.

    The semi-axes are v1, v2, v3 if all three are given, else rx, ry, rz along x, y and z.
    """

    origin: Annotated[Vector, Parameter("centre", unit="m")]
    v1: Annotated[Vector, Parameter("first semi-axis", unit="m")] = (0.0, 0.0, 0.0)
    v2: Annotated[Vector, Parameter("second semi-axis, at a right angle to v1", unit="m")] = (0.0, 0.0, 0.0)
    v3: Annotated[Vector, Parameter("third semi-axis, at a right angle to both", unit="m")] = (0.0, 0.0, 0.0)
    rx: Annotated[float, Parameter("semi-axis in x", unit="m", ge=0.0)] = 0.0
    ry: Annotated[float, Parameter("semi-axis in y", unit="m", ge=0.0)] = 0.0
    rz: Annotated[float, Parameter("semi-axis in z", unit="m", ge=0.0)] = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self._is_turned:
            if min(self.rx, self.ry, self.rz) <= 0.0:
                raise ValueError("an ellipsoid needs rx, ry and rz, or v1, v2 and v3, all longer than 0")
            return
        for (one, a), (other, b) in combinations((("v1", self.v1), ("v2", self.v2), ("v3", self.v3)), 2):
            if abs(dot(a, b)) >= TOLERANCE * max(1.0, math.hypot(*a) * math.hypot(*b)):
                raise ValueError(f"{one} and {other} are not at right angles: {one}·{other} = {dot(a, b):g}")

    @property
    def _is_turned(self) -> bool:
        return min(math.hypot(*v) for v in (self.v1, self.v2, self.v3)) > TOLERANCE

    def semi_axes(self) -> Array:
        """The semi-axes as columns, (3, 3)."""
        if self._is_turned:
            return np.array([self.v1, self.v2, self.v3]).T
        return np.diag([self.rx, self.ry, self.rz])

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the ellipsoid or, within 1e-12 of the radius, on its surface."""
        axes = self.semi_axes()
        # x.E x = sum of (x.v)^2 / |v|^4 over the semi-axes v.
        coordinates = (points - np.array(self.origin)) @ (axes / (axes**2).sum(axis=0))
        return (coordinates**2).sum(axis=1) - 1.0 < TOLERANCE

    def bounding_box(self) -> BoundingBox:
        """The tightest box around the ellipsoid."""
        reach = np.sqrt((self.semi_axes() ** 2).sum(axis=1))
        return BoundingBox(as_vector(np.array(self.origin) - reach), as_vector(np.array(self.origin) + reach))
