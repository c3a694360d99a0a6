"""Failure at the largest principal strain."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import where
from solver.materials.failure_criterion import Strength, failure
from solver.tensor import Tensor, inverse, isotropic, principal_values


@model("failure_criterion", "MaximumPrincipalStrain")
class MaximumPrincipalStrain(NamedTuple):
    """Failure when the largest principal value of Almansi's strain exceeds the strength."""


@inline
def largest_strain(deformation_gradient: Tensor) -> float:
    """Largest principal value of Almansi's strain (I - (F F^T)^-1) / 2."""
    finger = deformation_gradient @ deformation_gradient.T
    return principal_values(0.5 * (isotropic(1.0) - inverse(finger))).first


@implements(failure, MaximumPrincipalStrain)
@lanewise
def _(
    criterion: MaximumPrincipalStrain, stress: Tensor, deformation_gradient: Tensor, strength: Strength
) -> int:
    return where(largest_strain(deformation_gradient) > strength.threshold, 1, 0)
