"""The plastic multipliers of a body whose strength falls with their average over a neighbourhood."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.dispatch import inline
from solver.grid import GridIndex
from solver.interpolation.shape import MOST_NODES, particle_domain, shape_functions
from solver.jit import kernel, kernel_with_scratch
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
from solver.particles import Particles
from solver.tensor import double_dot, isotropic, put_tensor, rotation, symmetric, tensor_at, to_laboratory

TOLERANCE = 1.0e-14
"""Largest change of a multiplier in the last sweep."""

MOST_SWEEPS = 10000


@kernel_with_scratch
def find_multipliers(
    model: NonlocalDruckerPrager,
    state: Any,
    particles: Particles,
    interpolator: Any,
    grid: GridIndex,
    position: Any,
) -> None:
    """Sweep over the particles until no multiplier changes, each seeing the newest ones of the others.

    A particle that is elastic by itself, and that the flow around it weakens below its stress, joins in from
    the next sweep on.
    """
    count = particles.mass.shape[0]
    multiplier, excess = np.zeros(count), np.empty(count)
    joined = np.zeros(count, np.bool_)
    sums = np.zeros((grid.nodes[0] * grid.nodes[1] * grid.nodes[2], 2))
    alone = resistance(model) + model.h_local
    for p in range(count):
        strength = state.cohesion[p] + state.local_before[p] + state.nonlocal_before[p]
        excess[p] = loading(model, tensor_at(state.trial_stress, p)) - strength
        if particles.localized[p] == 0 and excess[p] > 0.0:
            multiplier[p] = excess[p] / alone
        scatter(interpolator, grid, particles, position, p, 1.0, multiplier[p], sums)
    for _ in range(MOST_SWEEPS):
        change, more = 0.0, False
        for p in range(count):
            if particles.localized[p] != 0:
                continue
            x, y, z = position[p, 0], position[p, 1], position[p, 2]
            average = mean_around(model, grid, x, y, z, sums, multiplier[p])
            if not (excess[p] > 0.0 or joined[p]):
                wide = state.nonlocal_before[p] + model.h_nonlocal * average
                put_flow(model, state, particles, p, Flow(0.0, state.local_before[p], wide))
                strength = state.cohesion[p] + state.local_before[p] + wide
                if loading(model, tensor_at(state.trial_stress, p)) > strength:
                    joined[p] = more = True
                continue
            load = excess[p] - model.h_nonlocal * average
            flow = flow_in(model, state, p, load, average, alone)
            put_flow(model, state, particles, p, flow)
            scatter(interpolator, grid, particles, position, p, 0.0, flow.multiplier - multiplier[p], sums)
            change = max(change, abs(flow.multiplier - multiplier[p]))
            multiplier[p] = flow.multiplier
        if change < TOLERANCE and not more:
            break


@kernel
def half_power(particles: Particles) -> float:
    """Half the power of the stresses of all particles, sum 1/2 sigma : d V."""
    total = 0.0
    for p in range(particles.mass.shape[0]):
        d = symmetric(tensor_at(particles.velocity_gradient, p))
        total += 0.5 * double_dot(tensor_at(particles.stress, p), d) * particles.volume[p]
    return total


@inline
def put_flow(model: NonlocalDruckerPrager, state: Any, particles: Particles, p: int, flow: Flow) -> None:
    """Store the flow of a particle and the stress after it."""
    turn = rotation(tensor_at(particles.deformation_gradient, p))
    stress = to_laboratory(turn, commit(model, state, p, flow))
    put_tensor(particles.stress, p, stress - initial_stress(model))


@inline
def scatter(
    interpolator: Any,
    grid: GridIndex,
    particles: Particles,
    position: Any,
    p: int,
    weight: float,
    multiplier: float,
    sums: Any,
) -> None:
    """Add weight S and multiplier S of a particle to the nodes (N, 2), by its size of the start."""
    nodes = np.empty(MOST_NODES, np.int64)
    weights = np.empty(MOST_NODES)
    gradients = np.empty((MOST_NODES, 3))
    domain = particle_domain(interpolator, isotropic(1.0), tensor_at(particles.size, p))
    x, y, z = position[p, 0], position[p, 1], position[p, 2]
    touched = shape_functions(interpolator, grid, x, y, z, domain, nodes, weights, gradients)
    for n in range(touched):
        sums[nodes[n], 0] += weight * weights[n]
        sums[nodes[n], 1] += multiplier * weights[n]
