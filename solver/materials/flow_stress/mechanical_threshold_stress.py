"""The mechanical threshold stress model."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, like, negation, where
from solver.materials.flow_stress import (
    Response,
    flow_stress,
    hardening_slope,
    in_step,
    rate_slope,
    response,
)
from solver.materials.plasticity_state import PlasticityState

LEAST_RATE = 1.0e-7
"""Takes the place of a strain rate of zero, 1/s."""
SUBSTEPS = 4
"""Steps of the midpoint rule for the threshold stress."""
STRESS_TOLERANCE = 1.0
"""Residual of Newton's iteration for the threshold stress, Pa."""
MOST_ITERATIONS = 100


@model("flow_stress", "mts_model")
class MechanicalThresholdStress(NamedTuple):
    """Follansbee and Kocks (1988), Acta Metall. 36, 81; Goto et al. (2000), Scripta Mater. 42, 1125.

    sigma = sigma_a + (S_i sigma_i + S_e sigma_e) mu / mu_0, with the scaling factors
    S = (1 - (k T / (g_0 b^3 mu) ln(edot_0 / r))^(1/q))^(1/p) at the rate r of the whole deformation. The
    threshold stress sigma_e hardens by Voce's law d sigma_e / d ep = theta_0 (1 - F) + theta_IV F,
    F = tanh(alpha sigma_e / sigma_es) / tanh(alpha), theta_0 = a_0 + a_1 ln r + a_2 sqrt(r) - a_3 T, towards
    sigma_es = sigma_es0 (r / edot_es0)^(k T / (g_0es b^3 mu)), at the present rate and temperature from zero
    strain on, by the midpoint rule in four steps. As in Uintah theta_IV enters the slope alone. Above the
    phase transition at T_c six constants change (steels).
    """

    sigma_a: Annotated[float, Parameter("athermal stress", unit="Pa", ge=0.0)]
    mu_0: Annotated[float, Parameter("shear modulus at 0 K", unit="Pa", gt=0.0)]
    D: Annotated[
        float,
        Parameter("constant of the shear modulus", unit="Pa", ignored="shear_modulus_model has its own"),
    ]
    T_0: Annotated[
        float, Parameter("constant of the shear modulus", unit="K", ignored="shear_modulus_model has its own")
    ]
    koverbcubed: Annotated[float, Parameter("Boltzmann's constant / b^3", unit="Pa/K", gt=0.0)]
    g_0i: Annotated[float, Parameter("normalized activation energy of intrinsic barriers", ge=0.0)]
    g_0e: Annotated[float, Parameter("normalized activation energy of evolving barriers", gt=0.0)]
    edot_0i: Annotated[float, Parameter("reference rate of intrinsic barriers", unit="1/s", ge=0.0)]
    edot_0e: Annotated[float, Parameter("reference rate of evolving barriers", unit="1/s", gt=0.0)]
    p_i: Annotated[float, Parameter("exponent p of intrinsic barriers; none if 0", ge=0.0)]
    q_i: Annotated[float, Parameter("exponent q of intrinsic barriers", ge=0.0)]
    p_e: Annotated[float, Parameter("exponent p of evolving barriers", gt=0.0)]
    q_e: Annotated[float, Parameter("exponent q of evolving barriers", gt=0.0)]
    sigma_i: Annotated[float, Parameter("stress of intrinsic barriers", unit="Pa", ge=0.0)]
    a_0: Annotated[float, Parameter("initial hardening rate", unit="Pa")]
    a_1: Annotated[float, Parameter("logarithmic rate coefficient of hardening", unit="Pa")]
    a_2: Annotated[float, Parameter("square-root rate coefficient of hardening", unit="Pa sqrt(s)")]
    a_3: Annotated[float, Parameter("thermal coefficient of hardening", unit="Pa/K")]
    theta_IV: Annotated[float, Parameter("hardening rate of stage IV", unit="Pa")]
    alpha: Annotated[float, Parameter("shape of the hardening law", gt=0.0)]
    edot_es0: Annotated[float, Parameter("reference rate of saturation", unit="1/s", gt=0.0)]
    g_0es: Annotated[float, Parameter("normalized activation energy of saturation", gt=0.0)]
    sigma_es0: Annotated[float, Parameter("saturation stress at 0 K", unit="Pa", gt=0.0)]
    T_c: Annotated[float, Parameter("temperature of the phase transition", unit="K", gt=0.0)] = 10400.0
    g_0i_c: Annotated[float, Parameter("g_0i above T_c", gt=0.0)] = 0.57582
    sigma_i_c: Annotated[float, Parameter("sigma_i above T_c", unit="Pa", ge=0.0)] = 896.14e6
    g_0es_c: Annotated[float, Parameter("g_0es above T_c", gt=0.0)] = 0.294
    sigma_es0_c: Annotated[float, Parameter("sigma_es0 above T_c", unit="Pa", gt=0.0)] = 478.36e6
    a_0_c: Annotated[float, Parameter("a_0 above T_c", unit="Pa")] = 7.5159e9
    a_3_c: Annotated[float, Parameter("a_3 above T_c", unit="Pa/K")] = 3.7796e6

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        if self.p_i == 0.0:
            return []
        return [
            (name, f"intrinsic barriers (p_i = {self.p_i:g}) need a positive {name}")
            for name in ("g_0i", "edot_0i", "q_i")
            if getattr(self, name) == 0.0
        ]


