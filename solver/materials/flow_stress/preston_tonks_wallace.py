"""The flow stress of Preston, Tonks and Wallace."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, where
from solver.materials.flow_stress import flow_stress, hardening_slope, rate_slope
from solver.materials.plasticity_state import PlasticityState

LEAST_RATE = 1.0e-8
"""Takes the place of a plastic strain rate of zero, 1/s."""
SHOCK_RATE = 1.0e3
"""Plastic strain rate above which the regime of overdriven shocks is looked at, 1/s."""
ATOMIC_MASS_UNIT = 1.66043998903379e-27
"""In kg, as Uintah has it."""


@model("flow_stress", "preston_tonks_wallace")
class PrestonTonksWallace(NamedTuple):
    """Preston, Tonks and Wallace (2003), J. Appl. Phys. 93, 211: from thermal activation to strong shocks.

    sigma = 2 mu (tau_s + a ln(1 - phi exp(-b - theta ep / (a phi)))), a = (s_0 - tau_y) / p,
    b = (tau_s - tau_y) / a, phi = exp(b) - 1, and 2 mu tau_s where tau_s = tau_y. With the plastic strain
    rate r, xi = (4 pi rho / (3 M))^(1/3) sqrt(mu / rho) / 2 and e = erf(kappa (T / T_m) ln(gamma xi / r))
    saturation and yield stress are tau_s = s_0 - (s_0 - s_inf) e, tau_y = y_0 - (y_0 - y_inf) e; above
    1000/s at least tau_s = s_0 (r / (gamma xi))^beta, tau_y = min(y_1 (r / (gamma xi))^y_2, tau_s).
    """

    theta: Annotated[float, Parameter("initial hardening rate", ge=0.0)]
    p: Annotated[float, Parameter("shape of the hardening law", gt=0.0)]
    s0: Annotated[float, Parameter("saturation stress at 0 K, in 2 mu", gt=0.0)]
    sinf: Annotated[float, Parameter("saturation stress near melting, in 2 mu", ge=0.0)]
    kappa: Annotated[float, Parameter("coefficient of temperature", ge=0.0)]
    gamma: Annotated[float, Parameter("coefficient of the strain rate", gt=0.0)]
    y0: Annotated[float, Parameter("yield stress at 0 K, in 2 mu", ge=0.0)]
    yinf: Annotated[float, Parameter("yield stress near melting, in 2 mu", ge=0.0)]
    y1: Annotated[float, Parameter("coefficient of the yield stress at medium rates", ge=0.0)]
    y2: Annotated[float, Parameter("exponent of the yield stress at medium rates", ge=0.0)]
    beta: Annotated[float, Parameter("exponent of the overdriven shock", ge=0.0)]
    M: Annotated[float, Parameter("atomic mass", unit="u", gt=0.0)]
    G0: Annotated[
        float, Parameter("shear modulus at 0 K", unit="Pa", ignored="shear_modulus_model has its own")
    ] = 0.0
    alpha: Annotated[
        float, Parameter("thermal coefficient of G0", ignored="shear_modulus_model has its own")
    ] = 0.0
    alphap: Annotated[
        float, Parameter("thermal coefficient of G0", ignored="shear_modulus_model has its own")
    ] = 0.0


class Rate(NamedTuple):
    """The plastic strain rate in the units of the model."""

    plastic: float
    """1/s, never zero."""
    relative: float
    """In units of gamma xi."""
    homologous: float
    """T / T_m."""


@inline
def rate_of(model: PrestonTonksWallace, state: PlasticityState) -> Rate:
    """The plastic strain rate beside that of a transverse wave crossing an atom."""
    rate = where(state.plastic_strain_rate > 0.0, state.plastic_strain_rate, LEAST_RATE)
    atoms = 4.0 * math.pi * state.density / (3.0 * model.M * ATOMIC_MASS_UNIT)
    xi = 0.5 * atoms ** (1.0 / 3.0) * math.sqrt(state.shear_modulus / state.density)
    return Rate(rate, rate / (model.gamma * xi), state.temperature / state.melt_temperature)


class Limits(NamedTuple):
    """Saturation and yield stress, in units of 2 mu."""

    saturation: float
    yielding: float


@inline
def thermal_limits(model: PrestonTonksWallace, rate: Rate) -> Limits:
    """Saturation and yield stress of thermally activated glide."""
    arrhenius = math.erf(-model.kappa * rate.homologous * math.log(rate.relative))
    return Limits(
        model.s0 - (model.s0 - model.sinf) * arrhenius, model.y0 - (model.y0 - model.yinf) * arrhenius
    )


@inline
def overdriven_limits(model: PrestonTonksWallace, rate: Rate) -> Limits:
    """The larger ones of thermally activated glide and overdriven shock."""
    thermal = thermal_limits(model, rate)
    shock = model.s0 * rate.relative**model.beta
    jump = min(model.y1 * rate.relative**model.y2, shock)
    return Limits(max(thermal.saturation, shock), max(thermal.yielding, jump))


@inline
def limits_at(model: PrestonTonksWallace, rate: Rate) -> Limits:
    """Those of thermally activated glide, and at high rates of overdriven shock."""
    limits = thermal_limits(model, rate)
    fast = rate.plastic > SHOCK_RATE
    if anywhere(fast):
        high = overdriven_limits(model, rate)
        limits = Limits(
            where(fast, high.saturation, limits.saturation), where(fast, high.yielding, limits.yielding)
        )
    return limits


class Voce(NamedTuple):
    """The hardening law between yield and saturation; see the model's docstring."""

    hardens: bool
    """Whether the two differ; elsewhere the other numbers mean nothing."""
    a: float
    b: float
    phi: float
    decay: float
    """theta / (a phi), by plastic strain."""


