"""A strain increment of an Arenisca model: sub-steps, each elastic or plastic with a moving yield surface."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.dispatch import generic, inline
from solver.materials.arenisca.elasticity import Moduli, Pores, moduli, stiffest
from solver.materials.arenisca.hardening import back_stress_slope, cap_position
from solver.materials.arenisca.invariants import invariants
from solver.materials.arenisca.return_mapping import Returned, is_yielding, return_to_surface
from solver.materials.arenisca.yield_surface import ShearLimit, shear_limit, surface
from solver.tensor import Tensor, deviator, isotropic, norm, trace

CONSISTENT = 1.0e-4
"""Part of the first estimate of plastic strain to which the consistent one is bisected."""

MOST_BISECTIONS = 93
"""After so many the material is taken to have no pores left to close."""


class RockState(NamedTuple):
    """Stress and hardening of a particle between sub-steps, in the material's frame."""

    stress: Tensor
    plastic_strain: Tensor
    cap: float
    zeta: float
    failed: bool


class Increment(NamedTuple):
    """An elastic trial."""

    strain: Tensor
    stiffness: Moduli
    trial: Tensor


@generic
def step_fineness(model: Any) -> float:  # type: ignore[empty-body]  # bodies come from the models
    """The stress increment over the yield surface's size, times this, is the least number of sub-steps."""


@generic
def counts_from_current_moduli(model: Any) -> bool:  # type: ignore[empty-body]  # bodies come from the models
    """Whether sub-steps are counted with the present moduli where material disaggregates."""


@inline
def elastic_stress(stress: Tensor, strain: Tensor, stiffness: Moduli) -> Tensor:
    """The stress after a strain increment of constant moduli."""
    volume = trace(strain) / 3.0
    increment = isotropic(3.0 * stiffness.bulk * volume) + 2.0 * stiffness.shear * deviator(strain)
    return stress + increment


@inline
def plastic_increment(old: Tensor, new: Tensor, increment: Increment) -> Tensor:
    """The part of a strain increment that the change of stress does not explain."""
    K, G = increment.stiffness.bulk, increment.stiffness.shear
    change = new - old
    return increment.strain - (
        (0.5 / G) * change + isotropic((1.0 / (9.0 * K) - 1.0 / (6.0 * G)) * trace(change))
    )


@inline
def number_of_sub_steps(
    model: Any, pores: Pores, old: RockState, crush_limit: float, strain: Tensor
) -> float:
    """How many sub-steps a strain increment needs.

    As in Uintah the change of stiffness is that of a stress which starts from zero, without plastic strain.
    """
    counting = stiffest(model)
    if counts_from_current_moduli(model) and model.Use_Disaggregation_Algorithm:
        counting = moduli(model, pores, trace(old.stress), trace(old.plastic_strain), crush_limit)
    change = elastic_stress(isotropic(0.0), strain, counting)
    before = moduli(model, pores, 0.0, 0.0, crush_limit).bulk
    after = moduli(model, pores, trace(change), 0.0, crush_limit).bulk
    size = 0.5 * (model.PEAKI1 - old.cap)
    if model.STREN > 0.0:
        size = min(size, model.STREN)
    by_stiffness = math.ceil(abs(before - after) / before)
    by_size = math.ceil(step_fineness(model) * norm(change) / size)
    return max(float(by_stiffness), float(by_size), 1.0)


@inline
def side(value: float) -> bool:
    """Whether a number is negative; zero is not."""
    return value < 0.0


