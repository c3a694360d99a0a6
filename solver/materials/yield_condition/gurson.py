"""The yield condition of porous metals by Gurson, Tvergaard and Needleman."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import where
from solver.materials.yield_condition import YieldValue, hardening_term, yield_normal, yield_value
from solver.tensor import Tensor, deviator, double_dot, isotropic, trace

LARGEST_ARGUMENT = 30.0
"""Of the hyperbolic functions, beyond which there is no strength left anyway."""


@model("yield_condition", "gurson")
class Gurson(NamedTuple):
    """Gurson (1977), J. Eng. Mater. Tech. 99, 2; Tvergaard and Needleman (1984), Acta Metall. 32, 157.

    f = sigma_eq^2 - sigma_y^2 (1 + q3 f*^2 - 2 q1 f* cosh(q2 tr(sigma) / (2 sigma_y))), with f* the porosity
    up to ``f_c`` and f_c + k (porosity - f_c) beyond. Where voids leave no strength the matrix alone counts.
    """

    q1: Annotated[float, Parameter("q1 of Tvergaard", ge=0.0)]
    q2: Annotated[float, Parameter("q2 of Tvergaard", ge=0.0)]
    q3: Annotated[float, Parameter("q3 of Tvergaard, usually q1^2", ge=0.0)]
    k: Annotated[float, Parameter("acceleration of the loss of strength by coalescence", ge=0.0)]
    f_c: Annotated[float, Parameter("porosity at which voids coalesce", ge=0.0)]


@inline
def effective_porosity(condition: Gurson, porosity: float) -> float:
    """f*, which grows faster once voids coalesce."""
    coalesced = condition.f_c + condition.k * (porosity - condition.f_c)
    return where(porosity > condition.f_c, coalesced, porosity)


@inline
def triaxiality(condition: Gurson, stress_trace: float, flow_stress: float) -> float:
    """The argument q2 tr(sigma) / (2 sigma_y) of the hyperbolic functions."""
    argument = 0.5 * condition.q2 * stress_trace / flow_stress
    return min(max(argument, -LARGEST_ARGUMENT), LARGEST_ARGUMENT)


@implements(yield_value, Gurson)
@lanewise
def _(
    condition: Gurson, equivalent_stress: float, stress_trace: float, flow_stress: float, porosity: float
) -> YieldValue:
    f = effective_porosity(condition, porosity)
    x = triaxiality(condition, stress_trace, flow_stress)
    reduction = 1.0 + condition.q3 * f * f - 2.0 * condition.q1 * f * math.cosh(x)
    reduction = where(reduction < 0.0, 1.0, reduction)
    strength2 = flow_stress * flow_stress * reduction
    return YieldValue(equivalent_stress * equivalent_stress - strength2, math.sqrt(strength2))


@implements(yield_normal, Gurson)
@lanewise
def _(condition: Gurson, stress: Tensor, flow_stress: float, porosity: float) -> Tensor:
    f = effective_porosity(condition, porosity)
    x = triaxiality(condition, trace(stress), flow_stress)
    volumetric = condition.q1 * condition.q2 * f * flow_stress * math.sinh(x)
    return 3.0 * deviator(stress) + isotropic(volumetric)


@implements(hardening_term, Gurson)
@lanewise
def _(
    condition: Gurson,
    stress: Tensor,
    normal: Tensor,
    flow_stress: float,
    slope: float,
    porosity: float,
    nucleation: float,
) -> float:
    """Of the flow stress and of porosity (Ramaswamy and Aravas 1998, Comput. Methods 163, 11).

    ep' = sigma : n / ((1 - f) sigma_y) and f' = (1 - f) tr(n) + A ep' for a unit plastic multiplier.
    """
    f = effective_porosity(condition, porosity)
    x = triaxiality(condition, trace(stress), flow_stress)
    opening = where(porosity > condition.f_c, condition.k, 1.0)
    strain_rate = double_dot(stress, normal) / ((1.0 - porosity) * flow_stress)
    porosity_rate = (1.0 - porosity) * trace(normal) + nucleation * strain_rate
    by_porosity = 2.0 * flow_stress * flow_stress * opening * (condition.q1 * math.cosh(x) - condition.q3 * f)
    by_flow_stress = -condition.q1 * f * condition.q2 * trace(stress) * math.sinh(x)
    by_flow_stress += 2.0 * flow_stress * (2.0 * condition.q1 * f * math.cosh(x) - 1.0 - condition.q3 * f * f)
    return by_porosity * porosity_rate + by_flow_stress * slope * strain_rate
