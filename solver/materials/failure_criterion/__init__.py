"""Criteria by which a particle fails when its stress or strain reaches its strength."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.declare import family
from solver.dispatch import generic
from solver.tensor import Tensor

FAILURE_CRITERION = family(
    "failure_criterion",
    tag="failure_criteria",
    package="solver.materials.failure_criterion",
    key="text",
    meaning="stress or strain that makes a particle fail",
)


class Strength(NamedTuple):
    """What a particle withstands."""

    threshold: float
    """Strain, or stress in Pa."""
    friction_angle: float
    """Degrees."""
    tensile_cutoff: float
    """Largest tension, in cohesions."""


@generic
def failure(criterion: Any, stress: Tensor, deformation_gradient: Tensor, strength: Strength) -> int:
    """0 for a sound particle, else how it fails: 1 in general or in tension, 2 in shear."""
    raise NotImplementedError
