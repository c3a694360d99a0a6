"""The plastic multipliers of a body whose strength falls with their average over a neighbourhood."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.declare import IntVector
from solver.dispatch import inline
from solver.grid import GridIndex
from solver.interpolation.shape import MOST_NODES, particle_domain, shape_functions
from solver.jit import kernel
from solver.materials.constitutive import Neighbourhood
from solver.materials.nonlocal_drucker_prager import (
    Flow,
    NonlocalDruckerPrager,
    commit,
    flow_in,
    initial_stress,
    loading,
    mean_around,
    resistance,
)
from solver.particles import Array, Particles
from solver.scratch import scratch_numbers, scratch_rows
from solver.tensor import double_dot, isotropic, put_tensor, rotation, symmetric, tensor_at, to_laboratory

TOLERANCE = 1.0e-14
"""Largest change of a multiplier in the last sweep, over the largest multiplier."""

MOST_SWEEPS = 10000


def find_multipliers(
    model: NonlocalDruckerPrager, state: Any, particles: Particles, neighbourhood: Neighbourhood
) -> None:
    """Sweep over the particles until no multiplier changes, each seeing those of the sweep before.

    So the order of the particles, and who holds them, does not matter. A particle that is elastic by itself, and
    that the flow around it weakens below its stress, joins in from the next sweep on. Softening makes a sweep a
    contraction; where average flow hardens, multipliers take part of the change, so that they do not swing.
    """
    grid, position, repeats = neighbourhood.grid, neighbourhood.position, neighbourhood.repeats
    share = 1.0 / (1.0 + 0.5 * max(model.h_nonlocal, 0.0) / (resistance(model) + model.h_local))
    count, nodes = len(particles.mass), grid.nodes[0] * grid.nodes[1] * grid.nodes[2]
    multiplier, average, excess = np.zeros(count), np.zeros(count), np.empty(count)
    flowing = np.zeros(count, np.bool_)
    weights, flows = np.zeros(nodes), np.zeros(nodes)
    start(model, state, particles, excess, flowing, multiplier)
    project(neighbourhood.interpolator, grid, particles, position, np.ones(count), weights)
    neighbourhood.complete(weights)
    for _ in range(MOST_SWEEPS):
        flows[:] = 0.0
        project(neighbourhood.interpolator, grid, particles, position, multiplier, flows)
        neighbourhood.complete(flows)
        take_average(model, grid, repeats, position, weights, flows, multiplier, average)
        here = np.array(sweep(model, state, particles, average, excess, share, flowing, multiplier))
        change, largest, joined = neighbourhood.largest(here).tolist()
        if change <= TOLERANCE * largest and not joined:
            break
    finish(model, state, particles, average, excess, flowing)


@kernel
def start(
    model: NonlocalDruckerPrager,
    state: Any,
    particles: Particles,
    excess: Array,
    flowing: Array,
    multiplier: Array,
) -> None:
    """By how much each trial stress exceeds the strength before the step, and the flow that this alone makes."""
    for p in range(excess.shape[0]):
        strength = state.cohesion[p] + state.local_before[p] + state.nonlocal_before[p]
        excess[p] = loading(model, tensor_at(state.trial_stress, p)) - strength
        flowing[p] = particles.localized[p] == 0 and excess[p] > 0.0
        if flowing[p]:
            multiplier[p] = excess[p] / (resistance(model) + model.h_local)


@kernel
def project(
    interpolator: Any, grid: GridIndex, particles: Particles, position: Array, values: Array, sums: Array
) -> None:
    """Add values S of the particles to sums (N,) at the nodes, by their sizes of the start."""
    nodes = scratch_numbers(MOST_NODES, np.int64)
    weights = scratch_numbers(MOST_NODES, np.float64)
    gradients = scratch_rows(MOST_NODES, 3)
    for p in range(values.shape[0]):
        if values[p] == 0.0:
            continue
        domain = particle_domain(interpolator, isotropic(1.0), tensor_at(particles.size, p))
        x, y, z = position[p, 0], position[p, 1], position[p, 2]
        touched = shape_functions(interpolator, grid, x, y, z, domain, nodes, weights, gradients)
        for n in range(touched):
            sums[nodes[n]] += values[p] * weights[n]


@kernel
def take_average(
    model: NonlocalDruckerPrager,
    grid: GridIndex,
    repeats: IntVector,
    position: Array,
    weights: Array,
    flows: Array,
    multiplier: Array,
    average: Array,
) -> None:
    """<lambda'> of all particles from the sums at the nodes."""
    for p in range(average.shape[0]):
        at = (position[p, 0], position[p, 1], position[p, 2])
        average[p] = mean_around(model, grid, repeats, at, weights, flows, multiplier[p])


@kernel
def sweep(
    model: NonlocalDruckerPrager,
    state: Any,
    particles: Particles,
    average: Array,
    excess: Array,
    share: float,
    flowing: Array,
    multiplier: Array,
) -> tuple[float, float, float]:
    """Let multipliers follow the averages by a share of the way, and return the largest change and multiplier.

    The third number is 1 where a particle joined in, else 0.
    """
    change = largest = joined = 0.0
    for p in range(excess.shape[0]):
        if particles.localized[p] != 0:
            continue
        if flowing[p]:
            step = share * (flow_of(model, state, p, average[p], excess[p]).multiplier - multiplier[p])
            multiplier[p] += step
            change, largest = max(change, abs(step)), max(largest, multiplier[p])
        elif excess[p] > model.h_nonlocal * average[p]:
            flowing[p] = True
            joined = 1.0
    return change, largest, joined


@kernel
def finish(
    model: NonlocalDruckerPrager,
    state: Any,
    particles: Particles,
    average: Array,
    excess: Array,
    flowing: Array,
) -> None:
    """Store the flows of all particles that did not fail, and the stresses after them."""
    for p in range(excess.shape[0]):
        if particles.localized[p] != 0:
            continue
        flow = Flow(0.0, state.local_before[p], state.nonlocal_before[p] + model.h_nonlocal * average[p])
        if flowing[p]:
            flow = flow_of(model, state, p, average[p], excess[p])
        turn = rotation(tensor_at(particles.deformation_gradient, p))
        stress = to_laboratory(turn, commit(model, state, p, flow))
        put_tensor(particles.stress, p, stress - initial_stress(model))


@inline
def flow_of(model: NonlocalDruckerPrager, state: Any, p: int, average: float, excess: float) -> Flow:
    """The flow of a particle, given <lambda'>."""
    load = excess - model.h_nonlocal * average
    return flow_in(model, state, p, load, average, resistance(model) + model.h_local)


@kernel
def half_power(particles: Particles) -> float:
    """Half the power of the stresses of all particles, sum 1/2 sigma : d V."""
    total = 0.0
    for p in range(particles.mass.shape[0]):
        d = symmetric(tensor_at(particles.velocity_gradient, p))
        total += 0.5 * double_dot(tensor_at(particles.stress, p), d) * particles.volume[p]
    return total
