"""The loops of diffusion over particles; sums over nodes as in ``solver.kernels``."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.diffusion import diffusivity, drift
from solver.diffusion.solute import Solute
from solver.grid import GridIndex
from solver.interpolation.shape import MOST_NODES, particle_domain, shape_functions
from solver.jit import kernel
from solver.particles import Particles
from solver.scratch import scratch_numbers, scratch_rows
from solver.tensor import tensor_at, trace

SUMS = 3
"""Width of the array that particles scatter to: mass times concentration, mass times mean stress, and mass
times the rate by fluxes through the surface."""


@kernel
def concentration_to_grid(
    interpolator: Any,
    grid: GridIndex,
    particles: Particles,
    solute: Solute,
    with_gradients: bool,
    sums: Any,
) -> None:
    """Add m c S, m sigma_m S and m r S of the particles to ``sums`` (N, SUMS).

    ``with_gradients`` : nodes get c - grad c . (x_p - x_i), the gradient-enhanced projection.
    """
    nodes = scratch_numbers(MOST_NODES, np.int64)
    weights = scratch_numbers(MOST_NODES, np.float64)
    gradients = scratch_rows(MOST_NODES, 3)
    layer = grid.nodes[0] * grid.nodes[1]
    for p in range(particles.mass.shape[0]):
        x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
        F, size = tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
        domain = particle_domain(interpolator, F, size)
        count = shape_functions(interpolator, grid, x, y, z, domain, nodes, weights, gradients)
        mean_stress = trace(tensor_at(particles.stress, p)) / 3.0
        slope = solute.gradient[p]
        for n in range(count):
            c, share = solute.concentration[p], particles.mass[p] * weights[n]
            if with_gradients:
                i, j, k = nodes[n] % grid.nodes[0], nodes[n] % layer // grid.nodes[0], nodes[n] // layer
                c -= slope[0] * (x - grid.anchor[0] - (i + grid.first[0]) * grid.spacing[0])
                c -= slope[1] * (y - grid.anchor[1] - (j + grid.first[1]) * grid.spacing[1])
                c -= slope[2] * (z - grid.anchor[2] - (k + grid.first[2]) * grid.spacing[2])
            sums[nodes[n], 0] += share * c
            sums[nodes[n], 1] += share * mean_stress
            sums[nodes[n], 2] += share * solute.external_rate[p]


@kernel
def fluxes_to_grid(
    law: Any,
    hold: bool,
    flat: bool,
    interpolator: Any,
    grid: GridIndex,
    particles: Particles,
    solute: Solute,
    mean_stress: Any,
    sums: Any,
) -> float:
    """Find J = D (grad c - f grad sigma_m) of the particles and add -m J . G to ``sums`` (N, 1).

    ``hold`` : particles keep the D that they have. ``flat`` : the third direction has no gradient (axisymmetry).
    ``mean_stress`` (N,) is that of the nodes. Returns the largest D.
    """
    nodes = scratch_numbers(MOST_NODES, np.int64)
    weights = scratch_numbers(MOST_NODES, np.float64)
    gradients = scratch_rows(MOST_NODES, 3)
    largest = 0.0
    for p in range(particles.mass.shape[0]):
        x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
        F, size = tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
        domain = particle_domain(interpolator, F, size)
        count = shape_functions(interpolator, grid, x, y, z, domain, nodes, weights, gradients)
        c = solute.concentration[p]
        D = solute.diffusivity[p]
        if not hold:
            D = diffusivity(law, c, -trace(tensor_at(particles.stress, p)) / 3.0)
        factor = drift(law, c)
        for axis in range(3):
            slope = 0.0
            if factor != 0.0 and not (flat and axis == 2):
                for n in range(count):
                    slope += mean_stress[nodes[n]] * gradients[n, axis]
            solute.flux[p, axis] = D * (solute.gradient[p, axis] - factor * slope)
        jx, jy, jz = solute.flux[p, 0], solute.flux[p, 1], solute.flux[p, 2]
        for n in range(count):
            along = gradients[n, 0] * jx + gradients[n, 1] * jy + gradients[n, 2] * jz
            sums[nodes[n], 0] -= particles.mass[p] * along
        solute.diffusivity[p] = D
        largest = max(largest, D)
    return largest


@kernel
def concentration_to_particles(
    interpolator: Any,
    grid: GridIndex,
    particles: Particles,
    solute: Solute,
    flat: bool,
    rate: Any,
    star: Any,
    bounds: tuple[float, float],
    dt: float,
) -> None:
    """Gather c += dt sum rate S within bounds, and grad c = sum star G, from nodal values (N,).

    ``flat`` : the third direction has no gradient (axisymmetry).
    """
    nodes = scratch_numbers(MOST_NODES, np.int64)
    weights = scratch_numbers(MOST_NODES, np.float64)
    gradients = scratch_rows(MOST_NODES, 3)
    for p in range(particles.mass.shape[0]):
        x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
        F, size = tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
        domain = particle_domain(interpolator, F, size)
        count = shape_functions(interpolator, grid, x, y, z, domain, nodes, weights, gradients)
        growth = gx = gy = gz = 0.0
        for n in range(count):
            growth += rate[nodes[n]] * weights[n]
            gx += star[nodes[n]] * gradients[n, 0]
            gy += star[nodes[n]] * gradients[n, 1]
            gz += star[nodes[n]] * gradients[n, 2]
        c = solute.concentration[p]
        solute.previous[p] = c
        solute.concentration[p] = min(max(c + growth * dt, bounds[0]), bounds[1])
        solute.gradient[p, 0], solute.gradient[p, 1] = gx, gy
        solute.gradient[p, 2] = 0.0 if flat else gz
