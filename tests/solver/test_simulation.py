"""Whole simulations, built without a deck, against exact solutions and conservation laws."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mpm_cases import (
    MATERIAL,
    advance,
    elastic,
    fill,
    make_body,
    make_grid,
    make_particles,
    make_simulation,
    whole_side,
)
from scipy.special import erfc

from solver.contact.nodal_svf import NodalVolumeFraction
from solver.contact.single_velocity import SingleVelocity
from solver.materials.rigid import Rigid
from solver.particles import keep
from solver.simulation import DivergedError

CUBE = (2, 2, 2)


def block(grid, low, high, index=0, velocity=(0.0, 0.0, 0.0), **options):
    """A box of particles, eight to a cell, moving as one."""
    particles = make_particles(grid, fill(low, high, grid.spacing, CUBE))
    particles.velocity[:] = velocity
    return make_body(particles, index, **options)


def order(rate, coarse, fine):
    """The exponent with which an error falls when the step is divided by ``rate``."""
    return math.log(coarse / fine) / math.log(rate)


# ---- rigid motion ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "flags", [{}, {"XPIC2": True}, {"minimum_subcycles_for_F": -2, "pressure_stabilization": True}]
)
def test_translation_leaves_a_body_without_strain_or_stress(flags):
    grid = make_grid((8, 6, 6))
    velocity = np.array([0.3, -0.1, 0.2])
    body = block(grid, (2, 2, 2), (4, 4, 4), velocity=velocity)
    start = body.particles.position.copy()
    simulation = make_simulation(grid, [body], flags=flags)
    advance(simulation, 0.25, 20)
    np.testing.assert_allclose(body.particles.position, start + 5.0 * velocity, atol=1e-12)
    np.testing.assert_allclose(body.particles.velocity, np.tile(velocity, (len(start), 1)), atol=1e-13)
    assert abs(body.particles.velocity_gradient).max() < 1e-13
    assert abs(body.particles.stress).max() < 1e-12
    np.testing.assert_allclose(body.particles.displacement, body.particles.position - start, atol=1e-14)


@pytest.mark.parametrize("flags", [{}, {"XPIC2": True}])
def test_free_fall(flags):
    """Velocities are exact; positions are those of steps with the velocity of their end (symplectic Euler).

    XPIC moves particles by the mean velocity of the step instead, which is exact.
    """
    grid, gravity, dt, steps = make_grid((4, 10, 4)), np.array([0.0, -0.5, 0.0]), 0.125, 24
    body = block(grid, (1, 7, 1), (3, 9, 3))
    start = body.particles.position.copy()
    advance(make_simulation(grid, [body], gravity=tuple(gravity), flags=flags), dt, steps)
    time = dt * steps
    fall = 0.5 * gravity * time * (time if flags else time + dt)
    np.testing.assert_allclose(body.particles.velocity, np.tile(gravity * time, (len(start), 1)), atol=1e-12)
    np.testing.assert_allclose(body.particles.position, start + fall, atol=1e-11)
    assert abs(body.particles.stress).max() < 1e-12


def test_a_rigid_body_moves_on_without_forces():
    grid = make_grid((8, 4, 4))
    body = block(grid, (1, 1, 1), (3, 3, 3), velocity=(0.5, 0.0, 0.0), model=Rigid(), rigid=True)
    body.particles.stress[:] = np.eye(3)
    simulation = make_simulation(grid, [body])
    assert simulation.initial_time_step() == 1.0
    advance(simulation, 0.5, 4)
    np.testing.assert_allclose(body.particles.velocity[:, 0], 0.5, rtol=1e-13)
    assert simulation.reductions["StrainEnergy", 0] == 0.0


# ---- conservation ----------------------------------------------------------------------------------------


def collision(flags=None):
    grid = make_grid((12, 5, 5))
    bodies = [
        block(grid, (2, 1, 1), (5, 4, 4), 0, (0.1, 0.02, 0.0), model=elastic(1.0, 0.3)),
        block(grid, (6, 1.5, 1.5), (9, 4, 4), 1, (-0.15, 0.0, 0.01), model=elastic(1.0, 0.3)),
    ]
    bodies[1].particles.mass[:] *= 2.0
    return make_simulation(grid, bodies, flags=flags, contact_laws=[SingleVelocity()])


@pytest.mark.parametrize("flags", [{}, {"XPIC2": True}, {"pressure_stabilization": True}])
def test_collision_conserves_momentum(flags):
    simulation = collision(flags)
    particles = [body.particles for body in simulation.bodies]
    before = sum(p.mass @ p.velocity for p in particles)
    advance(simulation, 0.2, 40)
    each = [p.mass @ p.velocity for p in particles]
    assert abs(each[0][0] - 0.1 * particles[0].mass.sum()) > 0.1
    scale = sum((p.mass * np.linalg.norm(p.velocity, axis=1)).sum() for p in particles)
    np.testing.assert_allclose(sum(each), before, atol=1e-12 * scale)
    np.testing.assert_allclose(simulation.reductions["TotalMomentum", -1], before, atol=1e-12 * scale)
    assert simulation.reductions["TotalMass", -1] == pytest.approx(sum(p.mass.sum() for p in particles))


def test_reductions_are_the_sums_over_particles():
    simulation = collision()
    advance(simulation, 0.2, 30)
    for m, body in enumerate(simulation.bodies):
        p, sums = body.particles, simulation.reductions
        assert sums["KineticEnergy", m] == pytest.approx(0.5 * p.mass @ (p.velocity**2).sum(axis=1))
        assert sums["TotalVolumeDeformed", m] == pytest.approx(p.volume.sum())
        assert sums["ThermalEnergy", m] == pytest.approx(MATERIAL.specific_heat * p.mass @ p.temperature)
        np.testing.assert_allclose(sums["CenterOfMassPosition", m], p.mass @ p.position)
    for label in ("KineticEnergy", "StrainEnergy", "TotalVolumeDeformed"):
        total = simulation.reductions[label, 0] + simulation.reductions[label, 1]
        assert simulation.reductions[label, -1] == pytest.approx(total)


@pytest.mark.parametrize("periodic", [(1, 0, 0), (1, 1, 1)])
def test_total_mass_counts_every_node_of_a_periodic_domain_once(periodic):
    grid = make_grid((3, 3, 3), periodic=periodic)
    body = block(grid, (0, 0, 0), (3, 3, 3))
    simulation = make_simulation(grid, [body])
    advance(simulation, 0.1, 1)
    assert simulation.reductions["TotalMass", -1] == pytest.approx(27.0 * MATERIAL.density)


# ---- elastic bars ----------------------------------------------------------------------------------------


def vibrating_bar(width, poissons_ratio, amplitude, length=16):
    """A free bar of E = 1 in its first longitudinal mode, v = amplitude cos(pi x / length)."""
    grid = make_grid((length + 4, width + 2, width + 2), anchor=(-2.0, -1.0, -1.0))
    body = block(grid, (0, 0, 0), (length, width, width), model=elastic(1.0, poissons_ratio))
    mode = np.cos(math.pi * body.particles.position[:, 0] / length)
    body.particles.velocity[:, 0] = amplitude * mode
    return make_simulation(grid, [body]), mode


def test_waves_in_a_slender_bar_travel_at_the_speed_of_its_youngs_modulus():
    """The first mode stops after a quarter period, in which sqrt(E / rho) goes half along the bar."""
    simulation, mode = vibrating_bar(width=2, poissons_ratio=0.3, amplitude=1e-4)
    speed, particles, dt = math.sqrt(1.0 / MATERIAL.density), simulation.bodies[0].particles, 0.4
    amplitudes = [particles.velocity[:, 0] @ mode]
    while amplitudes[-1] > 0.0:
        simulation.advance(dt)
        amplitudes.append(particles.velocity[:, 0] @ mode)
    fraction = amplitudes[-2] / (amplitudes[-2] - amplitudes[-1])
    quarter = (len(amplitudes) - 2 + fraction) * dt
    assert 16.0 / 2.0 / quarter == pytest.approx(speed, rel=0.03)
    # A wide body would be faster by sqrt((1 - nu) / (1 + nu) / (1 - 2 nu)) = 1.16.


def energy_error(dt, duration=12.0):
    """Largest change of kinetic plus strain energy of a vibrating bar over the energy at the start."""
    simulation, _ = vibrating_bar(width=1, poissons_ratio=0.0, amplitude=1e-3, length=8)
    particles = simulation.bodies[0].particles
    start = 0.5 * particles.mass @ (particles.velocity**2).sum(axis=1)
    strain_energy, worst = 0.0, 0.0
    for _ in range(round(duration / dt)):
        simulation.advance(dt)
        strain_energy += simulation.reductions["StrainEnergy", -1]  # of this model, the step's increment
        worst = max(worst, abs(simulation.reductions["KineticEnergy", -1] + strain_energy - start))
    return worst / start


def test_energy_of_a_vibrating_bar_is_conserved_to_first_order_in_the_time_step():
    errors = [energy_error(dt) for dt in (0.4, 0.2, 0.1)]
    assert errors[-1] < 0.02
    assert order(2.0, errors[0], errors[1]) == pytest.approx(1.0, abs=0.25)
    assert order(2.0, errors[1], errors[2]) == pytest.approx(1.0, abs=0.25)


# ---- heat ------------------------------------------------------------------------------------------------

CONDUCTOR = MATERIAL._replace(thermal_conductivity=0.8)
DIFFUSIVITY = 0.8 / (MATERIAL.density * MATERIAL.specific_heat)


def heated_bar(cells, regions, temperature=None, length=1.0):
    """A bar of one cell's width between x = 0 and ``length``, two particles a cell along it."""
    h = length / cells
    grid = make_grid((cells, 1, 1), (h, h, h))
    positions = fill((0, 0, 0), (length, h, h), grid.spacing, (2, 1, 1))
    particles = make_particles(grid, positions, (2, 1, 1))
    particles.temperature[:] = 0.0 if temperature is None else temperature(positions[:, 0])
    body = make_body(particles, material=CONDUCTOR)
    return make_simulation(grid, [body], regions=regions), particles


