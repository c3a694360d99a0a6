"""The Mie-Grueneisen equation of state of shocked solids."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import where
from solver.materials.equation_of_state import isentropic_heating, mean_stress, mean_stress_slope
from solver.materials.plasticity_state import PlasticityState


@model("equation_of_state", "mie_gruneisen", "mie_gruneisen_energy")
class MieGruneisen(NamedTuple):
    """Mie-Grueneisen pressure about the Hugoniot, in the form of Steinberg (1991), UCRL-MA-106439.

    With the compression eta = 1 - J and the specific internal energy e, the pressure is
    p = rho_0 C_0^2 eta (1 - Gamma_0 eta / 2) / (1 - S_1 eta - S_2 eta^2 - S_3 eta^3)^2 + rho_0 Gamma_0 e
    in compression and rho_0 C_0^2 eta + rho_0 Gamma_0 e in tension.
    """

    C_0: Annotated[float, Parameter("bulk speed of sound", unit="m/s", gt=0.0)]
    Gamma_0: Annotated[float, Parameter("Grueneisen's gamma in the reference state", ge=0.0)]
    S_alpha: Annotated[float, Parameter("linear slope S_1 of the Hugoniot, dU_s/dU_p", ge=0.0)]
    S_2: Annotated[float, Parameter("quadratic coefficient of the Hugoniot")] = 0.0
    S_3: Annotated[float, Parameter("cubic coefficient of the Hugoniot")] = 0.0


@inline
def hugoniot_denominator(model: MieGruneisen, eta: float) -> float:
    """1 - S_1 eta - S_2 eta^2 - S_3 eta^3, which vanishes at the greatest compression."""
    return 1.0 - model.S_alpha * eta - model.S_2 * eta * eta - model.S_3 * eta * eta * eta


@implements(mean_stress, MieGruneisen)
@lanewise
def _(model: MieGruneisen, state: PlasticityState, volumetric_strain: float) -> float:
    eta = 1.0 - state.initial_density / state.density
    thermal = state.initial_density * model.Gamma_0 * state.energy
    cold = state.initial_density * model.C_0 * model.C_0 * eta
    denominator = hugoniot_denominator(model, eta)
    shocked = cold * ((1.0 - 0.5 * model.Gamma_0 * eta) / (denominator * denominator))
    return -(thermal + where(eta >= 0.0, shocked, cold))


@implements(mean_stress_slope, MieGruneisen)
@lanewise
def _(model: MieGruneisen, state: PlasticityState) -> float:
    eta = 1.0 - state.initial_density / state.density
    stiffness = state.initial_density * model.C_0 * model.C_0
    denominator = hugoniot_denominator(model, eta)
    steepening = model.S_alpha + 2.0 * model.S_2 * eta + 3.0 * model.S_3 * eta * eta
    linear = 1.0 - model.Gamma_0 * eta
    curved = 2.0 * eta * (1.0 - 0.5 * model.Gamma_0 * eta) * steepening / denominator
    return where(eta < 0.0, stiffness, stiffness * (linear + curved) / (denominator * denominator))


@implements(isentropic_heating, MieGruneisen)
@lanewise
def _(model: MieGruneisen, state: PlasticityState, dilatation_rate: float) -> float:
    """T' = -Gamma T tr(d) with Gamma = Gamma_0 rho_0 / rho."""
    return -state.temperature * model.Gamma_0 * state.initial_density / state.density * dilatation_rate
