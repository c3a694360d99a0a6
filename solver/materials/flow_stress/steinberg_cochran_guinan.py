"""The flow stress of Steinberg, Cochran, Guinan and Lund."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, like, negation, where
from solver.materials.flow_stress import flow_stress, hardening_slope, rate_slope
from solver.materials.plasticity_state import PlasticityState

LEAST_RATE = 1.0e-6
"""Below this plastic strain rate (1/s) there is no thermally activated stress."""
TOLERANCE = 1.0e-6
"""Of the thermally activated stress: relative in Newton's iteration, in Pa in bisection; and of its rate."""
MOST_ITERATIONS = 100
THERMAL = ("energy_to_form_kink_pair", "Peierls_stress")
"""Fields without which nothing is thermally activated."""


@model("flow_stress", "steinberg_cochran_guinan")
class SteinbergCochranGuinan(NamedTuple):
    """Steinberg, Cochran and Guinan (1980), J. Appl. Phys. 51, 1498; Steinberg and Lund (1989), 65, 1528.

    sigma = (min(sigma_0 (1 + beta (ep + epsilon_p0))^n, Y_max) + sigma_t) mu / mu_0. The thermally activated
    sigma_t <= sigma_p solves r = 1 / (exp(2 U_k / (k T) (1 - sigma_t / sigma_p)^2) / C1 + C2 / sigma_t) at
    the plastic strain rate r (Hoge and Mukherjee 1977). Where C1 or C2 is zero they follow from dislocations:
    C1 = rho L a b^2 nu / (2 w^2), C2 = D / (rho b^2).
    """

    mu_0: Annotated[float, Parameter("shear modulus in the reference state", unit="Pa", gt=0.0)]
    A: Annotated[
        float, Parameter("pressure coefficient", unit="1/Pa", ignored="shear_modulus_model has its own")
    ]
    B: Annotated[
        float, Parameter("thermal coefficient", unit="1/K", ignored="shear_modulus_model has its own")
    ]
    sigma_0: Annotated[float, Parameter("athermal yield stress", unit="Pa", ge=0.0)]
    beta: Annotated[float, Parameter("work-hardening coefficient", ge=0.0)]
    n: Annotated[float, Parameter("work-hardening exponent", ge=0.0)]
    epsilon_p0: Annotated[float, Parameter("initial plastic strain", ge=0.0)]
    Y_max: Annotated[float, Parameter("largest athermal stress", unit="Pa", gt=0.0)]
    T_m0: Annotated[
        float, Parameter("melting temperature", unit="K", ignored="melting_temp_model has its own")
    ]
    a: Annotated[float, Parameter("volume correction of gamma", ignored="melting_temp_model has its own")]
    Gamma_0: Annotated[float, Parameter("Grueneisen's gamma", ignored="melting_temp_model has its own")]
    energy_to_form_kink_pair: Annotated[float, Parameter("U_k", unit="eV or J", ge=0.0)] = 0.0
    Boltzmann_constant: Annotated[float, Parameter("k", unit="eV/K or J/K as U_k", gt=0.0)] = 8.617385e-5
    Peierls_stress: Annotated[
        float, Parameter("sigma_p; zero leaves out the thermally activated stress", unit="Pa", ge=0.0)
    ] = 0.0
    C1: Annotated[float, Parameter("rate of thermal activation", unit="1/s", ge=0.0)] = 0.0
    C2: Annotated[float, Parameter("drag coefficient", unit="Pa s", ge=0.0)] = 0.0
    dislocation_density: Annotated[float, Parameter("rho", unit="1/m^2", ge=0.0)] = 0.0
    length_of_dislocation_segment: Annotated[float, Parameter("L", unit="m", ge=0.0)] = 0.0
    distance_between_Peierls_valleys: Annotated[float, Parameter("a", unit="m", ge=0.0)] = 0.0
    length_of_Burger_vector: Annotated[float, Parameter("b", unit="m", ge=0.0)] = 0.0
    Debye_frequency: Annotated[float, Parameter("nu", unit="1/s", ge=0.0)] = 0.0
    width_of_kink_loop: Annotated[float, Parameter("w", unit="m", ge=0.0)] = 0.0
    drag_coefficient: Annotated[float, Parameter("D", unit="Pa s", ge=0.0)] = 0.0

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        dislocations = self._fields[self._fields.index("dislocation_density") :]
        if not any(getattr(self, name) for name in (*THERMAL, "C1", "C2", *dislocations)):
            return []
        needed = THERMAL if self.C1 > 0.0 and self.C2 > 0.0 else (*THERMAL, *dislocations)
        return [
            (name, f"{name} is missing: thermal activation needs U_k, sigma_p, and C1 and C2 or dislocations")
            for name in needed
            if getattr(self, name) == 0.0
        ]


class Activation(NamedTuple):
    """The constants of thermally activated glide."""

    C1: float
    C2: float
    energy: float
    """2 U_k / (k T)."""
    peierls_stress: float