def held(face, value):
    return whole_side(face, "Temperature", "Dirichlet", value)


def decay_error(cells, wave, regions):
    """Worst error at time 1 of a half wave of temperature around 10, relative to its exact height."""
    simulation, particles = heated_bar(cells, regions, lambda x: 10.0 + wave(math.pi * x))
    steps = cells**2 // 2
    advance(simulation, 1.0 / steps, steps)
    height = math.exp(-DIFFUSIVITY * math.pi**2)
    exact = 10.0 + height * wave(math.pi * particles.position[:, 0])
    return abs(particles.temperature - exact).max() / height


def test_heat_in_an_insulated_bar_converges_to_second_order():
    errors = [decay_error(cells, np.cos, []) for cells in (8, 16)]
    assert errors[1] < 0.02
    assert order(2.0, *errors) == pytest.approx(2.0, abs=0.15)


def test_heat_between_held_ends_converges_to_first_order():
    """The held temperature is that of nodes, which the particles beside them miss by half their spacing."""
    ends = [held("x-", 10.0), held("x+", 10.0)]
    errors = [decay_error(cells, np.sin, ends) for cells in (8, 16)]
    assert errors[1] < 0.12
    assert order(2.0, *errors) == pytest.approx(1.0, abs=0.2)


def test_heat_enters_a_half_space_as_the_error_function_says():
    simulation, particles = heated_bar(40, [held("x-", 1.0)], length=2.0)
    advance(simulation, 0.005, 100)
    exact = erfc(particles.position[:, 0] / (2.0 * math.sqrt(DIFFUSIVITY * 0.5)))
    np.testing.assert_allclose(particles.temperature[:4], exact[:4], atol=0.07)
    np.testing.assert_allclose(particles.temperature[4:], exact[4:], atol=0.01)


