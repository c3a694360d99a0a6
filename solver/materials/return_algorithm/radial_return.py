"""Radial return by Newton's iteration."""

from __future__ import annotations

import math
from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, negation, where
from solver.materials.flow_stress import flow_stress, response
from solver.materials.plasticity_state import PlasticityState, at_plastic_strain
from solver.materials.return_algorithm import PlasticReturn, PlasticTrial, return_to_yield
from solver.tensor import norm

MOST_ITERATIONS = 101
LONGEST_TOLERANCE = 1.0e-6
"""The plastic multiplier is found to this or to the size of the time step, whichever is smaller."""
STRESS_TOLERANCE = 1.0e-3
"""The stress is on the yield surface when its distance is below this part of the flow stress."""


@model("return_algorithm", "radialReturn")
class RadialReturn(NamedTuple):
    """Simo and Hughes (1998), box 3.2, with rate-dependent flow stress.

    Solves |s_trial| - sqrt(2/3) sigma_y(ep + sqrt(2/3) dg, sqrt(2/3) dg / dt) - 2 mu dg = 0 for the plastic
    multiplier dg, starting from the whole strain rate. Start and tolerances are Uintah's, whose answer
    depends on them. A flow stress whose slope is infinite at zero plastic strain (ep^n with n < 1) makes the
    iteration wander where the first plastic strain is below 1e-5: the rounding of the trial stress decides
    where it stops, with the stress off by up to a part in a thousand and ep by up to 1e-5.
    """


@inline
def radial_return(
    flow_model: object, state: PlasticityState, trial: PlasticTrial, dt: float
) -> PlasticReturn:
    """Return along the trial deviator; numba specialises it for the flow model."""
    two_thirds = 2.0 / 3.0
    trial_norm = norm(trial.stress_deviator)
    tolerance = min(dt, LONGEST_TOLERANCE)
    multiplier = state.strain_rate * dt / math.sqrt(two_thirds)
    current = at_plastic_strain(state, state.plastic_strain, state.strain_rate)
    seeks = trial.leaves
    for _ in range(MOST_ITERATIONS):
        at = response(flow_model, current)
        excess = trial_norm - math.sqrt(two_thirds) * at.flow_stress - 2.0 * trial.stiffness * multiplier
        hardening = at.rate_slope / dt + at.hardening_slope
        change = where(seeks, excess / (two_thirds * hardening + 2.0 * trial.stiffness), 0.0)
        multiplier += change
        strain = max(math.sqrt(two_thirds) * multiplier, 0.0)
        current = at_plastic_strain(state, state.plastic_strain + strain, strain / dt)
        found = (abs(change) < tolerance) | (abs(excess) <= STRESS_TOLERANCE * at.flow_stress)
        seeks = seeks & negation(found)
        if not anywhere(seeks):
            break
    direction = trial.stress_deviator / trial_norm
    return PlasticReturn(
        stress_deviator=trial.stress_deviator - direction * (2.0 * trial.stiffness * multiplier),
        plastic_strain=current.plastic_strain,
        plastic_strain_rate=current.plastic_strain_rate,
        flow_stress=flow_stress(flow_model, current),
        multiplier=multiplier,
        plastic_increment=direction * multiplier,
    )


@implements(return_to_yield, RadialReturn)
@lanewise
def _(
    algorithm: RadialReturn, flow_model: object, state: PlasticityState, trial: PlasticTrial, dt: float
) -> PlasticReturn:
    return radial_return(flow_model, state, trial, dt)