@inline
def voce(model: PrestonTonksWallace, limits: Limits) -> Voce:
    """The hardening law between two limits."""
    hardens = limits.saturation != limits.yielding
    a = where(hardens, (model.s0 - limits.yielding) / model.p, 1.0)
    b = where(hardens, (limits.saturation - limits.yielding) / a, 1.0)
    phi = math.exp(b) - 1.0
    return Voce(hardens, a, b, phi, model.theta / (a * phi))


@implements(flow_stress, PrestonTonksWallace)
@lanewise
def _(model: PrestonTonksWallace, state: PlasticityState) -> float:
    limits = limits_at(model, rate_of(model, state))
    law = voce(model, limits)
    missing = law.a * math.log(1.0 - law.phi * math.exp(-law.b - law.decay * state.plastic_strain))
    return 2.0 * (limits.saturation + where(law.hardens, missing, 0.0)) * state.shear_modulus


@implements(hardening_slope, PrestonTonksWallace)
@lanewise
def _(model: PrestonTonksWallace, state: PlasticityState) -> float:
    """Slope between the limits of both regimes, at any rate, as Uintah's iteration takes it."""
    law = voce(model, overdriven_limits(model, rate_of(model, state)))
    unsaturated = law.phi * math.exp(-law.b - law.decay * state.plastic_strain)
    slope = 2.0 * state.shear_modulus * law.a * law.decay * unsaturated / (1.0 - unsaturated)
    return where(law.hardens, slope, 0.0)


@implements(rate_slope, PrestonTonksWallace)
@lanewise
def _(model: PrestonTonksWallace, state: PlasticityState) -> float:
    """Slope of thermally activated glide; above 1000/s at least that of the overdriven saturation stress."""
    rate = rate_of(model, state)
    limits = thermal_limits(model, rate)
    argument = -model.kappa * rate.homologous * math.log(rate.relative)
    arrhenius_slope = -2.0 / math.sqrt(math.pi) * math.exp(-argument * argument)
    arrhenius_slope *= model.kappa * rate.homologous / rate.plastic
    saturation_slope = -(model.s0 - model.sinf) * arrhenius_slope
    yield_slope = -(model.y0 - model.yinf) * arrhenius_slope
    law = voce(model, limits)
    a_slope = -yield_slope / model.p
    b_slope = (saturation_slope - yield_slope - law.b * a_slope) / law.a
    decay_slope = -law.decay * (a_slope / law.a + (1.0 + 1.0 / law.phi) * b_slope)
    gone = math.exp(-law.decay * state.plastic_strain)
    unsaturated = law.phi * math.exp(-law.b) * gone
    growth = math.exp(-law.b) * gone * b_slope - unsaturated * state.plastic_strain * decay_slope
    missing = a_slope * math.log(1.0 - unsaturated) - law.a * growth / (1.0 - unsaturated)
    slope = saturation_slope + where(law.hardens, missing, 0.0)
    fast = rate.plastic > SHOCK_RATE
    if anywhere(fast):
        shock = model.beta * model.s0 * rate.relative**model.beta / rate.plastic
        slope = where(fast, max(slope, shock), slope)
    return 2.0 * state.shear_modulus * slope