def test_an_insulated_bar_keeps_its_heat():
    simulation, particles = heated_bar(10, [], lambda x: 300.0 + 20.0 * x**2)
    before = particles.mass @ particles.temperature
    advance(simulation, 0.01, 30)
    assert np.ptp(particles.temperature) < 19.0
    assert particles.mass @ particles.temperature == pytest.approx(before, rel=1e-13)


def test_without_heat_conduction_temperatures_stay():
    grid = make_grid((6, 1, 1))
    body = make_body(
        make_particles(grid, fill((0, 0, 0), (6, 1, 1), grid.spacing, (2, 1, 1)), (2, 1, 1)),
        material=CONDUCTOR,
    )
    body.particles.temperature[:] += body.particles.position[:, 0]
    before = body.particles.temperature.copy()
    advance(make_simulation(grid, [body], flags={"explicit_heat_conduction": False}), 0.1, 3)
    np.testing.assert_array_equal(body.particles.temperature, before)
    assert (body.particles.temperature_gradient == 0.0).all()


def test_bodies_in_thermal_contact_meet_between_their_temperatures():
    grid = make_grid((4, 4, 4))
    bodies = [block(grid, (1, 1, 1), (3, 3, 3), index) for index in range(2)]
    bodies[0].particles.temperature[:] = 400.0
    bodies[1].particles.temperature[:] = 300.0
    bodies[1].particles.mass[:] *= 3.0
    advance(make_simulation(grid, bodies, thermal_contact=True), 0.1, 1)
    for body in bodies:
        np.testing.assert_allclose(body.particles.temperature, 325.0)


