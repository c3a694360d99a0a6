"""Torque on the side of a cylinder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from solver.declare import IntVector, Parameter, Vector, model
from solver.geometry.cylinder import Cylinder
from solver.geometry.piece import Array
from solver.grid import Grid
from solver.loads.direction import Around
from solver.loads.load import Load
from solver.loads.surface import LoadedSurface, near_side, require_piece

TOLERANCE = 0.9
"""How far from the side particles still count as on it, in (smallest) particle spacings."""


@model("load", "torque")
@dataclass(frozen=True, kw_only=True)
class Torque(Load):
    """A torque T(t) about the axis of a cylinder, shared by the N surface particles near its side.

    Each gets the tangential force f = (T / N) d / |d|^2 with d = (x - bottom) x axis / |axis|.
    The moment vector is -T axis / |axis| (axis from bottom to top), Uintah's sign. The force is not turned by
    ``keepPressBCNormalToSurface``: it follows the particle's position anyway.
    """

    geom_object: Annotated[LoadedSurface, Parameter("the loaded surface: a cylinder, whose axis is the axis")]
    outward_normal: Annotated[
        bool | None,
        Parameter("whether away from the axis is out of the body; required with CBDI, unused without"),
    ] = None
    res: Annotated[
        IntVector | None, Parameter("particles in a cell", ignored="Uintah does not read it here")
    ] = None

    tag: ClassVar[str] = "torque"
    rank: ClassVar[int] = 2

    def __post_init__(self) -> None:
        require_piece(self.piece, self.tag, Cylinder)

    @property
    def piece(self) -> Any:
        """The cylinder whose side is loaded."""
        return self.geom_object.piece

    @property
    def surface_normal_points_outward(self) -> bool | None:
        """Whether away from the axis is out of the body, if the deck says so."""
        return self.outward_normal

    def near(self, points: Array, spacing: Vector) -> Array:
        """Which surface particles (n, 3) carry the load: within 0.9 of the smallest spacing of the side."""
        return near_side(self.piece, points, TOLERANCE * min(spacing))

    def law(self, grid: Grid) -> Any:
        """Around the axis of the cylinder."""
        return Around(self.piece.bottom, self.piece.axis)

    def magnitude(self, time: float, count: int) -> float:
        """Torque of each of ``count`` particles."""
        return float(self.load_curve.at(time)) / count
