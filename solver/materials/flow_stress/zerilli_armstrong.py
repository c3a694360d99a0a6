"""The flow stress of Zerilli and Armstrong for metals."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import where
from solver.materials.flow_stress import flow_stress, hardening_slope, rate_slope
from solver.materials.plasticity_state import PlasticityState

LEAST = 1.0e-8
"""Takes the place of a plastic strain rate of zero, and of a plastic strain of zero in slopes."""


@model("flow_stress", "zerilli_armstrong")
class ZerilliArmstrong(NamedTuple):
    """Zerilli and Armstrong (1987), J. Appl. Phys. 61, 1816, by the mechanics of dislocations.

    sigma = sigma_a + K ep^n + B exp(-beta T) + B_0 sqrt(ep) exp(-alpha T) with
    alpha = alpha_0 - alpha_1 ln r, beta = beta_0 - beta_1 ln r at the plastic strain rate r, and the athermal
    sigma_a = c_0, or sigma_g + k_H / sqrt(l) where c_0 is zero.
    """

    B: Annotated[float, Parameter("thermal stress of body-centred lattices", unit="Pa")]
    beta_0: Annotated[float, Parameter("thermal softening of B", unit="1/K")]
    beta_1: Annotated[float, Parameter("rate coefficient of beta", unit="1/K")]
    B_0: Annotated[float, Parameter("thermal hardening of face-centred lattices", unit="Pa")]
    alpha_0: Annotated[float, Parameter("thermal softening of B_0", unit="1/K")]
    alpha_1: Annotated[float, Parameter("rate coefficient of alpha", unit="1/K")]
    K: Annotated[float, Parameter("athermal hardening coefficient", unit="Pa")]
    n: Annotated[float, Parameter("athermal hardening exponent", ge=0.0)]
    c_0: Annotated[float, Parameter("athermal stress", unit="Pa", ge=0.0)] = 0.0
    sigma_g: Annotated[float, Parameter("stress by solutes and dislocations, where c_0 = 0", unit="Pa")] = 0.0
    k_H: Annotated[float, Parameter("microstructural stress intensity, where c_0 = 0", unit="Pa sqrt(m)")] = (
        0.0
    )
    sqrt_l_inv: Annotated[
        float, Parameter("1 / sqrt(grain size), where c_0 = 0", unit="1/sqrt(m)", ge=0.0)
    ] = 0.0

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        if self.c_0 == 0.0 and self.sigma_g == 0.0 and self.k_H == 0.0:
            return [("c_0", "give c_0, or sigma_g, k_H and sqrt_l_inv, for the athermal stress")]
        return []


class Thermal(NamedTuple):
    """Thermally activated parts of the flow stress."""

    peierls: float
    """B exp(-beta T)."""
    hardening: float
    """B_0 exp(-alpha T), the factor of sqrt(ep)."""


@inline
def thermal_stress(model: ZerilliArmstrong, state: PlasticityState) -> Thermal:
    """The thermally activated parts at the state's plastic strain rate and temperature."""
    rate = where(state.plastic_strain_rate != 0.0, state.plastic_strain_rate, LEAST)
    T = max(state.temperature, 0.0)
    alpha = model.alpha_0 - model.alpha_1 * math.log(rate)
    beta = model.beta_0 - model.beta_1 * math.log(rate)
    return Thermal(model.B * math.exp(-beta * T), model.B_0 * math.exp(-alpha * T))


@implements(flow_stress, ZerilliArmstrong)
@lanewise
def _(model: ZerilliArmstrong, state: PlasticityState) -> float:
    strain = max(state.plastic_strain, 0.0)
    athermal = model.c_0 if model.c_0 != 0.0 else model.sigma_g + model.k_H * model.sqrt_l_inv
    thermal = thermal_stress(model, state)
    return athermal + model.K * strain**model.n + thermal.peierls + thermal.hardening * math.sqrt(strain)


@implements(hardening_slope, ZerilliArmstrong)
@lanewise
def _(model: ZerilliArmstrong, state: PlasticityState) -> float:
    strain = where(state.plastic_strain > 0.0, state.plastic_strain, LEAST)
    thermal = thermal_stress(model, state)
    return model.K * model.n * strain ** (model.n - 1.0) + 0.5 * thermal.hardening / math.sqrt(strain)


@implements(rate_slope, ZerilliArmstrong)
@lanewise
def _(model: ZerilliArmstrong, state: PlasticityState) -> float:
    rate = where(state.plastic_strain_rate != 0.0, state.plastic_strain_rate, LEAST)
    T = max(state.temperature, 0.0)
    root = math.sqrt(max(state.plastic_strain, 0.0))
    thermal = thermal_stress(model, state)
    return (model.beta_1 * thermal.peierls + model.alpha_1 * thermal.hardening * root) * T / rate