# ---- what must not matter --------------------------------------------------------------------------------


def bouncing_block(patches=(1, 1, 1), shuffle=None, periodic=(0, 0, 0), shift=0.0):
    """A block that slides over a symmetry floor, is stopped by a wall, and weighs."""
    grid = make_grid((6, 4, 4), patches=patches, periodic=periodic)
    body = block(grid, (1, 0, 1), (3, 2, 3), velocity=(0.2, -0.05, 0.03), model=elastic(1.0, 0.2))
    body.particles.position[:, 0] += shift
    if shuffle is not None:
        body.particles = keep(body.particles, np.random.default_rng(shuffle).permutation(len(body.particles)))
    regions = [
        whole_side("y-", "Symmetric", "symmetry"),
        whole_side("x+", "Velocity", "Dirichlet", (0.0,) * 3),
    ]
    return make_simulation(grid, [body], regions=regions, gravity=(0.0, -0.01, 0.0))


def state_by_id(simulation):
    p = simulation.bodies[0].particles
    return np.concatenate(
        [a[np.argsort(p.id)].reshape(len(p), -1) for a in (p.position, p.velocity, p.stress)], axis=1
    )


def test_patches_do_not_matter():
    one, several = bouncing_block(), bouncing_block(patches=(3, 2, 2))
    for simulation in (one, several):
        advance(simulation, 0.25, 40)
    np.testing.assert_array_equal(state_by_id(several), state_by_id(one))


def test_order_of_particles_matters_to_rounding_only():
    plain, shuffled = bouncing_block(), bouncing_block(shuffle=3)
    for simulation in (plain, shuffled):
        advance(simulation, 0.25, 40)
    assert (shuffled.bodies[0].particles.id != plain.bodies[0].particles.id).any()
    np.testing.assert_allclose(state_by_id(shuffled), state_by_id(plain), atol=1e-12)


@pytest.mark.parametrize("flags", [{}, {"XPIC2": True}, {"gradient_enhanced_projection": True}])
def test_place_in_a_periodic_domain_does_not_matter(flags):
    """A deforming block moved over the faces of a domain that repeats behaves as one in its middle."""
    states = []
    for shift in (0.0, 2.0):
        grid = make_grid((4, 4, 4), periodic=(1, 1, 1))
        body = block(grid, (1, 1, 1), (3, 3, 3), model=elastic(1.0, 0.2))
        q = body.particles.position - 2.0
        body.particles.velocity[:] = 0.2 * np.stack(
            [q[:, 1], -q[:, 0] + 0.5 * q[:, 2], q[:, 1] * q[:, 0]], axis=1
        )
        body.particles.position[:] = (body.particles.position + shift) % 4.0
        simulation = make_simulation(grid, [body], flags=flags)
        advance(simulation, 0.2, 20)
        p = body.particles
        assert len(p) == 64
        states.append(
            np.concatenate([(p.position - shift) % 4.0, p.velocity, p.stress.reshape(-1, 9)], axis=1)
        )
    assert abs(states[0][:, 6:]).max() > 1e-3
    np.testing.assert_allclose(states[1], states[0], atol=1e-11)


# ---- loads, life and death of bodies ---------------------------------------------------------------------


