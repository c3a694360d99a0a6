"""The yield condition of von Mises."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.materials.yield_condition import YieldValue, hardening_term, yield_normal, yield_value
from solver.tensor import Tensor, deviator, double_dot


@model("yield_condition", "vonMises")
class VonMises(NamedTuple):
    """Flow where the equivalent stress reaches the flow stress (1913): f = sigma_eq^2 - sigma_y^2."""


@implements(yield_value, VonMises)
@lanewise
def _(
    condition: VonMises, equivalent_stress: float, stress_trace: float, flow_stress: float, porosity: float
) -> YieldValue:
    return YieldValue(equivalent_stress * equivalent_stress - flow_stress * flow_stress, flow_stress)


@implements(yield_normal, VonMises)
@lanewise
def _(condition: VonMises, stress: Tensor, flow_stress: float, porosity: float) -> Tensor:
    return 3.0 * deviator(stress)


@implements(hardening_term, VonMises)
@lanewise
def _(
    condition: VonMises,
    stress: Tensor,
    normal: Tensor,
    flow_stress: float,
    slope: float,
    porosity: float,
    nucleation: float,
) -> float:
    """-2 sigma_y sigma_y' ep' with the equivalent plastic strain rate ep' = sigma : n / sigma_y."""
    return -2.0 * slope * double_dot(stress, normal)
