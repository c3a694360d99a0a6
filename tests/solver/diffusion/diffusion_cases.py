"""Slabs through which a substance diffuses, at rest."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpm_cases import fill, make_body, make_grid, make_particles, make_simulation

from solver.creation import Creation
from solver.diffusion.diffusion import Diffusion, new_solute
from solver.interpolation.linear import Linear

D = 2.0e-3
LENGTH = 1.0


def creation(particles: Any, concentration: Any = 0.0) -> Creation:
    """Particles as a deck makes them."""
    count = len(particles)
    return Creation(
        particles,
        np.zeros(count, np.int32),
        np.zeros((1, 3)),
        np.zeros(count, np.int32),
        np.ones(count, bool),
        np.zeros((count, 3)),
        np.broadcast_to(np.asarray(concentration, float), count).copy(),
    )


def slab(
    law: Any,
    cells: int,
    start: Any = 0.0,
    interpolator: Any = None,
    regions: Any = (),
    interfaces: Any = (),
    parts: Any = ((0.0, LENGTH),),
    fluxes: Any = (),
    **options: Any,
) -> Any:
    """Bodies in a row along x, from one end of the domain to the other; ``start`` is c or a function of x."""
    interpolator = Linear() if interpolator is None else interpolator
    extra = (0, 0, 0) if isinstance(interpolator, Linear) else (1, 1, 1)
    h = LENGTH / cells
    grid = make_grid((cells, 1, 1), (h, h, h), extra=extra)
    bodies, laws = [], []
    for index, (low, high) in enumerate(parts):
        where = fill((low, 0.0, 0.0), (high, h, h), (h, h, h), (2, 2, 2))
        particles = make_particles(grid, where)
        for load in fluxes:
            particles.load_curve[load.near(where, (h / 2, h / 2, h / 2)), 0] = load.load_curve.id
        at_start = start(where[:, 0]) if callable(start) else start
        body = make_body(particles, index)
        body.solute = new_solute(creation(particles, at_start), law, grid)
        bodies.append(body)
        laws.append(law)
    simulation = make_simulation(grid, bodies, interpolator, regions, **options)
    simulation.diffusion = Diffusion(laws, interfaces, fluxes, [True] * len(laws))
    simulation.diffusion.attach(simulation)
    return simulation


def run(simulation: Any, until: float, share: float = 0.4) -> None:
    """Steps of a share of the stable one, the last of which ends at the time."""
    steps = int(np.ceil(until / (share * simulation.diffusion.limit(0.0))))
    for _ in range(steps):
        simulation.advance(until / steps)


def profile(simulation: Any) -> tuple[Any, Any]:
    """Places along x, and the concentrations there."""
    x = np.concatenate([body.particles.position[:, 0] for body in simulation.bodies])
    c = np.concatenate([body.solute.concentration for body in simulation.bodies])
    return x, c


def nodal_profile(simulation: Any) -> tuple[Any, Any]:
    """The nodes along an edge in x, and the concentrations there.

    Particles take rates from the nodes, so that beside a node whose value is given they keep a noise of their own.
    """
    where = simulation.grid.node_positions()
    row = (np.abs(where[:, 1:]) < 1e-12).all(axis=1) & (where[:, 0] > -1e-12) & (where[:, 0] < LENGTH + 1e-12)
    return where[row, 0], simulation.diffusion.nodal.star[0][row]


def rate_of_convergence(errors: Any, sizes: Any) -> float:
    """The slope of log error over log h."""
    return float(np.polyfit(np.log(1.0 / np.asarray(sizes, float)), np.log(errors), 1)[0])