def test_a_load_accelerates_a_body():
    grid = make_grid((8, 4, 4))
    body = block(grid, (1, 1, 1), (3, 3, 3))

    def push(simulation, dt):
        body.particles.external_force[:, 0] = 0.01 * body.particles.mass

    simulation = make_simulation(grid, [body], before_step=[push])
    advance(simulation, 0.25, 20)
    np.testing.assert_allclose(body.particles.velocity[:, 0], 0.05, rtol=1e-10)
    np.testing.assert_allclose(
        simulation.reductions["SumTransmittedForce", 0], [0.01 * body.particles.mass.sum(), 0, 0], atol=1e-14
    )


def test_a_body_that_is_not_active_neither_weighs_nor_pushes():
    simulation = collision()
    simulation.bodies[1].activation_time = 10.0
    alone = simulation.bodies[0].particles.velocity.copy()
    advance(simulation, 0.2, 40)
    np.testing.assert_allclose(simulation.bodies[0].particles.velocity, alone, atol=1e-12)
    assert simulation.reductions["TotalMass", 1] < 1e-100
    advance(simulation, 0.2, 20)
    assert simulation.reductions["TotalMass", 1] == pytest.approx(simulation.bodies[1].particles.mass.sum())


@pytest.mark.parametrize(
    ("is_active", "activation_time", "expected"),
    [
        (True, 0.0, [True, True]),
        (True, 0.5, [False, True]),
        (False, 0.5, [False, True]),
        (False, 0.0, [False, False]),
    ],
)
def test_a_body_takes_part_from_its_activation_time(is_active, activation_time, expected):
    """Decks that insert particles say both: not active, and from when on it is."""
    grid = make_grid((3, 3, 3))
    body = block(grid, (1, 1, 1), (2, 2, 2), is_active=is_active, activation_time=activation_time)
    assert [body.takes_part(time) for time in (0.0, 0.5)] == expected
    simulation = make_simulation(grid, [body], time=0.5)
    simulation.advance(0.1)
    assert (simulation.reductions["TotalMass", 0] > 1.0) == expected[1]


@pytest.mark.parametrize("waiting", [0, 1])
@pytest.mark.parametrize("flags", [{}, {"XPIC2": True}])
def test_a_body_that_waits_where_another_moves_is_not_carried_along(waiting, flags):
    """It is in free fall, as in Uintah; its nodes hold no mass, so nothing of the other's motion is to be seen."""
    grid = make_grid((8, 8, 4))
    bodies = [block(grid, (1, 4, 1), (3, 6, 3), m, (0.1, 0.0, 0.0)) for m in (0, 1)]
    bodies[waiting].particles.velocity[:] = 0.0
    bodies[waiting].activation_time = 10.0
    start = bodies[waiting].particles.position.copy()
    simulation = make_simulation(grid, bodies, gravity=(0.0, -0.01, 0.0), flags=flags)
    advance(simulation, 0.2, 10)
    moved = bodies[waiting].particles.position - start
    np.testing.assert_allclose(moved[:, [0, 2]], 0.0, atol=1e-14)
    assert (moved[:, 1] <= 0.0).all()
    assert (moved[:, 1] > -0.025).all()
    np.testing.assert_allclose(bodies[1 - waiting].particles.velocity[:, 0], 0.1, rtol=1e-12)


def test_a_body_that_waits_keeps_its_temperature():
    """Neither what is in its place nor a face warms it: at its nodes there is no mass to have a temperature."""
    grid = make_grid((6, 4, 4))
    bodies = [block(grid, (1, 1, 1), (3, 3, 3), 0), block(grid, (0, 1, 1), (2, 3, 3), 1)]
    bodies[0].particles.temperature[:] = 400.0
    bodies[1].activation_time = 10.0
    simulation = make_simulation(
        grid,
        bodies,
        regions=[whole_side("x-", "Temperature", "Dirichlet", 350.0)],
        thermal_contact=True,
    )
    advance(simulation, 0.1, 3)
    np.testing.assert_array_equal(bodies[1].particles.temperature, MATERIAL.room_temperature)
    np.testing.assert_allclose(bodies[0].particles.temperature, 400.0)


