"""Flux of a diffusing substance through the surface of a box, a cylinder or a sphere."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from solver.declare import IntVector, Parameter, Vector, model
from solver.geometry.box import Box
from solver.geometry.cylinder import Cylinder
from solver.geometry.piece import Array
from solver.geometry.sphere import Sphere
from solver.grid import Grid
from solver.loads.load import Load
from solver.loads.surface import (
    LoadedSurface,
    along_axis,
    in_lengthened,
    in_widened_box,
    near_side,
    near_sphere,
    require_piece,
    thinnest_direction,
)


@model("load", "scalar_flux")
@dataclass(frozen=True, kw_only=True)
class ScalarFlux(Load):
    """A flux q(t) into the body: concentration times speed. Each surface particle grows by q A / V.

    A is the area of the particle's sides that face the normal n of the surface, |(n_x A_x, n_y A_y, n_z A_z)|,
    with the sides as they were at the start. Unlike in Uintah the normal of a sphere is its radius, not x, and a
    particle on an edge takes the flux of each surface through the side that faces it.
    """

    geom_object: Annotated[LoadedSurface, Parameter("the surface: a box, cylinder or sphere")]
    outward_normal: Annotated[
        bool, Parameter("the side that counts", ignored="a positive flux flows into the body")
    ] = False
    auto_cycle: Annotated[
        bool,
        Parameter("turn the flux at limits of the concentration", unsupported="cycling of charge"),
    ] = False
    res: Annotated[
        IntVector | None, Parameter("particles a cell", ignored="the bodies of the deck give it")
    ] = None

    tag: ClassVar[str] = "scalar_flux"
    rank: ClassVar[int] = 3
    soaks: ClassVar[bool] = True

    def __post_init__(self) -> None:
        require_piece(self.piece, self.tag, Box, Cylinder, Sphere)

    @property
    def piece(self) -> Any:
        """The geometry piece whose surface is passed."""
        return self.geom_object.piece

    def near(self, points: Array, spacing: Vector) -> Array:
        """Which surface particles (n, 3) take part.

        Box: inside it or within a particle spacing in every direction. Cylinder: within 0.9 of the least
        spacing of the side, or of the ends. Sphere: within the diagonal of the spacing.
        """
        piece, tolerance = self.piece, 0.9 * min(spacing)
        if isinstance(piece, Box):
            return in_widened_box(piece, points, spacing)
        if isinstance(piece, Sphere):
            return near_sphere(piece, points, math.hypot(*spacing))
        if self._through_end:
            return in_lengthened(piece, points, tolerance)
        return near_side(piece, points, tolerance)

    @property
    def _through_end(self) -> bool:
        return bool(self.piece.cylinder_end or self.piece.axisymmetric_end)

    def normals(self, points: Array) -> Array:
        """Unit normals of the surface nearest to points (n, 3), of either sign."""
        piece = self.piece
        if isinstance(piece, Box):
            return np.broadcast_to(np.eye(3)[thinnest_direction(piece)], points.shape)
        if isinstance(piece, Sphere):
            return _unit(points - np.array(piece.origin))
        axis = np.array(along_axis(piece))
        if self._through_end:
            return np.broadcast_to(axis, points.shape)
        away = points - np.array(piece.bottom)
        return _unit(away - (away @ axis)[:, None] * axis)

    def law(self, grid: Grid) -> Any:
        """A flux of concentration is no force."""
        return None

    def magnitude(self, time: float, count: int) -> float:
        """The flux."""
        return float(self.load_curve.at(time))


def _unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0)
