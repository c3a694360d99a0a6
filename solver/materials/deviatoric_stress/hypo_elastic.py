"""Hypoelastic deviatoric stress."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.materials.deviatoric_stress import relax, stress_increment
from solver.tensor import Tensor


@model("deviatoric_stress", "hypoElastic")
class HypoElasticDeviator(NamedTuple):
    """Stress rate in the frame of the material s' = 2 mu dev(d)."""


@implements(stress_increment, HypoElasticDeviator)
@lanewise
def _(
    model: HypoElasticDeviator, elements: Any, p: int, rate: Tensor, shear_modulus: float, dt: float
) -> Tensor:
    return rate * (2.0 * shear_modulus * dt)


@implements(relax, HypoElasticDeviator)
@lanewise
def _(
    model: HypoElasticDeviator, elements: Any, p: int, melted: bool, elastic_rate: Tensor, dt: float
) -> float:
    return 0.0
