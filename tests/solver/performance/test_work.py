"""The model of the work of a step, against what the step does."""

from __future__ import annotations

import numpy as np
import pytest
from mpm_cases import elastic, fill, make_body, make_grid, make_particles, make_simulation

from solver.interpolation.cpdi import Cpdi
from solver.interpolation.gimp import Gimp, GimpAxisymmetric
from solver.interpolation.linear import Linear, LinearAxisymmetric
from solver.particles import Particles
from solver.performance.phases import Phase, PhaseClock, no_clock
from solver.performance.work import ACCESS, active_nodes, domain_fields, weights_of, work_of_step

DT = 0.01


def simulation_of(interpolator=None, **options):
    """A block that moves and spins."""
    extra = (0, 0, 0) if isinstance(interpolator, Linear) else (1, 1, 1)
    grid = make_grid((8, 8, 8), extra=extra)
    particles = make_particles(grid, fill((2, 2, 2), (6, 6, 6), grid.spacing, (2, 2, 2)))
    particles.velocity[:] = np.cross((0.1, 0.2, 0.3), particles.position - 4.0)
    particles.stress[:] = 0.01 * np.eye(3)
    body = make_body(particles, model=elastic(1.0, 0.2))
    return make_simulation(grid, [body], interpolator, **options)


@pytest.mark.parametrize("phase", [Phase.TO_GRID, Phase.TO_PARTICLES, Phase.STRESS, Phase.SETTLE])
def test_a_phase_changes_the_arrays_that_the_model_names(phase: Phase) -> None:
    """Neither others, nor fewer: every array that is said to be written gets new values."""
    simulation = simulation_of(flags={"explicit_heat_conduction": True, "artificial_viscosity": True})
    simulation.advance(DT)
    particles = simulation.bodies[0].particles
    particles.external_heat_rate[:] = 1.0
    for array in (particles.heating_rate, particles.artificial_pressure, particles.previous_temperature):
        array[:] = 1.0  # so that what is written differs
    particles.localized[:] = 1
    now, changed = [Phase.OUTSIDE], {each: set() for each in Phase}
    before = [array.copy() for array in particles]

    def clock(begins: Phase) -> None:
        for name, old, array in zip(Particles._fields, before, particles, strict=True):
            if not np.array_equal(old, array):
                changed[now[0]].add(name)
                old[...] = array
        now[0] = begins

    simulation.clock = clock
    simulation.advance(DT)
    assert changed[phase] <= ACCESS[phase].written
    kept_by_this_model = {"localized"}
    assert ACCESS[phase].written - changed[phase] <= kept_by_this_model
    assert changed[Phase.GRID] == changed[Phase.CONTACT] == set()


def test_domains_read_what_they_need() -> None:
    assert domain_fields(Gimp()) == {"size"}
    assert domain_fields(Cpdi()) == {"size", "deformation_gradient"}


@pytest.mark.parametrize(("interpolator", "nodes"), [(LinearAxisymmetric(), 8), (GimpAxisymmetric(), 18)])
def test_nodes_of_bodies_of_revolution(interpolator, nodes: int) -> None:
    """Two or three along the radius and the axis, in two layers."""
    grid = make_grid((8, 8, 1), extra=(1, 1, 0))
    centres = fill((0, 2, 0), (4, 6, 1), grid.spacing, (1, 1, 1))
    particles = make_particles(grid, centres + np.array((0.3, 0.3, 0.0)), (2, 2, 1))  # they reach over a node
    simulation = make_simulation(grid, [make_body(particles)], interpolator, flags={"axisymmetric": True})
    assert weights_of(simulation, simulation.bodies[0]).nodes == nodes


def test_nodes_and_bytes_of_linear_weights() -> None:
    simulation = simulation_of(Linear())
    assert weights_of(simulation, simulation.bodies[0]).nodes == 8.0
    simulation.advance(DT)
    nodes = active_nodes(simulation)
    assert nodes == 5**3  # of the cells in which the block is
    n = len(simulation.bodies[0].particles)
    work = work_of_step(simulation)
    read = 3 + 1 + 1 + 3 + 9 + 1 + 1 + 3 + 3 + 1 + 9  # x m V v sigma T q grad-T f heat, and the size
    assert work[Phase.TO_GRID].bytes == 8 * (n * read + 2 * 16 * nodes)
    needed = 3 + 9 + 9 + 9 + 5 + 3  # x F L sigma, V m T T-before dT/dt, v-before
    written = 9 + 9 + 5  # F sigma, V T T-before heating q
    failure_time, localized = 8, 4
    assert work[Phase.STRESS].bytes == n * (8 * (needed + written) + 2 * (failure_time + localized))


def test_operations_of_the_stress_grow_with_the_particles() -> None:
    """Those of hypoelasticity are at least the product of F and its update, 45, and two determinants of 14."""
    simulation = simulation_of()
    before = [array.copy() for array in simulation.bodies[0].particles]
    work = work_of_step(simulation)
    n = len(before[0])
    assert 45 + 2 * 14 < work[Phase.STRESS].operations / n < 1000
    for old, array in zip(before, simulation.bodies[0].particles, strict=True):
        np.testing.assert_array_equal(old, array)


def test_a_clock_adds_up_what_passes() -> None:
    times = iter([0.0, 1.0, 3.0, 6.0, 10.0, 15.0])
    clock = PhaseClock(lambda: next(times))
    clock(Phase.GRID)
    clock(Phase.STRESS)
    clock(Phase.GRID)
    clock(Phase.OUTSIDE)
    assert clock.seconds[Phase.OUTSIDE] == 1.0
    assert clock.seconds[Phase.GRID] == 2.0 + 4.0
    assert clock.seconds[Phase.STRESS] == 3.0
    clock.restart()
    assert not any(clock.seconds.values())


def test_without_a_clock_nothing_is_called() -> None:
    assert simulation_of().clock is no_clock
