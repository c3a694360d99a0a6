"""Drucker's stability postulate."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, inline, lanewise
from solver.materials.stability import TangentModulus, elastic_stress, is_checked, localizes
from solver.tensor import Tensor, double_dot


@model("stability", "drucker")
class Drucker(NamedTuple):
    """Drucker (1959), J. Appl. Mech. 26, 101: a material is unstable when d : C_ep : d <= 0."""


@inline
def work_rate_falls(rate: Tensor, tangent: TangentModulus) -> bool:
    """Whether the rate of the stress power d : C_ep : d is not positive."""
    elastic = double_dot(rate, elastic_stress(tangent.bulk_modulus, tangent.shear_modulus, rate))
    along = double_dot(tangent.direction, rate)
    return elastic - along * along / tangent.resistance <= 0.0


@implements(is_checked, Drucker)
def _(check: Drucker) -> bool:
    return True


@implements(localizes, Drucker)
@lanewise
def _(check: Drucker, stress: Tensor, rate: Tensor, tangent: TangentModulus) -> bool:
    return work_rate_falls(rate, tangent)
