"""Failure by friction and cohesion, or by tension."""

from __future__ import annotations

import math
from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.lanes import where
from solver.materials.failure_criterion import Strength, failure
from solver.tensor import Tensor, principal_values


@model("failure_criterion", "MohrCoulomb")
class MohrCoulombFailure(NamedTuple):
    """Coulomb (1776) with a tension cut-off; the strength is the cohesion c.

    Shear failure where (s1 - s3) / 2 > c cos(phi) - (s1 + s3) / 2 sin(phi) with tension positive, tensile
    failure where s1 > ``tensile_cutoff_fraction_of_cohesion`` c.
    """


@implements(failure, MohrCoulombFailure)
@lanewise
def _(criterion: MohrCoulombFailure, stress: Tensor, deformation_gradient: Tensor, strength: Strength) -> int:
    principal = principal_values(stress)
    phi = math.radians(strength.friction_angle)
    radius, centre = 0.5 * (principal.first - principal.third), 0.5 * (principal.first + principal.third)
    shears = radius > strength.threshold * math.cos(phi) - centre * math.sin(phi)
    tears = principal.first > strength.tensile_cutoff * strength.threshold
    return where(shears, 2, where(tears, 1, 0))