@inline
def harden(
    model: Any, pores: Pores, limit: ShearLimit, crush_limit: float, old: RockState, increment: Increment
) -> RockState:
    """The plastic sub-step: bisection for the volume strain that the yield surface it moves to gives back.

    The part eta of the first estimate of plastic volume strain is too large where the surface that belongs
    to it encloses the trial stress or returns it from the other side, or where the return makes less
    plastic strain than that.
    """
    trial = invariants(increment.trial)
    first = return_to_surface(
        model, surface(model, limit, old.cap, old.zeta), increment.stiffness, increment.trial, trial
    )
    first_strain = plastic_increment(old.stress, first.stress, increment)
    if first.failed:
        return failed_step(old)
    if model.p3_crush_curve == 0.0 and model.fluid_B0 == 0.0:
        return RockState(first.stress, old.plastic_strain + first_strain, old.cap, old.zeta, False)
    old_volume, first_volume = trace(old.plastic_strain), trace(first_strain)
    slope = back_stress_slope(model, pores, old.zeta, old_volume)
    side_of_first = side(trial.i1 - first.i1)
    outer, inner = 1.0, 0.0
    for k in range(1, MOST_BISECTIONS + 2):
        eta = 0.5 * (outer + inner)
        volume = eta * first_volume
        cap = cap_position(model, pores, old_volume + volume, crush_limit)
        moved = surface(model, limit, cap, min(old.zeta + slope * volume, 0.0))
        too_much = not is_yielding(model, moved, trial)
        if not too_much:
            returned = return_to_surface(model, moved, increment.stiffness, increment.trial, trial)
            if returned.failed:
                break
            too_much = side(trial.i1 - returned.i1) != side_of_first
        if too_much:
            outer = inner if k >= MOST_BISECTIONS else eta
            continue
        strain = plastic_increment(old.stress, returned.stress, increment)
        if abs(outer - inner) < CONSISTENT:
            return settle(model, pores, crush_limit, old, slope, returned, strain)
        if abs(trace(strain)) > eta * abs(first_volume):
            inner = eta
        else:
            outer = eta
    return failed_step(old)


@inline
def failed_step(old: RockState) -> RockState:
    """The state as it was, marked as failed."""
    return RockState(old.stress, old.plastic_strain, old.cap, old.zeta, True)


@inline
def settle(
    model: Any,
    pores: Pores,
    crush_limit: float,
    old: RockState,
    slope: float,
    returned: Returned,
    strain: Tensor,
) -> RockState:
    """The state after a plastic sub-step; no more than all pores close."""
    volume = trace(strain)
    plastic_strain = old.plastic_strain + strain
    if trace(plastic_strain) < -crush_limit:
        volume = -crush_limit - trace(old.plastic_strain)
        plastic_strain = old.plastic_strain + deviator(strain) + isotropic(volume / 3.0)
    cap = cap_position(model, pores, trace(plastic_strain), crush_limit)
    return RockState(returned.stress, plastic_strain, cap, min(old.zeta + slope * volume, 0.0), False)


@inline
def sub_step(
    model: Any, pores: Pores, limit: ShearLimit, crush_limit: float, old: RockState, strain: Tensor
) -> RockState:
    """One sub-step with the moduli of its start."""
    stiffness = moduli(model, pores, trace(old.stress), trace(old.plastic_strain), crush_limit)
    trial = elastic_stress(old.stress, strain, stiffness)
    if not is_yielding(model, surface(model, limit, old.cap, old.zeta), invariants(trial)):
        return RockState(trial, old.plastic_strain, old.cap, old.zeta, False)
    return harden(model, pores, limit, crush_limit, old, Increment(strain, stiffness, trial))


@inline
def strain_step(
    model: Any, pores: Pores, coherence: float, crush_limit: float, old: RockState, strain: Tensor
) -> RockState:
    """The state after a strain increment, in equal sub-steps; the old one, marked, where they fail."""
    count = number_of_sub_steps(model, pores, old, crush_limit, strain)
    if not count <= model.subcycling_characteristic_number:
        return failed_step(old)
    limit = shear_limit(model, coherence)
    state, part = old, strain / count
    for _ in range(int(count)):
        state = sub_step(model, pores, limit, crush_limit, state, part)
        if state.failed:
            return failed_step(old)
    return state