@inline
def activation(model: SteinbergCochranGuinan, temperature: float) -> Activation:
    """The constants of thermally activated glide at a temperature."""
    C1, C2 = model.C1, model.C2
    if C1 == 0.0 or C2 == 0.0:
        b2 = model.length_of_Burger_vector * model.length_of_Burger_vector
        swept = model.length_of_dislocation_segment * model.distance_between_Peierls_valleys * b2
        width2 = model.width_of_kink_loop * model.width_of_kink_loop
        C1 = model.dislocation_density * swept * model.Debye_frequency / (2.0 * width2)
        C2 = model.drag_coefficient / (model.dislocation_density * b2)
    energy = 2.0 * model.energy_to_form_kink_pair / (model.Boltzmann_constant * temperature)
    return Activation(C1, C2, energy, model.Peierls_stress)


class RateOfStress(NamedTuple):
    """The strain rate at a thermally activated stress and its derivative."""

    rate: float
    slope: float


@inline
def rate_at(glide: Activation, stress: float) -> RateOfStress:
    """Plastic strain rate at a thermally activated stress: C1 s / (C1 C2 + s e), e = exp(U (1 - s/s_p)^2)."""
    distance = 1.0 - stress / glide.peierls_stress
    exponent = glide.energy * distance * distance
    possible = exponent <= 700.0
    slow = math.exp(where(possible, exponent, 0.0)) * stress
    drag = glide.C1 * glide.C2
    steepness = 2.0 * slow * glide.energy * distance * stress / glide.peierls_stress + drag
    total = drag + slow
    rate, slope = glide.C1 * stress / total, glide.C1 * steepness / (total * total)
    return RateOfStress(where(possible, rate, 0.0), where(possible, slope, 0.0))


@inline
def bisected_stress(glide: Activation, rate: float) -> float:
    """Thermally activated stress at a plastic strain rate, by bisection up to the Peierls stress."""
    low, high = like(TOLERANCE, rate), like(glide.peierls_stress, rate)
    low_excess = rate - rate_at(glide, low).rate
    for _ in range(MOST_ITERATIONS):
        wide = high - low > TOLERANCE
        if not anywhere(wide):
            break
        middle = 0.5 * (high + low)
        excess = rate - rate_at(glide, middle).rate
        above = low_excess * excess > 0.0
        low_excess = where(wide & above, excess, low_excess)
        low, high = where(wide & above, middle, low), where(wide & negation(above), middle, high)
    return 0.5 * (high + low)


@inline
def thermal_stress(model: SteinbergCochranGuinan, rate: float, temperature: float) -> float:
    """Thermally activated stress at a plastic strain rate, where the model has any."""
    if model.Peierls_stress == 0.0:
        return like(0.0, rate)
    return activated_stress(model, rate, temperature)


@inline
def activated_stress(model: SteinbergCochranGuinan, rate: float, temperature: float) -> float:
    """Thermally activated stress at a plastic strain rate, by Newton's iteration, else by bisection."""
    glide = activation(model, temperature)
    peierls = glide.peierls_stress
    glides = rate >= LEAST_RATE
    found = where(glides, peierls, 0.0)
    unknown = glides & (rate <= rate_at(glide, like(peierls, rate)).rate)
    iterates = unknown
    stress = like(0.5 * peierls, rate)
    for _ in range(MOST_ITERATIONS):
        at = rate_at(glide, stress)
        iterates = iterates & (abs(at.slope) > 0.0)
        if not anywhere(iterates):
            break
        change = (rate - at.rate) / at.slope
        stress = where(iterates, stress + change, stress)
        ends = (abs(change) < TOLERANCE * stress) | (abs(rate - at.rate) <= TOLERANCE)
        found = where(iterates & ends, min(max(stress, 0.0), peierls), found)
        unknown = unknown & negation(iterates & ends)
        iterates = iterates & negation(ends)
    if anywhere(unknown):
        found = where(unknown, bisected_stress(glide, rate), found)
    return found


@implements(flow_stress, SteinbergCochranGuinan)
@lanewise
def _(model: SteinbergCochranGuinan, state: PlasticityState) -> float:
    hardened = model.sigma_0 * (1.0 + model.beta * (state.plastic_strain + model.epsilon_p0)) ** model.n
    thermal = thermal_stress(model, state.plastic_strain_rate, state.temperature)
    return (thermal + min(hardened, model.Y_max)) * (state.shear_modulus / model.mu_0)


@implements(hardening_slope, SteinbergCochranGuinan)
@lanewise
def _(model: SteinbergCochranGuinan, state: PlasticityState) -> float:
    """Slope of the hardening law, also beyond ``Y_max``, as Uintah's iteration takes it."""
    hardened = 1.0 + model.beta * (state.plastic_strain + model.epsilon_p0)
    slope = model.sigma_0 * model.n * model.beta * hardened ** (model.n - 1.0)
    return slope * (state.shear_modulus / model.mu_0)


@implements(rate_slope, SteinbergCochranGuinan)
@lanewise
def _(model: SteinbergCochranGuinan, state: PlasticityState) -> float:
    """Difference quotient that Uintah's iteration takes: at a rate equal to the plastic strain.

    It is no derivative of the flow stress, but where ``radialReturn`` ends depends on it. With a Peierls
    stress near that of tungsten (1 GPa and more) it ends too early, up to a third off the flow stress;
    ``biswajit`` needs no slope.
    """
    rate = state.plastic_strain
    step = thermal_stress(model, 1.01 * rate, state.temperature)
    step -= thermal_stress(model, rate, state.temperature)
    return step / 0.01 * (state.shear_modulus / model.mu_0)
