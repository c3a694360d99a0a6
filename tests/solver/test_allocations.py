"""A step makes no new arrays as long as the particles or the nodes: those it needs live as long as the simulation."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from mpm_cases import elastic, fill, make_body, make_grid, make_particles, make_simulation, whole_side

from solver.contact.single_velocity import SingleVelocity
from solver.workspace import Workspace

DT = 1e-3
GRID = make_grid((26, 26, 34))
FACES = [
    whole_side("z-", "Symmetric", "symmetry"),
    whole_side("x+", "Velocity", "Dirichlet", (0.0, 0.0, 0.0)),
]


def slab(low: int, high: int, index: int):
    """A body of four particles a cell."""
    positions = fill((2, 2, low), (24, 24, high), GRID.spacing, (2, 2, 1))
    particles = make_particles(GRID, positions, (2, 2, 1))
    particles.velocity[:] = 0.01, 0.0, 0.02
    return make_body(particles, index, model=elastic(1.0, 0.0))


def bytes_of_a_step(simulation) -> int:
    """The most that is allocated at a time in one of three steps, after the first few."""
    for _ in range(3):
        simulation.advance(DT)
    tracemalloc.start()
    try:
        most = 0
        for _ in range(3):
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            simulation.advance(DT)
            most = max(most, tracemalloc.get_traced_memory()[1] - before)
    finally:
        tracemalloc.stop()
    return most


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"flags": {"explicit_heat_conduction": True}},
        {"flags": {"XPIC2": True}},
        {"flags": {"restart_on_large_nodal_velocity": True}},
        {"regions": FACES},
        {"contact_laws": [SingleVelocity(materials=())]},
    ],
    ids=["plain", "heat", "xpic", "too fast", "conditions", "contact"],
)
def test_a_step_allocates_nothing_as_long_as_particles_or_nodes(options) -> None:
    """Not one byte for each: what is seen are the small objects of Python that come and go."""
    bodies = [slab(2, 15, 0), slab(15, 28, 1)]
    least = min(GRID.number_of_nodes, *(len(body.particles) for body in bodies))
    assert least > 25_000
    simulation = make_simulation(GRID, bodies, **options)
    assert bytes_of_a_step(simulation) < least


def test_the_count_sees_arrays() -> None:
    """A step that makes one array of a byte a particle is found out."""
    body = slab(2, 28, 0)
    simulation = make_simulation(GRID, [body])
    simulation.after_step.append(lambda simulation, dt: np.ones(len(body.particles), np.bool_).any())
    assert bytes_of_a_step(simulation) >= len(body.particles)


def test_a_workspace_gives_the_same_memory_again() -> None:
    workspace = Workspace()
    first = workspace.rows("a", 5, np.float64, 3)
    assert first.shape == (5, 3)
    assert workspace.rows("a", 4, np.float64, 3).base is first.base
    assert workspace.rows("b", 4, np.float64, 3).base is not first.base
    assert workspace.rows("a", 6, np.float64, 3).shape == (6, 3)
