"""Drucker and Prager's cone with non-local softening: closed forms at a point, a plain reference for bodies."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import Driver, assert_kernel_agrees, assert_turns_with_the_path

from solver.domains.exchange import OneRank
from solver.grid import Grid, Patch
from solver.interpolation.linear import Linear
from solver.materials.constitutive import (
    Neighbourhood,
    couple_particles,
    initialize,
    is_coupled,
)
from solver.materials.hypo_elastic import HypoElastic
from solver.materials.nonlocal_drucker_prager import WEIGHT, NonlocalDruckerPrager
from solver.particles import Particles, new_arrays

K, G, COHESION = 7.6e9, 2.6e9, 4.0e6


def rock(**changes):
    values = {"alpha": 0.2, "alpha_p": 0.1, "k_o": COHESION, "bulk_modulus": K, "shear_modulus": G}
    return NonlocalDruckerPrager(**(values | changes))


def parts(stress):
    s = stress - np.trace(stress) / 3 * np.eye(3)
    return np.sqrt(0.5 * np.sum(s * s)), np.trace(stress)


SHEAR = np.array([[1, 0.01, 0], [0, 1, 0], [0, 0, 1]])


@pytest.mark.parametrize(("h_local", "h_nonlocal"), [(0.0, 0.0), (2e8, 0.0), (1e8, -3e8), (0.0, -2e8)])
def test_a_step_of_shear_in_closed_form(h_local, h_nonlocal):
    model = rock(h_local=h_local, h_nonlocal=h_nonlocal)
    driver = Driver(model)
    gamma = 0.01
    F = np.array([[1, gamma, 0], [0, 1, 0], [0, 0, 1]])
    stress = driver.advance(F)
    # in the frame turned by R (exact to 1e-8) the step is symmetric shear: the elastic prediction is G gamma
    size = np.sqrt(0.5 + 3 * 0.1**2)
    resistance = (G + 9 * K * 0.2 * 0.1) / size
    multiplier = (G * gamma - COHESION) / (resistance + h_local + h_nonlocal)
    shear, trace = parts(stress)
    assert driver.state.plastic_strain[0] == pytest.approx(multiplier, rel=3e-8)
    assert shear == pytest.approx(G * gamma - G * multiplier / size, rel=3e-8)
    assert trace == pytest.approx(-9 * K * 0.1 * multiplier / size, rel=3e-8)
    strength = COHESION + (h_local + h_nonlocal) * multiplier
    assert shear + 0.2 * trace == pytest.approx(strength, rel=3e-8)


def test_softening_ends_at_the_least_strength():
    driver = Driver(rock(alpha=0.0, alpha_p=0.0, h_nonlocal=-1e9, minimum_yield_stress=1e6))
    for gamma in np.linspace(0, 0.05, 60)[1:]:
        stress = driver.advance([[1, gamma, 0], [0, 1, 0], [0, 0, 1]])
        assert parts(stress)[0] >= 1e6 * (1 - 3e-8)
    assert parts(stress)[0] == pytest.approx(1e6, rel=3e-8)


def test_tension_ends_at_the_tip():
    driver = Driver(rock(alpha_p=0.0))
    stress = driver.advance(np.eye(3) * 1.01)
    np.testing.assert_allclose(stress, COHESION / 0.6 * np.eye(3), rtol=1e-12)


def test_initial_stress_counts_in_yielding_and_is_not_seen():
    free, pressed = (
        Driver(rock()),
        Driver(rock(initial_xstress=-2e7, initial_ystress=-2e7, initial_zstress=-2e7)),
    )
    assert parts(pressed.advance(SHEAR))[0] > parts(free.advance(SHEAR))[0]
    still = Driver(rock(initial_xstress=-1e5))
    np.testing.assert_allclose(still.advance(np.eye(3)), 0.0, atol=1e-9)


def test_cohesion_is_drawn_from_its_distribution():
    model = rock(k_o_dist="weibull, 4e6, 8, 1.0, 3")
    particles = new_arrays(Particles, 4000)
    particles.volume[:] = 1.0
    state = new_arrays(model.State, 4000)
    initialize(model, state, particles, None, np.repeat([0, 1], 2000))
    assert state.cohesion.mean() == pytest.approx(4e6, rel=0.01)
    assert state.cohesion.std() / 4e6 == pytest.approx(0.148, rel=0.05)  # of Weibull's modulus 8


def test_compiled_and_turned():
    assert_kernel_agrees(rock(h_local=1e8), rtol=1e-10)
    assert_turns_with_the_path(rock(h_local=1e8), rtol=1e-7)


@pytest.mark.parametrize(
    ("changes", "field"), [({"h_nonlocal": -1e11}, "h_nonlocal"), ({"k_o_dist": "weibull, 1"}, "k_o_dist")]
)
def test_faults(changes, field):
    assert [name for name, _ in rock(**changes).faults()] == [field]


# ---- the particles of a body -------------------------------------------------------------------------------

SPACING = 0.1
CELLS = (6, 5, 1)
GRID = Grid((0.0, 0.0, 0.0), (SPACING,) * 3, CELLS, (0, 0, 0), (0, 0, 0), (Patch(0, (0, 0, 0), CELLS),))


def body(model, shears):
    """Particles at random places that were sheared by single steps."""
    count = len(shears)
    rng = np.random.default_rng(4)
    particles, state = new_arrays(Particles, count), new_arrays(model.State, count)
    particles.position[:] = rng.uniform(0.02, 0.98, (count, 3)) * np.array(CELLS) * SPACING
    particles.mass[:] = particles.volume[:] = 1.0
    particles.size[:] = 0.5 * np.eye(3)
    state.cohesion[:] = model.k_o
    state.trial_stress[:, 0, 1] = state.trial_stress[:, 1, 0] = shears
    return particles, state


def hats(position):
    """Linear weights (n, nodes) of the grid."""
    nodes = GRID.node_positions()
    distance = np.abs(position[:, None] - nodes[None]) / SPACING
    return np.prod(np.maximum(0.0, 1.0 - distance), axis=2)


def plain_multipliers(model, particles, state):
    """The same fixed point, all particles at once."""
    weights, nodes = hats(particles.position), GRID.node_positions()
    reach = model.l_nonlocal / SPACING
    q, n = particles.position[:, None] / SPACING, np.round(nodes[None] / SPACING)
    near = np.all((n >= np.floor(q - reach)) & (n <= np.ceil(q + reach)), axis=2)
    share = np.exp(-(WEIGHT**2) * ((q - n) ** 2).sum(axis=2) / reach**2) * near * weights.sum(axis=0)
    size = np.sqrt(0.5 + 3 * model.alpha_p**2)
    resistance = (model.shear_modulus + 9 * model.bulk_modulus * model.alpha * model.alpha_p) / size
    base = state.trial_stress[:, 0, 1] - model.k_o
    multiplier = np.maximum(base, 0.0) / (resistance + model.h_local)
    for _ in range(500):
        total = weights.sum(axis=0)
        at_nodes = np.divide(multiplier @ weights, total, out=np.zeros_like(total), where=total > 1e-10)
        average = share @ at_nodes / share.sum(axis=1)
        load = base - model.h_nonlocal * average
        multiplier = np.maximum(load, 0.0) / (resistance + model.h_local)
    return multiplier, average


def couple(model, particles, state, grid=GRID):
    periodic = OneRank(grid)
    repeats = tuple(n * p for n, p in zip(grid.cells, grid.periodic, strict=True))
    neighbourhood = Neighbourhood(
        Linear(),
        grid.index,
        particles.position,
        0.5,
        repeats,
        lambda sums: periodic.add(sums)(),
        periodic.communicator.largest,
    )
    return couple_particles(model, state, particles, neighbourhood)


@pytest.mark.parametrize("length", [0.07, 0.2])
def test_multipliers_are_those_of_a_plain_reference(length):
    model = rock(alpha=0.0, alpha_p=0.0, h_local=1e8, h_nonlocal=-6e8, l_nonlocal=length)
    shears = COHESION * np.random.default_rng(1).uniform(0.5, 1.6, 40)
    shears[:5] = 0.98 * COHESION
    particles, state = body(model, shears)
    expected, average = plain_multipliers(model, particles, state)
    couple(model, particles, state)
    np.testing.assert_allclose(state.plastic_strain, expected, rtol=1e-8, atol=1e-13)
    np.testing.assert_allclose(state.nonlocal_hardening, -6e8 * average, rtol=1e-6)
    np.testing.assert_allclose(particles.stress[:, 0, 1], shears - G * expected / np.sqrt(0.5), rtol=1e-8)
    assert (expected[:5] > 0.0).any() or length < 0.1  # some are weakened by their neighbours alone


@pytest.mark.parametrize("length", [0.07, 0.2, 0.9])
def test_a_body_across_a_periodic_face_flows_as_one_in_the_middle(length):
    """Also where the average reaches once around the domain."""
    grid = Grid((0.0, 0.0, 0.0), (SPACING,) * 3, CELLS, (0, 0, 0), (1, 1, 0), GRID.patches)
    model = rock(alpha=0.0, alpha_p=0.0, h_local=1e8, h_nonlocal=-6e8, l_nonlocal=length)
    shears = COHESION * np.random.default_rng(1).uniform(0.5, 1.6, 40)
    flows = []
    for shift in (0.0, 3 * SPACING):
        particles, state = body(model, shears)
        particles.position[:, :2] = 0.2 + 0.3 * particles.position[:, :2]  # in the middle of a face
        particles.position[:, :2] += shift
        particles.position[:, :2] %= np.array(CELLS[:2]) * SPACING
        couple(model, particles, state, grid)
        flows.append((state.plastic_strain, state.nonlocal_hardening))
    assert np.ptp(particles.position[:, 0]) > 0.5  # across the face
    np.testing.assert_allclose(*(f[0] for f in flows), rtol=1e-9)
    np.testing.assert_allclose(*(f[1] for f in flows), rtol=1e-9)


def test_average_flow_that_hardens_strongly_is_found():
    """The plain reference, whose sweeps would swing ever wider, is asked whether it would stay."""
    model = rock(alpha=0.0, alpha_p=0.0, h_local=1e8, h_nonlocal=6e9, l_nonlocal=0.2)
    shears = COHESION * np.random.default_rng(1).uniform(0.5, 1.6, 40)
    particles, state = body(model, shears)
    couple(model, particles, state)
    stiffness = G / np.sqrt(0.5) + 1e8
    load = shears - COHESION - state.nonlocal_hardening
    expected = np.where(shears > COHESION, np.maximum(load, 0.0) / stiffness, 0.0)
    np.testing.assert_allclose(state.plastic_strain, expected, rtol=1e-9, atol=1e-15)
    assert (state.nonlocal_hardening > 0.0).all()


def test_a_body_that_flows_alike_everywhere_is_a_point():
    model = rock(alpha=0.0, alpha_p=0.0, h_local=1e8, h_nonlocal=-6e8, l_nonlocal=0.2)
    particles, state = body(model, np.full(30, 1.5 * COHESION))
    couple(model, particles, state)
    expected = 0.5 * COHESION / (G / np.sqrt(0.5) + 1e8 - 6e8)
    np.testing.assert_allclose(state.plastic_strain, expected, rtol=1e-9)


def test_energy_follows_the_corrected_stresses():
    model = rock(alpha=0.0, alpha_p=0.0, h_nonlocal=-6e8, l_nonlocal=0.2)
    particles, state = body(model, np.full(30, 1.5 * COHESION))
    particles.stress[:, 0, 1] = particles.stress[:, 1, 0] = COHESION
    particles.velocity_gradient[:, 0, 1] = 3.0
    before = particles.stress[:, 0, 1].sum()
    change = couple(model, particles, state)
    assert change == pytest.approx(0.5 * 3.0 * 0.5 * (particles.stress[:, 0, 1].sum() - before), rel=1e-9)
    assert change < 0.0


def test_work_and_viscosity_at_a_point():
    driver = Driver(rock(), viscosity=True)
    F = np.diag([0.999, 1.0, 1.0])
    stress = driver.advance(F)
    assert driver.strain_energy == pytest.approx(
        0.5 * stress[0, 0] * -1e-3 * driver.particles.volume[0], rel=1e-9
    )
    assert driver.artificial_pressure > 0.0


def test_failed_particles_stay_as_they_are():
    model = rock(h_nonlocal=-1e8, l_nonlocal=0.2)
    particles, state = body(model, np.full(10, 1.5 * COHESION))
    particles.localized[3] = 1
    couple(model, particles, state)
    assert not particles.stress[3].any()
    assert particles.stress[4].any()


def test_only_such_models_are_coupled():
    assert is_coupled(rock())
    assert not is_coupled(HypoElastic(G=1.0, K=1.0))
