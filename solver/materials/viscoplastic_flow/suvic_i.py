"""SUVIC-I: ice and other creeping solids that remember their strain rate."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import where
from solver.materials.viscoplastic_flow import (
    Elasticity,
    FlowStep,
    Hardening,
    flow,
    initial_hardening,
    overstress,
    stiffness_of,
)
from solver.tensor import Tensor, deviator, double_dot, isotropic

_UNREAD = "Uintah reads and never uses it"


@model("viscoplastic_flow", "suvic_i")
class SuvicI(NamedTuple):
    """Aubertin, Yahya and Julien: strain-rate history-dependent unified viscoplasticity with internal variables.

    With x = sqrt(3/2) |dev(sigma) - B| ice flows at the rate A exp(-Q / R T) <(x - Y) / K>^n. Back stress B,
    yield stress Y and drag stress K approach values that are powers of the rate, so that in steady flow the
    stress is their sum. (Aubertin, Julien, Servant and Gill, Can. Geotech. J. 36, 1999; for ice Yasui and
    Schulson.) The rate of a step is weighted by theta between its start and, linearized, its end.
    """

    coeff_backstress_evol: Annotated[float, Parameter("rate A1 of the back stress", unit="Pa", ge=0.0)] = 75e6
    exponent_backstress_evol: Annotated[float, Parameter("an exponent", ignored=_UNREAD)] = 1.0
    normalizing_backstress: Annotated[float, Parameter("a stress", unit="Pa", ignored=_UNREAD)] = 1.0e6
    coeff_saturation_backstress: Annotated[
        float, Parameter("steady back stress at the reference rate", unit="Pa", gt=0.0)
    ] = 0.1e6
    exponent_backstress: Annotated[float, Parameter("rate over this power of steady back stress", gt=0.0)] = (
        4.0
    )
    ref_strainrate: Annotated[float, Parameter("reference strain rate", unit="1/s", gt=0.0)] = 7.794e-08
    normalizing_inelastic_strainrate: Annotated[
        float, Parameter("factor A of the strain rate", unit="1/s", gt=0.0)
    ] = 5.0e9
    activation_energy: Annotated[float, Parameter("activation energy Q", unit="J/mol", ge=0.0)] = 67500.0
    universal_gas_constant: Annotated[float, Parameter("gas constant R", unit="J/(mol K)", gt=0.0)] = 8.3144
    temperature: Annotated[
        float, Parameter("temperature T of the flow, whatever that of the particle", unit="K", gt=0.0)
    ] = 269.15
    exponent_inelastic_strainrate: Annotated[float, Parameter("exponent n of the overstress", gt=0.0)] = 4.0
    coeff_yieldstress_saturation: Annotated[
        float, Parameter("steady yield stress at the reference rate", unit="Pa", gt=0.0)
    ] = 0.8e6
    exponent_yieldstress: Annotated[
        float, Parameter("rate over this power of steady yield stress", gt=0.0)
    ] = 4.0
    coeff_yieldstress_evol: Annotated[float, Parameter("rate A3 of the yield stress", unit="Pa", ge=0.0)] = (
        1600e6
    )
    exponent_dragstress: Annotated[float, Parameter("an exponent", ignored=_UNREAD)] = 4.0
    coeff_dragstress_evol: Annotated[float, Parameter("rate A5 of the drag stress", unit="Pa", ge=0.0)] = 95e6
    coeff_stress_saturation: Annotated[
        float, Parameter("steady stress at the reference rate", unit="Pa", gt=0.0)
    ] = 1.0e6
    intial_drag: Annotated[float, Parameter("drag stress at the start", unit="Pa", gt=0.0)] = 0.05e6
    initial_yield: Annotated[float, Parameter("yield stress at the start", unit="Pa", ge=0.0)] = 0.0
    integration_parameter_theta: Annotated[
        float, Parameter("weight of the end of the step; 0: explicit", ge=0.0, le=1.0)
    ] = 0.0


@implements(initial_hardening, SuvicI)
def initial_hardening_of_ice(model: SuvicI) -> Hardening:
    """No back stress."""
    return Hardening(model.initial_yield, model.intial_drag, isotropic(0.0))


@inline
def equivalent(reduced: Tensor) -> float:
    """The equivalent of a deviatoric stress."""
    return math.sqrt(1.5 * double_dot(reduced, reduced))


@implements(overstress, SuvicI)
@lanewise
def overstress_of_ice(model: SuvicI, hardening: Hardening, stress: Tensor) -> float:
    """The overstress x - Y."""
    return equivalent(deviator(stress) - hardening.back_stress) - hardening.yield_stress


class Steady(NamedTuple):
    """Internal stresses that steady flow at a rate tends to."""

    yield_stress: float
    drag_stress: float
    back_stress: float


@inline
def steady(model: SuvicI, rate: float, factor: float) -> Steady:
    """The internal stresses of steady flow at a rate; ``factor`` is A exp(-Q / R T)."""
    relative = rate / model.ref_strainrate
    n = model.exponent_inelastic_strainrate
    whole = model.coeff_stress_saturation * relative ** (1.0 / n)
    back = model.coeff_saturation_backstress * relative ** (1.0 / model.exponent_backstress)
    yielding = model.coeff_yieldstress_saturation * relative ** (1.0 / model.exponent_yieldstress)
    return Steady(yielding, (whole - back - yielding) / (rate / factor) ** (1.0 / n), back)


@inline
def approach(stress: float, limit: float, coefficient: float, strain: float) -> float:
    """A stress that grows with inelastic strain towards its limit, from below alone."""
    return where(stress >= limit, stress, stress + coefficient * strain * (1.0 - stress / limit))


@implements(flow, SuvicI)
@lanewise
def flow_of_ice(
    model: SuvicI, hardening: Hardening, stress: Tensor, rate: Tensor, elasticity: Elasticity, dt: float
) -> FlowStep:
    """The rate of flow between start and end of the step, and hardening with it.

    In the derivative of the rate by the drag stress the factor (x - Y) is missing in Uintah; as it weighs the
    linearization alone, and little, it is left out here too.
    """
    back = hardening.back_stress
    n = model.exponent_inelastic_strainrate
    reduced = deviator(stress) - back
    x = equivalent(reduced)
    direction = 1.5 * reduced / x
    factor = model.normalizing_inelastic_strainrate * math.exp(
        -model.activation_energy / model.universal_gas_constant / model.temperature
    )
    relative = (x - hardening.yield_stress) / hardening.drag_stress
    start_rate = factor * relative**n
    by_stress = factor * n * relative ** (n - 1.0) / hardening.drag_stress
    limits = steady(model, start_rate, factor)
    evolution = model.coeff_backstress_evol
    stiff = stiffness_of(elasticity, direction)
    by_reduced = evolution / limits.back_stress * double_dot(direction, back) - evolution
    by_reduced -= double_dot(direction, stiff)
    by_yield = model.coeff_yieldstress_evol * (1.0 - hardening.yield_stress / limits.yield_stress)
    by_drag = model.coeff_dragstress_evol * (1.0 - hardening.drag_stress / limits.drag_stress)
    relaxation = by_stress * (by_yield - by_reduced + by_drag / hardening.drag_stress)
    weight = model.integration_parameter_theta * dt
    loading = by_stress * double_dot(stiff, rate)
    mean_rate = (start_rate + weight * loading) / (1.0 + weight * relaxation)
    strain = mean_rate * dt
    grown = (2.0 / 3.0 * evolution * strain) * direction
    return FlowStep(
        mean_rate,
        direction,
        Hardening(
            approach(hardening.yield_stress, limits.yield_stress, model.coeff_yieldstress_evol, strain),
            approach(hardening.drag_stress, limits.drag_stress, model.coeff_dragstress_evol, strain),
            back + grown - (evolution / limits.back_stress * strain) * back,
        ),
    )
