"""The flow stress of Zerilli and Armstrong for polymers."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import where
from solver.materials.flow_stress import flow_stress, hardening_slope, rate_slope
from solver.materials.plasticity_state import PlasticityState

LEAST_RATE = 1.0e-10
"""Takes the place of a plastic strain rate of zero."""
LEAST_STRAIN = 1.0e-8
"""Takes the place of a plastic strain of zero in slopes."""


@model("flow_stress", "zerilli_armstrong_polymer")
class ZerilliArmstrongPolymer(NamedTuple):
    """Zerilli and Armstrong (2007), Acta Mater. 55; pressure raises the strength of a polymer.

    sigma = sigma_g + B exp(-beta (T - T_0)) + B_0 sqrt(omega ep) exp(-alpha (T - T_0)) with
    B = B_pa (1 + B_pb sqrt(p))^B_pn, B_0 = B_0pa (1 + B_0pb sqrt(p))^B_0pn,
    omega = omega_a + omega_b ln r + omega_p sqrt(p), alpha = alpha_0 - alpha_1 ln r and
    beta = beta_0 - beta_1 ln r, at the plastic strain rate r and the pressure p of compression. Hardening
    ends where omega is negative. (Uintah never reads alpha_0 and alpha_1; here they are.)
    """

    sigma_g: Annotated[float, Parameter("athermal stress", unit="Pa")]
    B_pa: Annotated[float, Parameter("thermal stress at zero pressure", unit="Pa")]
    B_pb: Annotated[float, Parameter("pressure coefficient of B", unit="1/sqrt(Pa)")]
    B_pn: Annotated[float, Parameter("pressure exponent of B")]
    beta_0: Annotated[float, Parameter("thermal softening of B", unit="1/K")]
    beta_1: Annotated[float, Parameter("rate coefficient of beta", unit="1/K")]
    T_0: Annotated[float, Parameter("reference temperature", unit="K")]
    B_0pa: Annotated[float, Parameter("thermal hardening at zero pressure", unit="Pa")]
    B_0pb: Annotated[float, Parameter("pressure coefficient of B_0", unit="1/sqrt(Pa)")]
    B_0pn: Annotated[float, Parameter("pressure exponent of B_0")]
    omega_a: Annotated[float, Parameter("constant part of omega")]
    omega_b: Annotated[float, Parameter("rate coefficient of omega")]
    omega_p: Annotated[float, Parameter("pressure coefficient of omega", unit="1/sqrt(Pa)")]
    alpha_0: Annotated[float, Parameter("thermal softening of B_0", unit="1/K")] = 0.0
    alpha_1: Annotated[float, Parameter("rate coefficient of alpha", unit="1/K")] = 0.0


class Thermal(NamedTuple):
    """Thermally activated parts of the flow stress and what they depend on."""

    rate: float
    omega: float
    base: float
    """B exp(-beta (T - T_0))."""
    hardening: float
    """B_0 exp(-alpha (T - T_0)), the factor of sqrt(omega ep)."""


@inline
def thermal_stress(model: ZerilliArmstrongPolymer, state: PlasticityState) -> Thermal:
    """The thermally activated parts at the state's plastic strain rate, temperature and pressure."""
    rate = where(state.plastic_strain_rate != 0.0, state.plastic_strain_rate, LEAST_RATE)
    root = math.sqrt(max(-state.mean_stress, 0.0))
    warmer = state.temperature - model.T_0
    alpha = model.alpha_0 - model.alpha_1 * math.log(rate)
    beta = model.beta_0 - model.beta_1 * math.log(rate)
    omega = model.omega_a + model.omega_b * math.log(rate) + model.omega_p * root
    base = model.B_pa * (1.0 + model.B_pb * root) ** model.B_pn
    hardening = model.B_0pa * (1.0 + model.B_0pb * root) ** model.B_0pn
    return Thermal(
        rate, max(omega, 0.0), base * math.exp(-beta * warmer), hardening * math.exp(-alpha * warmer)
    )


@implements(flow_stress, ZerilliArmstrongPolymer)
@lanewise
def _(model: ZerilliArmstrongPolymer, state: PlasticityState) -> float:
    thermal = thermal_stress(model, state)
    hardening = thermal.hardening * math.sqrt(thermal.omega * state.plastic_strain)
    return model.sigma_g + thermal.base + hardening


@implements(hardening_slope, ZerilliArmstrongPolymer)
@lanewise
def _(model: ZerilliArmstrongPolymer, state: PlasticityState) -> float:
    thermal = thermal_stress(model, state)
    strain = where(state.plastic_strain > 0.0, state.plastic_strain, LEAST_STRAIN)
    return 0.5 * thermal.hardening * math.sqrt(thermal.omega / strain)


@implements(rate_slope, ZerilliArmstrongPolymer)
@lanewise
def _(model: ZerilliArmstrongPolymer, state: PlasticityState) -> float:
    """Slope with omega held, as Uintah takes it."""
    thermal = thermal_stress(model, state)
    strain = where(state.plastic_strain > 0.0, state.plastic_strain, LEAST_STRAIN)
    hardening = model.alpha_1 * thermal.hardening * math.sqrt(thermal.omega * strain)
    return (model.beta_1 * thermal.base + hardening) * (state.temperature - model.T_0) / thermal.rate
