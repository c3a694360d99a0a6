"""The semi-implicit stress update of Nemat-Nasser, Maudlin and Zocher."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.declare import model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, where
from solver.materials.flow_stress import flow_stress
from solver.materials.plasticity_state import PlasticityState, at_plastic_strain
from solver.materials.return_algorithm import PlasticReturn, PlasticTrial, return_to_yield
from solver.materials.return_algorithm.radial_return import radial_return
from solver.tensor import deviator, double_dot, norm


@model("return_algorithm", "biswajit")
class SemiImplicit(NamedTuple):
    """Nemat-Nasser (1991), Mech. Mater. 11, 235; Zocher et al. (2000), ECCOMAS; Banerjee (2012), Eqs. 4-23.

    All deviatoric strain is first taken as plastic and then corrected by the rise of the flow stress. Where
    that fails, because little of the strain is plastic or the step is short, Newton's iteration of
    ``radialReturn`` takes over.

    Eq. 18 lets the stress turn towards the strain rate within a step however short it is. Where the path
    bends, plastic strain and heat are therefore too large by some percent, for any size of the step.
    """


@inline
def plastic_multiplier(state: PlasticityState, trial: PlasticTrial, stress_norm: float, dt: float) -> float:
    """The increment of gamma, with d_p = gamma u and u = sqrt(3) s / |s| (Eqs. 8, 13, 15, 19); 0 if none."""
    direction = deviator(trial.old_stress) / stress_norm
    along_stress = double_dot(direction, trial.rate_deviator)
    gamma_rate = along_stress / math.sqrt(3.0)
    rate_norm = norm(trial.rate_deviator)
    a = 2.0 / math.sqrt(3.0)
    b = -(rate_norm + along_stress)
    c = 3.0 * gamma_rate * (along_stress - rate_norm)
    mean_rate = (-b + math.sqrt(max(b * b - 4.0 * a * c, 0.0))) / (2.0 * a)
    hardening = math.sqrt(2.0) * trial.strength - math.sqrt(3.0) * stress_norm
    return where(along_stress <= 0.0, 0.0, mean_rate * dt / 3.0 - hardening / (6.0 * trial.stiffness))


@inline
def corrected_return(
    flow_model: Any, state: PlasticityState, trial: PlasticTrial, multiplier: float, dt: float
) -> PlasticReturn:
    """The end of a step with that increment of gamma."""
    # |d_p| = sqrt(3) gamma, and the equivalent plastic strain rate is sqrt(2/3) of that
    rate = math.sqrt(2.0) * multiplier / dt
    end = at_plastic_strain(state, state.plastic_strain + rate * dt, rate)
    sigma_y = flow_stress(flow_model, end)
    # Eqs. 22 and 23: the relaxed trial deviator, scaled to the yield surface
    direction = trial.stress_deviator / norm(trial.stress_deviator)
    return PlasticReturn(
        stress_deviator=direction * (math.sqrt(2.0 / 3.0) * sigma_y),
        plastic_strain=end.plastic_strain,
        plastic_strain_rate=rate,
        flow_stress=sigma_y,
        multiplier=multiplier,
        plastic_increment=direction * (math.sqrt(3.0) * multiplier),
    )


@inline
def only(trial: PlasticTrial, leaves: bool) -> PlasticTrial:
    """The same steps, with others of eight particles looked at."""
    return PlasticTrial(
        leaves,
        trial.old_stress,
        trial.stress_deviator,
        trial.rate_deviator,
        trial.old_strain_rate,
        trial.flow_stress,
        trial.strength,
        trial.porosity,
        trial.stiffness,
    )


@implements(return_to_yield, SemiImplicit)
@lanewise
def _(
    algorithm: SemiImplicit, flow_model: Any, state: PlasticityState, trial: PlasticTrial, dt: float
) -> PlasticReturn:
    stress_norm = norm(deviator(trial.old_stress))
    unstressed = stress_norm <= 0.0
    found = plastic_multiplier(state, trial, where(unstressed, 1.0, stress_norm), dt)
    fails = unstressed | (found <= 0.0) | (math.sqrt(2.0) * found / dt > trial.old_strain_rate)
    corrected = corrected_return(flow_model, state, trial, where(fails, 0.0, found), dt)
    seeks = trial.leaves & fails
    if not anywhere(seeks):
        return corrected
    newton = radial_return(flow_model, state, only(trial, seeks), dt)
    return PlasticReturn(
        stress_deviator=where(fails, newton.stress_deviator, corrected.stress_deviator),
        plastic_strain=where(fails, newton.plastic_strain, corrected.plastic_strain),
        plastic_strain_rate=where(fails, newton.plastic_strain_rate, corrected.plastic_strain_rate),
        flow_stress=where(fails, newton.flow_stress, corrected.flow_stress),
        multiplier=where(fails, newton.multiplier, corrected.multiplier),
        plastic_increment=where(fails, newton.plastic_increment, corrected.plastic_increment),
    )