class Phase(NamedTuple):
    """The constants that change at the phase transition."""

    g_0i: float
    sigma_i: float
    g_0es: float
    sigma_es0: float
    a_0: float
    a_3: float


@inline
def phase(model: MechanicalThresholdStress, temperature: float) -> Phase:
    """The constants at a temperature."""
    hot = temperature > model.T_c
    return Phase(
        where(hot, model.g_0i_c, model.g_0i),
        where(hot, model.sigma_i_c, model.sigma_i),
        where(hot, model.g_0es_c, model.g_0es),
        where(hot, model.sigma_es0_c, model.sigma_es0),
        where(hot, model.a_0_c, model.a_0),
        where(hot, model.a_3_c, model.a_3),
    )


@inline
def rate_of(state: PlasticityState) -> float:
    """The strain rate that the model works with, never zero."""
    return where(state.strain_rate != 0.0, state.strain_rate, LEAST_RATE)


@inline
def root(x: float, degree: float) -> float:
    """x^(1/degree); a degree of 1, which is common, costs nothing."""
    return x if degree == 1.0 else x ** (1.0 / degree)


@inline
def activation(thermal_energy: float, reference_rate: float, rate: float, q: float) -> float:
    """The activation term (k T / (g_0 b^3 mu) ln(reference / rate))^(1/q); none above the reference rate."""
    return root(max(thermal_energy * math.log(reference_rate / rate), 0.0), q)


@inline
def scaling(activated: float, p: float) -> float:
    """The scaling factor S = (1 - activation)^(1/p), zero where heat alone overcomes the barriers."""
    free = activated >= 1.0
    return where(free, 0.0, root(where(free, 0.0, 1.0 - activated), p))


@inline
def divisor(saturation: float) -> float:
    """The saturation stress to divide by; where heat leaves none there is no threshold stress either."""
    return where(saturation > 0.0, saturation, 1.0)


@inline
def threshold_stress(
    model: MechanicalThresholdStress, initial_rate: float, saturation: float, strain: float
) -> float:
    """sigma_e after a plastic strain, by the midpoint rule with Newton's iteration in each step."""
    threshold = like(0.0, strain)
    growing = strain > 0.0
    growth = strain / SUBSTEPS * initial_rate
    back = growth / math.tanh(model.alpha)
    sharpness = 0.5 * model.alpha / divisor(saturation)
    for _ in range(SUBSTEPS):
        if not anywhere(growing):
            break
        start = threshold
        seeks = growing
        for _ in range(MOST_ITERATIONS):
            bend = math.tanh(sharpness * (start + threshold))
            residual = threshold + back * bend - start - growth
            closer = abs(threshold - residual / (1.0 + back * sharpness * (1.0 - bend * bend)))
            threshold = where(seeks, closer, threshold)
            seeks = seeks & negation(abs(residual) <= STRESS_TOLERANCE)
            if not anywhere(seeks):
                break
        saturated = threshold > saturation
        threshold = where(saturated, saturation, threshold)
        growing = growing & negation(saturated)
    return threshold


@inline
def scaling_slope(activated: float, p: float, q: float, reference_rate: float, rate: float) -> float:
    """Derivative of the scaling factor by the strain rate."""
    outside = (activated <= 0.0) | (activated >= 1.0)
    order = where(outside, 1.0, math.log(reference_rate / rate))
    chain = where(outside, 0.0, activated) / (p * q * rate * order)
    return chain * where(outside, 1.0, 1.0 - activated) ** (1.0 / p - 1.0)