@pytest.mark.parametrize("use_svf", [True, False])
def test_drag_at_nodes_of_one_material_alone_does_not_pile_up(use_svf):
    """Where the other has no mass its velocity means nothing, and must not grow from step to step."""
    grid = make_grid((10, 4, 4))
    bodies = [
        block(grid, (1, 1, 1), (3, 3, 3), 0, (0.001, 0.0, 0.0)),
        block(grid, (6, 1, 1), (8, 3, 3), 1),
    ]
    drag = NodalVolumeFraction(myu=1e3, use_svf=use_svf)
    simulation = make_simulation(grid, bodies, contact_laws=[drag])
    advance(simulation, 0.1, 150)
    np.testing.assert_allclose(bodies[0].particles.velocity[:, 0], 0.001, rtol=1e-10)
    assert abs(simulation.nodal.velocity_star).max() < 1.0


def test_only_nodes_with_particles_are_too_fast():
    """A motion that is imposed on the whole grid is fast far from the body, where there is nothing to move."""
    grid = make_grid((4, 4, 40))
    body = block(grid, (1, 1, 1), (3, 3, 3))

    def impose(simulation, dt):
        simulation.nodal.velocity_star[0] = simulation.node_positions * 0.1

    simulation = make_simulation(
        grid, [body], flags={"restart_on_large_nodal_velocity": True}, after_boundary_conditions=[impose]
    )
    advance(simulation, 0.25, 4)
    assert simulation.step_number == 4


def test_particles_that_leave_take_their_state_along():
    grid = make_grid((4, 4, 4))
    body = block(grid, (2, 1, 1), (4, 3, 3), velocity=(0.5, 0.0, 0.0))
    simulation = make_simulation(grid, [body])
    advance(simulation, 0.5, 4)
    assert len(body.particles) == 32
    assert body.particles.position[:, 0].max() < 4.0
    assert all(len(array) == 32 for array in body.particles)


def test_a_value_that_is_not_finite_stops_the_run_with_the_material_and_the_step():
    grid = make_grid((4, 4, 4))
    bodies = [block(grid, (1, 1, 1), (2, 2, 2)), block(grid, (2, 2, 2), (3, 3, 3), 1)]
    simulation = make_simulation(grid, bodies)
    simulation.advance(0.1)
    bodies[1].particles.velocity[3, 1] = math.nan
    with pytest.raises(DivergedError, match=r"material 1 \(body 1\).* step 2 .*0\.2"):
        simulation.advance(0.1)


@pytest.mark.parametrize("component", [0, 1, 2])
def test_a_rigid_body_that_moves_nowhere_finite_stops_the_run_too(component):
    grid = make_grid((4, 4, 4))
    body = block(grid, (1, 1, 1), (2, 2, 2), model=Rigid(), rigid=True)
    body.particles.velocity[0, component] = math.nan
    with pytest.raises(DivergedError):
        make_simulation(grid, [body]).advance(0.1)


# ---- the stable step -------------------------------------------------------------------------------------


def test_stable_step_is_the_time_in_which_a_wave_crosses_the_shortest_side():
    grid = make_grid((6, 6, 6), (1.0, 0.5, 2.0))
    particles = make_particles(grid, fill((1, 1, 2), (3, 2, 6), grid.spacing, CUBE))
    particles.velocity[:] = (0.3, 0.0, -0.1)
    model = elastic(1.0, 0.25)
    simulation = make_simulation(grid, [make_body(particles, model=model)])
    speed = math.sqrt((model.K + 4.0 / 3.0 * model.G) / MATERIAL.density)
    expected = min(1.0 / (speed + 0.3), 0.5 / speed, 2.0 / (speed + 0.1))
    assert simulation.initial_time_step() == pytest.approx(expected)
    assert simulation.advance(0.1) == pytest.approx(expected)


def test_other_limits_bound_the_step():
    grid = make_grid((4, 4, 4))
    simulation = make_simulation(
        grid, [block(grid, (1, 1, 1), (2, 2, 2))], time_step_limits=[lambda t: 0.01 + t]
    )
    assert simulation.initial_time_step() == 0.01
    assert simulation.advance(0.1) == pytest.approx(0.11)
    assert (simulation.step_number, simulation.time) == (1, 0.1)
