"""What the kernels are told of a load in one step."""

from __future__ import annotations

from typing import NamedTuple


class Action(NamedTuple):
    """What one load does at one moment."""

    curve: int
    """Id of the load curve; particles that hold it carry the load."""
    magnitude: float
    """What a particle gets: force, torque or rate of heat; for the end of a wedge the pressure."""
    follow_rotation: bool
    """Whether the force turns with the rotation R of the particle's deformation gradient."""
    outward: bool
    """Whether the law's surface normal points out of the body, which decides between two opposite faces."""