class InStep(NamedTuple):
    """The law at the rate, temperature and shear modulus of a step."""

    model: MechanicalThresholdStress
    rate: float
    evolving: float
    """Scaling factor S_e of the threshold stress."""
    evolving_activated: float
    intrinsic: float
    """S_i sigma_i."""
    intrinsic_activated: float
    sigma_i: float
    initial_rate: float
    """theta_0, never negative."""
    saturation: float
    """sigma_es."""
    softening: float
    """mu / mu_0."""


@implements(in_step, MechanicalThresholdStress)
@lanewise
def _(model: MechanicalThresholdStress, state: PlasticityState) -> InStep:
    rate, T = rate_of(state), state.temperature
    constants = phase(model, T)
    energy = model.koverbcubed * T / state.shear_modulus
    evolving = activation(energy / model.g_0e, model.edot_0e, rate, model.q_e)
    strength = intrinsic = like(0.0, rate)
    if model.p_i > 0.0:
        intrinsic = activation(energy / constants.g_0i, model.edot_0i, rate, model.q_i)
        strength = scaling(intrinsic, model.p_i) * constants.sigma_i
    rate_part = model.a_1 * math.log(rate) + model.a_2 * math.sqrt(rate)
    return InStep(
        model,
        rate,
        scaling(evolving, model.p_e),
        evolving,
        strength,
        intrinsic,
        constants.sigma_i,
        max(constants.a_0 + rate_part - constants.a_3 * T, 0.0),
        constants.sigma_es0 * (rate / model.edot_es0) ** (energy / constants.g_0es),
        state.shear_modulus / model.mu_0,
    )


@inline
def threshold_of(law: InStep, state: PlasticityState) -> float:
    """The threshold stress sigma_e."""
    return threshold_stress(law.model, law.initial_rate, law.saturation, state.plastic_strain)


@inline
def stress_at(law: InStep, threshold: float) -> float:
    """The flow stress with a threshold stress."""
    return law.model.sigma_a + (law.evolving * threshold + law.intrinsic) * law.softening


@inline
def hardening_at(law: InStep, threshold: float) -> float:
    """The slope by plastic strain, after Voce."""
    F = math.tanh(law.model.alpha * (threshold / divisor(law.saturation))) / math.tanh(law.model.alpha)
    voce = law.initial_rate * (1.0 - F) + law.model.theta_IV * F
    return law.softening * law.evolving * voce


@inline
def rate_slope_at(law: InStep, threshold: float) -> float:
    """The slope by strain rate with the threshold stress held."""
    model, rate = law.model, law.rate
    slope = threshold * scaling_slope(law.evolving_activated, model.p_e, model.q_e, model.edot_0e, rate)
    if model.p_i > 0.0:
        intrinsic = scaling_slope(law.intrinsic_activated, model.p_i, model.q_i, model.edot_0i, rate)
        slope += law.sigma_i * intrinsic
    return slope * law.softening


@implements(response, InStep)
@lanewise
def _(law: InStep, state: PlasticityState) -> Response:
    threshold = threshold_of(law, state)
    return Response(stress_at(law, threshold), hardening_at(law, threshold), rate_slope_at(law, threshold))


@implements(flow_stress, InStep)
@lanewise
def _(law: InStep, state: PlasticityState) -> float:
    return stress_at(law, threshold_of(law, state))


@implements(hardening_slope, InStep)
@lanewise
def _(law: InStep, state: PlasticityState) -> float:
    return hardening_at(law, threshold_of(law, state))


@implements(rate_slope, InStep)
@lanewise
def _(law: InStep, state: PlasticityState) -> float:
    return rate_slope_at(law, threshold_of(law, state))


@implements(flow_stress, MechanicalThresholdStress)
@lanewise
def _(model: MechanicalThresholdStress, state: PlasticityState) -> float:
    return flow_stress(in_step(model, state), state)


@implements(hardening_slope, MechanicalThresholdStress)
@lanewise
def _(model: MechanicalThresholdStress, state: PlasticityState) -> float:
    return hardening_slope(in_step(model, state), state)


@implements(rate_slope, MechanicalThresholdStress)
@lanewise
def _(model: MechanicalThresholdStress, state: PlasticityState) -> float:
    return rate_slope(in_step(model, state), state)
