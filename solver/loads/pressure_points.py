"""Pressure on particles that their file names, along the normals that the file gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from solver.declare import IntVector, Parameter, model
from solver.grid import Grid
from solver.loads.direction import AlongNormal
from solver.loads.load import Load


@model("load", "pressure_pts")
@dataclass(frozen=True, kw_only=True)
class PressurePoints(Load):
    """A pressure p(t) on the N particles whose p.loadCurveID in a particle file is this curve's id.

    f = p A / N n with A the given surface area and n the particle's p.normal from the file.
    """

    SurfaceArea: Annotated[float, Parameter("area of the loaded surface", unit="m^2", ge=0.0)]
    res: Annotated[
        IntVector | None, Parameter("particles in a cell", ignored="the particles come from a file")
    ] = None

    tag: ClassVar[str] = "pressure_pts"
    rank: ClassVar[int] = 1
    along_particle_normals: ClassVar[bool] = True
    follows_rotation: ClassVar[bool] = True

    @property
    def surface_normal_points_outward(self) -> bool | None:
        """Normals of particle files point out of the body."""
        return True

    def law(self, grid: Grid) -> Any:
        """Along the particle's own normal."""
        return AlongNormal()

    def magnitude(self, time: float, count: int) -> float:
        """Force on each of ``count`` particles."""
        return float(self.load_curve.at(time)) * self.SurfaceArea / count
