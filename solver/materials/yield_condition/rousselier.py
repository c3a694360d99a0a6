"""The yield condition of porous metals by Rousselier."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import where
from solver.materials.yield_condition import YieldValue, hardening_term, yield_normal, yield_value
from solver.tensor import Tensor, deviator, double_dot, isotropic, norm, trace

LARGEST_EXPONENT = 700.0


@model("yield_condition", "rousselier")
class Rousselier(NamedTuple):
    """Rousselier (1987), Nucl. Eng. Des. 105, 97, for ductile fracture by voids.

    f = sigma_eq / (1 - f) + D sigma_1 f exp(sigma_m / (sigma_1 (1 - f))) - sigma_y at the porosity f. Where
    voids leave no strength the matrix alone counts. (Uintah names this condition but no longer has it.)
    """

    D: Annotated[float, Parameter("coefficient of the voids", ge=0.0)]
    sig_1: Annotated[float, Parameter("stress sigma_1 that scales the mean stress", unit="Pa", gt=0.0)]


@inline
def void_stress(condition: Rousselier, mean_stress: float, porosity: float) -> float:
    """D sigma_1 exp(sigma_m / (sigma_1 (1 - f))), the stress that voids take per porosity."""
    exponent = min(mean_stress / (condition.sig_1 * (1.0 - porosity)), LARGEST_EXPONENT)
    return condition.D * condition.sig_1 * math.exp(exponent)


@implements(yield_value, Rousselier)
@lanewise
def _(
    condition: Rousselier, equivalent_stress: float, stress_trace: float, flow_stress: float, porosity: float
) -> YieldValue:
    left = flow_stress - porosity * void_stress(condition, stress_trace / 3.0, porosity)
    left = where(left < 0.0, flow_stress, left)
    strength = (1.0 - porosity) * left
    return YieldValue(equivalent_stress * equivalent_stress - strength * strength, strength)


@implements(yield_normal, Rousselier)
@lanewise
def _(condition: Rousselier, stress: Tensor, flow_stress: float, porosity: float) -> Tensor:
    s = deviator(stress)
    sound = 1.0 - porosity
    voids = void_stress(condition, trace(stress) / 3.0, porosity) * porosity / (3.0 * condition.sig_1 * sound)
    size = norm(s)
    sheared = size > 0.0
    shear = where(sheared, math.sqrt(1.5) / (sound * where(sheared, size, 1.0)), 0.0)
    return shear * s + isotropic(voids)


@implements(hardening_term, Rousselier)
@lanewise
def _(
    condition: Rousselier,
    stress: Tensor,
    normal: Tensor,
    flow_stress: float,
    slope: float,
    porosity: float,
    nucleation: float,
) -> float:
    """Of the flow stress and of porosity, which evolve as in the model of Gurson."""
    sound = 1.0 - porosity
    mean_stress = trace(stress) / 3.0
    strain_rate = double_dot(stress, normal) / (sound * flow_stress)
    porosity_rate = sound * trace(normal) + nucleation * strain_rate
    voids = void_stress(condition, mean_stress, porosity)
    widening = 1.0 + porosity * mean_stress / (condition.sig_1 * sound * sound)
    by_porosity = math.sqrt(1.5) * norm(deviator(stress)) / (sound * sound) + voids * widening
    return by_porosity * porosity_rate - slope * strain_rate
