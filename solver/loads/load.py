"""What every load declares and provides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from solver.declare import Parameter, Vector
from solver.geometry.piece import Array
from solver.grid import Grid
from solver.loads.curve import LoadCurve


@dataclass(frozen=True, kw_only=True)
class Load:
    """A load that is shared by the particles near a surface and changes with time along a load curve."""

    load_curve: Annotated[LoadCurve, Parameter("the load against time")]
    particles_on_surface: Annotated[
        int,
        Parameter(
            "number of particles that share the load, as a checkpoint notes it; counted at the start",
            tag="numberOfParticlesOnLoadSurface",
            ge=0,
        ),
    ] = 0

    tag: ClassVar[str]
    """Name of the load in a deck."""
    rank: ClassVar[int]
    """Place of the kind of load in the order in which Uintah numbers load curves."""
    heats: ClassVar[bool] = False
    """Whether the load is a rate of heat instead of a force."""
    soaks: ClassVar[bool] = False
    """Whether the load is a flux of a diffusing substance."""
    along_particle_normals: ClassVar[bool] = False
    """Whether the force acts along the normals of a particle file."""
    follows_rotation: ClassVar[bool] = False
    """Whether ``keepPressBCNormalToSurface`` turns the force with the particle."""

    @property
    def piece(self) -> Any:
        """The geometry piece whose surface is loaded; None where the particles name their curve."""
        return None

    @property
    def surface_normal_points_outward(self) -> bool | None:
        """Whether the normal of the direction law leaves the body; None where the deck does not say."""
        return None

    def near(self, points: Array, spacing: Vector) -> Array:
        """Which surface particles (n, 3) carry the load; ``spacing`` is their initial distance in x, y, z."""
        return np.zeros(len(points), bool)

    def law(self, grid: Grid) -> Any:
        """The direction law for the kernels (see ``solver.loads.direction``); None for what is no force."""
        raise NotImplementedError

    def magnitude(self, time: float, count: int) -> float:
        """What each of ``count`` particles gets at a time: the factor of the law, or the rate of heat."""
        raise NotImplementedError
