"""What happens to the stress and deformation of failed particles."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from solver.declare import family
from solver.dispatch import generic, inline
from solver.particles import Array, StateVariable
from solver.tensor import Tensor, determinant, isotropic, trace

EROSION = family(
    "erosion",
    tag="erosion",
    package="solver.materials.erosion",
    key="@algorithm",
    meaning="what happens to the stress and deformation of failed particles",
)


class ErosionState(NamedTuple):
    """When each particle failed."""

    failure_time: Annotated[Array, StateVariable("p.timeofloc", initial=-1.0e99)]
    """Start of the step in which the failure state last changed, s."""


class Motion(NamedTuple):
    """Deformation gradient and velocity gradient that a failed particle's stress update is given."""

    deformation_gradient: Tensor
    velocity_gradient: Tensor


@generic
def restrain(algorithm: Any, old_gradient: Tensor, gradient: Tensor, velocity_gradient: Tensor) -> Motion:
    """Motion of a particle that had failed before the step, in place of what the grid says.

    ``old_gradient`` and ``gradient`` are the deformation gradients at the start and end of the step. The
    particle's volume keeps to the grid.
    """
    raise NotImplementedError


@generic
def erode(algorithm: Any, stress: Tensor, failed_for: float) -> Tensor:
    """Stress of a particle that failed ``failed_for`` seconds ago, from what its constitutive model says."""
    raise NotImplementedError


@generic
def lets_fail(algorithm: Any) -> bool:
    """Whether particles of the material fail at all."""
    raise NotImplementedError


@inline
def volumetric_motion(gradient: Tensor, velocity_gradient: Tensor) -> Motion:
    """The part of a motion that changes volume only."""
    stretch = determinant(gradient) ** (1.0 / 3.0)
    return Motion(isotropic(stretch), isotropic(trace(velocity_gradient) / 3.0))
