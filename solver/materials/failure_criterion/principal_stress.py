"""Failure at the largest principal stress."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.lanes import where
from solver.materials.failure_criterion import Strength, failure
from solver.tensor import Tensor, principal_values


@model("failure_criterion", "MaximumPrincipalStress")
class MaximumPrincipalStress(NamedTuple):
    """Rankine: failure when the largest principal stress exceeds the strength."""


@implements(failure, MaximumPrincipalStress)
@lanewise
def _(
    criterion: MaximumPrincipalStress, stress: Tensor, deformation_gradient: Tensor, strength: Strength
) -> int:
    return where(principal_values(stress).first > strength.threshold, 1, 0)
