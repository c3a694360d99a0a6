"""Each loop of the step against dense matrices or closed forms."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import reference
from mpm_cases import MATERIAL, elastic, fill, make_body, make_grid, make_particles, make_simulation
from scipy.linalg import expm

from solver.interpolation.gimp import Gimp, GimpAxisymmetric
from solver.jit import kernel
from solver.kernels import nodes, settle, stress
from solver.kernels.stress import STRESS_SUMS, Kinematics
from solver.materials.constitutive import DELETE, NoState, Step
from solver.materials.failure import new_failure
from solver.materials.rigid import Rigid
from solver.nodal import EMPTY_MASS, new_nodal_fields
from solver.particles import keep
from solver.tensor import put_tensor, tensor_at

SPACING = (0.5, 0.25, 0.4)
SPACE = make_grid((5, 4, 3), SPACING, (-1.0, 2.0, 0.5))
SHEET = make_grid((5, 4, 1), (0.5, 0.25, 0.5), (-1.0, 2.0, 0.5))
DISK = make_grid((5, 4, 1), SPACING, (0.0, 2.0, 0.0), extra=(1, 1, 0))
DT = 0.01

CASES = {
    "gimp": (Gimp(), reference.gimp, SPACE),
    "gimp-2D": (Gimp(), reference.gimp, SHEET),
    "axisymmetric": (GimpAxisymmetric(), reference.gimp_axisymmetric, DISK),
}
CONDUCTOR = MATERIAL._replace(thermal_conductivity=3.0)


def random_particles(grid, count=40, seed=0):
    """Particles with something in every field that the transfers read."""
    random = np.random.default_rng(seed)
    margin = 0.3 * np.array(SPACING)
    low, high = np.array(grid.anchor) + margin, np.array(grid.upper) - margin
    particles = make_particles(grid, random.uniform(low, high, (count, 3)))
    particles.size[:] = np.diag([0.5, 0.5, 1.0 if grid.cells[2] == 1 else 0.5])
    if grid.cells[2] == 1:
        particles.position[:, 2] = 0.5 * (low[2] + high[2])
    for name in ("mass", "volume", "artificial_pressure"):
        getattr(particles, name)[:] = random.uniform(0.5, 1.5, count)
    particles.temperature[:] = random.uniform(300.0, 400.0, count)
    for name in (
        "velocity",
        "velocity_gradient",
        "temperature_gradient",
        "external_force",
        "external_heat_rate",
    ):
        array = getattr(particles, name)
        array[:] = random.normal(size=array.shape)
    stress = random.normal(size=(count, 3, 3))
    particles.stress[:] = stress + stress.transpose(0, 2, 1)
    particles.deformation_gradient[:] += random.uniform(-0.2, 0.2, (count, 3, 3))
    return particles


@dataclass
class Transfer:
    """One step of a body: its particles before and after it, and copies of the nodal fields in between."""

    before: Any
    after: Any
    nodal: Any
    reductions: Any

    @property
    def momentum(self):
        return self.nodal.mass[0, :, None] * self.nodal.velocity[0]


def step(interpolator, grid, particles, flags=None, driven=None, rigid=False, **options):
    """Make one step; ``driven`` holds v, v* and a that replace those of the nodes before particles move."""
    before = type(particles)(*(array.copy() for array in particles))
    body = make_body(particles, material=CONDUCTOR, model=Rigid() if rigid else None, rigid=rigid)
    kept = []

    def intervene(simulation, dt):
        kept.append(type(simulation.nodal)(*(array.copy() for array in simulation.nodal)))
        if driven is not None:
            nodal = simulation.nodal
            nodal.velocity[0], nodal.velocity_star[0], nodal.acceleration[0] = driven

    flags = {"axisymmetric": isinstance(interpolator, GimpAxisymmetric), **(flags or {})}
    simulation = make_simulation(
        grid, [body], interpolator, flags=flags, after_boundary_conditions=[intervene], **options
    )
    simulation.advance(DT)
    return Transfer(before, body.particles, kept[0], simulation.reductions)


@pytest.fixture(params=CASES)
def case(request):
    interpolator, shape, grid = CASES[request.param]
    particles = random_particles(grid)
    S, G = shape(grid, particles.position, particles.size, particles.deformation_gradient)
    return interpolator, grid, particles, grid is DISK, S, G


# ---- particles to grid ------------------------------------------------------------------------------------


def test_sums_at_the_nodes_agree_with_the_equations(case):
    interpolator, grid, particles, axisymmetric, S, G = case
    expected = reference.to_grid(particles, S, G, axisymmetric, conductivity=3.0, specific_heat=4.0)
    got = step(interpolator, grid, particles)
    nodal = got.nodal
    sums = {
        "mass": nodal.mass[0],
        "momentum": got.momentum,
        "volume": nodal.volume[0],
        "internal_force": nodal.internal_force[0],
        "external_force": nodal.external_force[0],
        "heat_content": nodal.mass[0] * nodal.temperature[0],
        "heat": nodal.heat[0],
    }
    for name, values in expected.items():
        np.testing.assert_allclose(sums[name], values, atol=1e-12 * (1 + abs(values).max()), err_msg=name)


def test_mass_momentum_volume_and_loads_are_conserved(case):
    interpolator, grid, particles, _, _, _ = case
    got = step(interpolator, grid, particles)
    m, nodal = got.before.mass, got.nodal
    np.testing.assert_allclose(nodal.mass.sum(), m.sum(), rtol=1e-13)
    np.testing.assert_allclose(got.momentum.sum(axis=0), m @ got.before.velocity, rtol=1e-12)
    np.testing.assert_allclose(nodal.volume.sum(), got.before.volume.sum(), rtol=1e-13)
    np.testing.assert_allclose(nodal.external_force[0].sum(axis=0), got.before.external_force.sum(axis=0))
    np.testing.assert_allclose((nodal.mass * nodal.temperature).sum(), m @ got.before.temperature, rtol=1e-13)
    np.testing.assert_allclose(nodal.heat.sum(), got.before.external_heat_rate.sum() / 4.0, rtol=1e-10)


def test_internal_forces_and_their_moments_are_in_balance():
    """A stress field exerts no net force, and by linear completeness and symmetry of stress no net moment."""
    force = step(Gimp(), SPACE, random_particles(SPACE)).nodal.internal_force[0]
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-11)
    np.testing.assert_allclose(np.cross(SPACE.node_positions(), force).sum(axis=0), 0.0, atol=1e-11)


def test_angular_momentum_of_the_particles_centres_is_that_of_the_nodes():
    """sum x_i x p_i = sum x_p x p_p: linear completeness carries moments of momentum over exactly."""
    got = step(Gimp(), SPACE, random_particles(SPACE))
    on_grid = np.cross(SPACE.node_positions(), got.momentum).sum(axis=0)
    before = got.before
    of_particles = (before.mass[:, None] * np.cross(before.position, before.velocity)).sum(axis=0)
    np.testing.assert_allclose(on_grid, of_particles, rtol=1e-11)


def test_gradients_enhance_the_projection(case):
    interpolator, grid, particles, _, S, _ = case
    momentum, heat_content = reference.enhanced(particles, S, grid)
    plain = step(interpolator, grid, particles)
    got = step(interpolator, grid, plain.before, {"gradient_enhanced_projection": True})
    np.testing.assert_allclose(got.momentum, momentum, atol=1e-11)
    np.testing.assert_allclose((got.nodal.mass * got.nodal.temperature)[0], heat_content, atol=1e-9)
    for name in ("mass", "volume", "internal_force", "external_force", "heat"):
        np.testing.assert_array_equal(getattr(got.nodal, name), getattr(plain.nodal, name))


def test_gradients_make_the_projection_of_a_linear_field_exact():
    particles = random_particles(SPACE)
    A, b = np.random.default_rng(7).normal(size=(3, 3)), np.array([1.0, 2.0, 3.0])
    particles.velocity[:] = particles.position @ A.T + b
    particles.velocity_gradient[:] = A
    nodal = step(Gimp(), SPACE, particles, {"gradient_enhanced_projection": True}).nodal
    used = nodal.mass[0] > 1e-6
    np.testing.assert_allclose(nodal.velocity[0, used], SPACE.node_positions()[used] @ A.T + b, atol=1e-10)


def test_rigid_bodies_exert_no_internal_force():
    plain, rigid = (step(Gimp(), SPACE, random_particles(SPACE), rigid=r) for r in (False, True))
    assert (rigid.nodal.internal_force == 0.0).all()
    np.testing.assert_array_equal(rigid.momentum, plain.momentum)
    np.testing.assert_array_equal(rigid.nodal.external_force, plain.nodal.external_force)


def test_loads_spread_by_corners_are_left_to_others():
    node = SPACE.flat(2, 2, 1)

    def spread(body, forces):
        forces[node, 1] += 7.0

    force = step(Gimp(), SPACE, random_particles(SPACE), spread_corner_loads=spread).nodal.external_force[0]
    assert force[node, 1] == 7.0
    assert np.count_nonzero(force) == 1


def test_uniform_stress_exerts_no_force_inside_a_filled_body():
    particles = make_particles(SPACE, fill(SPACE.anchor, SPACE.upper, SPACING, (2, 2, 2)))
    particles.stress[:] = [[3.0, 1.0, 0.5], [1.0, -2.0, 0.3], [0.5, 0.3, 1.0]]
    force = SPACE.as_box(step(Gimp(), SPACE, particles).nodal.internal_force[0])
    assert abs(force[2:-2, 2:-2, 2:-2]).max() < 1e-13
    assert abs(force).max() > 0.01


def test_uniform_stress_in_a_body_of_revolution_is_in_balance_inside():
    """With equal radial and hoop stress a filled cylinder feels no net force between its surfaces."""
    positions = fill(DISK.anchor, DISK.upper, SPACING, (2, 2, 1))
    particles = make_particles(DISK, positions, (2, 2, 1))
    particles.volume[:] *= positions[:, 0]  # volume of a sector of one radian
    particles.stress[:] = np.diag([5.0, 2.0, 5.0])
    force = DISK.as_box(step(GimpAxisymmetric(), DISK, particles).nodal.internal_force[0])
    assert abs(force[2:-2, 2:-2]).max() < 1e-12
    assert abs(force).max() > 0.01


def test_empty_nodes_have_zero_velocity_and_temperature():
    nodal = step(Gimp(), SPACE, keep(random_particles(SPACE), np.array([5]))).nodal
    empty = nodal.mass[0] == EMPTY_MASS
    assert np.count_nonzero(~empty) <= 27
    assert (nodal.volume[0, empty] == EMPTY_MASS).all()
    assert (nodal.velocity[0, empty] == 0.0).all()
    assert (nodal.temperature[0, empty] == 0.0).all()


# ---- on the grid -----------------------------------------------------------------------------------------


def test_acceleration():
    """a = f / m - damping v + g; nodes no heavier than the least mass feel gravity alone, others nothing."""
    fields = new_nodal_fields(make_grid((1, 1, 0)), 1).of(0)
    fields.mass[:3] = [2.0, 0.5, 1e-3]
    random = np.random.default_rng(3)
    for name in ("internal_force", "external_force", "velocity"):
        getattr(fields, name)[:] = random.normal(size=fields.velocity.shape)
    gravity = (0.0, -9.81, 1.0)
    is_image = np.zeros(fields.mass.size, dtype=np.bool_)
    is_image[1] = True
    motion = nodes.Motion(gravity, 0.3, 0.5)
    sums = np.empty((1, 4))
    nodes.accelerate(np.arange(3, dtype=np.uintp), fields, motion, DT, is_image, 0, 1, sums)
    mass, *load = sums[0]
    np.testing.assert_allclose(mass, 2.001, rtol=1e-15)
    np.testing.assert_allclose(load, fields.external_force[[0, 2]].sum(axis=0), rtol=1e-14)
    expected = np.tile(gravity, (3, 1))
    force = fields.internal_force[0] + fields.external_force[0]
    expected[0] += force / 2.0 - 0.3 * fields.velocity[0]
    np.testing.assert_allclose(fields.acceleration[:3], expected, rtol=1e-14)
    np.testing.assert_allclose(fields.velocity_star[:3], fields.velocity[:3] + DT * expected, rtol=1e-14)
    assert not fields.velocity_star[3:].any()


def test_nodes_that_are_touched_are_listed_in_order():
    touched = np.zeros(32, dtype=np.uint8)
    wanted = [0, 7, 8, 15, 26]
    touched[[*wanted, 27, 31]] = 1
    active = np.zeros(27, dtype=np.uintp)
    count = nodes.list_touched(touched, touched.view(np.uint64), active)
    np.testing.assert_array_equal(active[:count], wanted)


def test_nodes_left_behind_become_empty():
    fields = new_nodal_fields(make_grid((1, 1, 0)), 1).of(0)
    empty = [field.copy() for field in fields]
    for field in fields:
        field[:] = 7.0
    touched = np.ones(fields.mass.size, dtype=np.uint8)
    active = np.arange(fields.mass.size, dtype=np.uintp)
    nodes.forget(active, touched, fields)
    assert all((field == 7.0).all() for field in fields)
    nodes.untouch(active[3:], touched)
    np.testing.assert_array_equal(np.flatnonzero(touched), [0, 1, 2])
    nodes.forget(active, touched, fields)
    for field, expected in zip(fields, empty, strict=True):
        np.testing.assert_array_equal(field[3:], expected[3:])
        assert (field[:3] == 7.0).all()


def test_only_nodes_that_particles_touch_take_part():
    """A particle that moves on leaves its old nodes as they were before; nodal results are those of all nodes."""
    results = []
    for whole in (False, True):
        body = make_body(random_particles(SPACE, count=3))
        body.particles.velocity[:] *= 20.0
        simulation = make_simulation(SPACE, [body], whole_grid=whole, gravity=(0.0, -9.81, 0.0))
        for _ in range(6):
            simulation.advance(DT)
        results.append((body.particles, simulation.nodal))
    for some, every in zip(results[0][0], results[1][0], strict=True):
        np.testing.assert_array_equal(some, every)
    for name in ("mass", "volume", "velocity", "internal_force", "external_force", "temperature", "heat"):
        np.testing.assert_array_equal(getattr(results[0][1], name), getattr(results[1][1], name))
    assert (results[0][1].velocity_star[0, results[0][1].mass[0] < 1e-100] == 0.0).all()


def test_materials_in_thermal_contact_reach_one_temperature_and_keep_their_heat():
    mass, temperature = np.array([[1.0, 2.0], [3.0, EMPTY_MASS]]), np.array([[300.0, 310.0], [400.0, 0.0]])
    heats, rate = np.array([2.0, 5.0]), np.zeros((2, 2))
    nodes.exchange_heat(mass, temperature, heats, DT, rate)
    after = temperature + DT * rate
    np.testing.assert_allclose(after[0], after[1])
    np.testing.assert_allclose(after[:, 0], (2 * 300 + 15 * 400) / 17)
    assert after[0, 1] == pytest.approx(310.0)
    np.testing.assert_allclose((heats * mass[:, 0]) @ rate[:, 0], 0.0, atol=1e-9)


def test_fastest_node():
    velocity = np.array([[3.0, 4.0, 0.0], [10.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    every, inner = np.arange(3, dtype=np.uintp), np.array([True, False, True])
    assert nodes.fastest_node(every, velocity, inner) == 25.0
    assert nodes.fastest_node(every[2:], velocity, inner) == 1.0
    assert nodes.fastest_node(every, velocity, np.zeros(3, dtype=np.bool_)) == 0.0


def test_images_add_to_their_owners_and_follow_them():
    sums, touched = np.arange(12.0).reshape(6, 2), np.array([0, 1, 1, 0, 0, 0], dtype=np.uint8)
    sums[[3, 4, 5]] = 0.0
    nodes.fold_images(sums, touched, np.array([0, 1, 4]), np.array([2, 3, 5]))
    np.testing.assert_array_equal(sums, [[4, 6], [2, 3], [4, 6], [2, 3], [0, 0], [0, 0]])
    np.testing.assert_array_equal(touched, [1, 1, 1, 1, 0, 0])
    nodes.copy_to_images(sums, touched, np.array([1, 0, 0]), np.array([2, 3, 4]))
    np.testing.assert_array_equal(sums, [[4, 6], [2, 3], [2, 3], [4, 6], [0, 0], [0, 0]])


# ---- grid to particles ------------------------------------------------------------------------------------


def drive(grid, seed=5):
    """Random v, v* and a at the nodes."""
    return np.random.default_rng(seed).normal(size=(3, grid.number_of_nodes, 3))


def test_particles_move_as_the_equations_of_flip_say(case):
    interpolator, grid, particles, axisymmetric, S, G = case
    _, velocity_star, acceleration = driven = drive(grid)
    got = step(interpolator, grid, particles, driven=driven)
    before, after = got.before, got.after
    x, v = reference.flip(before, S, velocity_star, acceleration, DT)
    np.testing.assert_allclose(after.position, x, atol=1e-12)
    np.testing.assert_allclose(after.velocity, v, atol=1e-12)
    np.testing.assert_allclose(after.displacement, x - before.position, atol=1e-12)
    np.testing.assert_array_equal(after.old_velocity, before.velocity)
    L = reference.velocity_gradient(velocity_star, G, axisymmetric)
    np.testing.assert_allclose(after.velocity_gradient, L, atol=1e-10)
    m = before.mass
    assert got.reductions["KineticEnergy", 0] == pytest.approx(0.5 * m @ (v**2).sum(axis=1))
    assert got.reductions["ThermalEnergy", 0] == pytest.approx(4.0 * m @ before.temperature)
    np.testing.assert_allclose(got.reductions["TotalMomentum", 0], m @ v, atol=1e-11)
    np.testing.assert_allclose(got.reductions["CenterOfMassPosition", 0], m @ x, atol=1e-11)


def test_particles_move_as_the_equations_of_xpic_say(case):
    interpolator, grid, particles, _, S, _ = case
    velocity, velocity_star, acceleration = driven = drive(grid)
    got = step(interpolator, grid, particles, {"XPIC2": True}, driven)
    x, v = reference.xpic2(got.before, S, velocity, velocity_star, acceleration, DT)
    np.testing.assert_allclose(got.after.velocity, v, atol=1e-11)
    np.testing.assert_allclose(got.after.position, x, atol=1e-12)
    np.testing.assert_array_equal(got.after.old_velocity, got.before.velocity)


def test_particles_take_the_rate_and_the_gradient_of_temperature(case):
    interpolator, grid, particles, _, S, G = case
    got = step(interpolator, grid, particles)
    nodal = got.nodal
    rate = nodal.heat[0] / nodal.mass[0]
    star = nodal.temperature[0] + DT * rate
    np.testing.assert_allclose(got.after.temperature_rate, S @ rate, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(
        got.after.temperature_gradient, np.einsum("n,pni->pi", star, G), rtol=1e-8, atol=1e-8
    )
    np.testing.assert_allclose(got.after.temperature, got.before.temperature + DT * S @ rate, rtol=1e-12)


def test_uniform_motion_of_the_nodes_has_no_gradient():
    uniform = np.tile([3.0, -1.0, 2.0], (SPACE.number_of_nodes, 1))
    got = step(Gimp(), SPACE, random_particles(SPACE), driven=(uniform, uniform, 0.0 * uniform))
    assert abs(got.after.velocity_gradient).max() < 1e-13
    np.testing.assert_allclose(
        got.after.displacement, np.tile([0.03, -0.01, 0.02], (len(got.after), 1)), atol=1e-15
    )


# ---- deformation -----------------------------------------------------------------------------------------

L_GENERAL = np.array([[0.4, -0.9, 0.2], [0.7, -0.3, 0.5], [-0.1, 0.6, 0.2]])


@kernel
def deform(F, L, dt, subcycles, new):
    """Enter F after a step."""
    put_tensor(new, 0, stress.new_deformation_gradient(tensor_at(F, 0), tensor_at(L, 0), dt, subcycles))


def deformed(F, L, dt, subcycles):
    new = np.empty((1, 3, 3))
    deform(F, L, dt, subcycles, new)
    return new


def after_steps(L, time, steps, subcycles, F=None):
    F = np.eye(3)[None] if F is None else F[None]
    for _ in range(steps):
        F = deformed(F, np.ascontiguousarray(L)[None], time / steps, subcycles)
    return F[0]


def test_one_subcycle_is_the_linear_step():
    np.testing.assert_allclose(after_steps(L_GENERAL, 0.1, 1, 1), np.eye(3) + 0.1 * L_GENERAL, rtol=1e-15)


@pytest.mark.parametrize("subcycles", [1, 5, 0, -1, -4])
def test_deformation_gradient_is_carried_along_from_the_left(subcycles):
    F = np.array([[1.2, 0.3, 0.0], [0.1, 0.9, 0.2], [0.0, 0.4, 1.1]])
    expected = after_steps(L_GENERAL, 0.1, 1, subcycles) @ F
    np.testing.assert_allclose(after_steps(L_GENERAL, 0.1, 1, subcycles, F), expected, atol=1e-15)


@pytest.mark.parametrize("terms", [1, 2, 3, 6])
def test_terms_of_the_exponential(terms):
    partial = sum(np.linalg.matrix_power(0.5 * L_GENERAL, k) / math.factorial(k) for k in range(terms + 1))
    np.testing.assert_allclose(after_steps(L_GENERAL, 0.5, 1, -terms), partial, atol=1e-14)


def test_no_terms_leave_the_deformation_as_it_is():
    np.testing.assert_array_equal(after_steps(L_GENERAL, 0.5, 1, 0), np.eye(3))


def test_simple_shear_is_exact():
    shear = np.array([[0.0, 2.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    for subcycles in (1, 7, -1, -3):
        np.testing.assert_allclose(after_steps(shear, 0.5, 3, subcycles), np.eye(3) + 0.5 * shear, atol=1e-14)


def test_steady_stretch_grows_exponentially():
    stretch = np.diag([0.8, -0.4, 0.1])
    np.testing.assert_allclose(
        after_steps(stretch, 1.0, 1, -20), np.diag(np.exp(np.diag(stretch))), rtol=1e-14
    )
    np.testing.assert_allclose(
        after_steps(stretch, 1.0, 1, 1000), np.diag(np.exp(np.diag(stretch))), rtol=1e-3
    )


@pytest.mark.parametrize(("subcycles", "order"), [(1, 1), (4, 1), (-1, 1), (-2, 2), (-3, 3)])
def test_rate_of_convergence_in_the_time_step(subcycles, order):
    exact = expm(L_GENERAL)
    errors = [np.linalg.norm(after_steps(L_GENERAL, 1.0, n, subcycles) - exact) for n in (40, 80)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.1)


def test_fast_deformation_makes_more_subcycles():
    """At |L| dt = 3.4 at least 6 = 2 int(3.4) parts are taken."""
    stretch = 3.4 * np.diag([1.0, 0.0, 0.0])
    assert after_steps(stretch, 1.0, 1, 1)[0, 0] == pytest.approx((1.0 + 3.4 / 6) ** 6)
    assert after_steps(stretch, 1.0, 1, 8)[0, 0] == pytest.approx((1.0 + 3.4 / 8) ** 8)


# ---- stresses --------------------------------------------------------------------------------------------

MODEL = elastic(10.0, 0.3)


def step_of(dt=DT):
    return Step(dt, 0.0, 1.0, False, 0.2, 2.0, False)


def update(particles, subcycles=1, stabilized=False, cells=None, cell_stretch=None, dt=DT):
    cells = np.zeros(0, np.int64) if cells is None else cells
    cell_stretch = np.zeros(0) if cell_stretch is None else cell_stretch
    kinematics = Kinematics(subcycles, stabilized)
    sums = np.empty((1, STRESS_SUMS))
    failure = new_failure(None, None, 0)
    loop = stress.StressLoop(
        MODEL, NoState(), failure, particles, MATERIAL, step_of(dt), kinematics, cells, cell_stretch
    )
    stress.update_stresses(loop, 0, 1, sums)
    return stress.total(sums)


def moving_particles(count=30, seed=2):
    particles = make_particles(SPACE, np.random.default_rng(seed).uniform(0.0, 1.0, (count, 3)))
    particles.velocity_gradient[:] = np.random.default_rng(seed).normal(size=(count, 3, 3))
    return particles


def test_volume_follows_the_deformation_and_stress_the_model():
    particles = moving_particles()
    volume, L = particles.volume.copy(), particles.velocity_gradient.copy()
    particles.old_velocity[:, 1] = -2.0
    sums = update(particles)
    F = np.eye(3) + DT * L
    np.testing.assert_allclose(particles.deformation_gradient, F, atol=1e-15)
    np.testing.assert_allclose(particles.volume, volume * np.linalg.det(F), rtol=1e-14)
    rate = (L + L.transpose(0, 2, 1)) / 2
    expected = DT * (
        2 * MODEL.G * rate
        + (MODEL.K - 2 / 3 * MODEL.G) * np.trace(rate, axis1=1, axis2=2)[:, None, None] * np.eye(3)
    )
    np.testing.assert_allclose(particles.stress, expected, atol=1e-13)
    assert sums.volume == pytest.approx(particles.volume.sum())
    assert sums.strain_energy == pytest.approx(
        np.einsum("p,pij,pij->", particles.volume, expected, rate) * DT / 2
    )
    speed = np.sqrt((MODEL.K + 4 / 3 * MODEL.G) * np.linalg.det(F) / MATERIAL.density).max()
    np.testing.assert_allclose(sums.wave_speed, (speed, speed + 2.0, speed), rtol=1e-13)
    assert sums.finite


def test_temperature_takes_the_rate_of_the_grid():
    particles = moving_particles()
    particles.temperature_rate[:] = 50.0
    update(particles)
    np.testing.assert_allclose(particles.temperature, MATERIAL.room_temperature + 50.0 * DT)
    assert (particles.previous_temperature == MATERIAL.room_temperature).all()
    assert (particles.heating_rate == 0.0).all()


@pytest.mark.parametrize("component", [0, 1, 2])
def test_positions_that_are_not_finite_are_noticed(component):
    particles = moving_particles()
    particles.position[7, component] = np.nan
    assert not update(particles).finite


def test_stresses_that_are_not_finite_are_noticed():
    particles = moving_particles()
    particles.stress[7, 1, 1] = np.inf
    assert not update(particles).finite


def test_pressure_stabilization_gives_every_particle_the_volume_change_of_its_cell():
    """Volumes stay; det F becomes sum V / sum (V / J) of the cell; the shape change of each F stays."""
    stabilized, plain = moving_particles(), moving_particles()
    cells = np.random.default_rng(4).integers(0, 3, 30)
    kinematics = Kinematics(1, True)
    volume, reference_volume = np.empty(4), np.empty(4)
    stress.cell_dilatation(stabilized, cells, kinematics, DT, volume, reference_volume)
    update(plain)
    J = np.linalg.det(plain.deformation_gradient)
    for cell in range(3):
        inside = cells == cell
        assert volume[cell] == pytest.approx(plain.volume[inside].sum())
        assert reference_volume[cell] == pytest.approx((plain.volume / J)[inside].sum())
    assert volume[3] == reference_volume[3] == 0.0
    stretch = np.divide(volume, reference_volume, out=np.ones(4), where=reference_volume > 0)
    update(stabilized, stabilized=True, cells=cells, cell_stretch=stretch)
    np.testing.assert_allclose(np.linalg.det(stabilized.deformation_gradient), stretch[cells], rtol=1e-13)
    np.testing.assert_array_equal(stabilized.volume, plain.volume)
    scaled = plain.deformation_gradient * np.cbrt(stretch[cells] / J)[:, None, None]
    np.testing.assert_allclose(stabilized.deformation_gradient, scaled, rtol=1e-12, atol=1e-15)
    added = np.log(stretch[cells] / J)[:, None, None] / (3 * DT) * np.eye(3)
    np.testing.assert_allclose(stabilized.velocity_gradient, plain.velocity_gradient + added, atol=1e-10)


# ---- particles that leave --------------------------------------------------------------------------------

BOX = make_grid((4, 3, 2), anchor=(10.0, 0.0, -1.0))
EVERYWHERE = np.ones(24, dtype=np.bool_)


def settled(positions, grid=BOX, owned=EVERYWHERE, least_mass=0.0, **values):
    particles = make_particles(grid, np.array(positions, dtype=float))
    for name, value in values.items():
        getattr(particles, name)[:] = value
    kept = np.empty(len(particles), dtype=np.bool_)
    sums = np.empty((1, 1))
    everywhere = bool(owned.all())
    space = settle.Space(grid.index, grid.cells, grid.periodic, owned, everywhere, least_mass)
    settle.settle(particles, space, kept, 0, 1, sums)
    lost = sums[0, 0]
    assert lost == np.count_nonzero(~kept)
    return kept, particles


@pytest.mark.parametrize(
    ("anchor", "spacing", "cells", "x"),
    [
        (-2.302132862361297, 0.6405920704482397, 13, 6.0255640534658195),
        (-2.302132862361297, 0.6405920704482397, 13, -10.629829778188414),
        (3.1327023920027237, 0.026362359173243803, 2, 3.079977673656236),
    ],
)
def test_particles_at_a_face_wrap_into_cells_of_the_domain(anchor, spacing, cells, x):
    """What is taken off is rounded too; a particle an ulp outside would belong to no cell of any rank."""
    grid = make_grid((cells, 3, 3), (spacing, 1.0, 1.0), (anchor, 0.0, 0.0), (0, 1, 1), (1, 0, 0))
    kept, particles = settled([(x, 1.5, 1.5)], grid, np.ones(9 * cells, dtype=np.bool_))
    assert kept.all()
    assert 0 <= grid.cell_of(particles.position)[0, 0] < cells


def test_particles_outside_the_domain_are_removed():
    inside = [(10.0, 0.0, -1.0), (13.999, 2.999, 0.999)]
    outside = [
        (9.999, 1, 0),
        (14.0, 1, 0),
        (12, -0.001, 0),
        (12, 3.0, 0),
        (12, 1, -1.001),
        (12, 1, 1.0),
        (1e30, 1, 0),
    ]
    kept, _ = settled(inside + outside)
    np.testing.assert_array_equal(kept, [True] * 2 + [False] * 7)


def test_eights_inside_stay_as_a_whole():
    positions = np.random.default_rng(8).uniform((10.0, 0.0, -1.0), (14.0, 3.0, 1.0), (29, 3))
    assert settled(positions)[0].all()
    positions[[9, 27], 1] = 3.0
    localized = np.zeros(29, np.int32)
    localized[20] = DELETE
    kept, _ = settled(positions, localized=localized)
    np.testing.assert_array_equal(np.flatnonzero(~kept), [9, 20, 27])


def test_particles_in_cells_of_no_patch_are_removed():
    owned = EVERYWHERE.copy()
    owned[1 + 4 * (2 + 3 * 1)] = False
    kept, _ = settled([(11.5, 2.5, 0.5), (11.5, 1.5, 0.5), (12.5, 2.5, 0.5), (11.5, 2.5, -0.5)], owned=owned)
    np.testing.assert_array_equal(kept, [False, True, True, True])


def test_failed_light_and_cold_particles_are_removed():
    inside = [(10.5, 0.5, 0.5)] * 4
    assert list(settled(inside, localized=[0, DELETE, 1, 2])[0]) == [True, False, True, True]
    assert list(settled(inside, least_mass=1.0, mass=[0.5, 1.0, 1.1, 9.0])[0]) == [False, False, True, True]
    assert list(settled(inside, temperature=[-1e-9, 0.0, 300.0, np.nan])[0]) == [False, True, True, False]


def test_periodic_directions_bring_particles_back():
    grid = make_grid((4, 3, 2), anchor=(10.0, 0.0, -1.0), periodic=(1, 0, 1))
    positions = [
        (9.75, 1, 0),
        (14.0, 1, 0),
        (22.5, 1, 0),
        (1.5, 1, 0),
        (12, 1, -1.25),
        (12, 1, 1.5),
        (12, 3.5, 0),
    ]
    kept, particles = settled(positions, grid)
    np.testing.assert_array_equal(kept, [True] * 6 + [False])
    np.testing.assert_allclose(particles.position[:6, 0], [13.75, 10.0, 10.5, 13.5, 12.0, 12.0])
    np.testing.assert_allclose(particles.position[:6, 2], [0.0, 0.0, 0.0, 0.0, 0.75, -0.5])


def test_a_particle_a_rounding_error_outside_a_periodic_face_is_brought_back():
    grid = make_grid((4, 3, 2), periodic=(1, 1, 1))
    kept, particles = settled([(-1e-18, 1.0, 1.0), (1.0, -1e-17, 1.0), (1.0, 1.0, -1e-300)], grid)
    assert kept.all()
    assert (grid.cell_of(particles.position) < grid.cells).all()


def test_initial_wave_speed():
    velocity, speed = np.array([[1.0, -5.0, 0.0], [-2.0, 0.0, 0.5]]), np.array([10.0, 12.0])
    assert settle.initial_wave_speed(velocity, speed) == (14.0, 15.0, 12.5)
    assert settle.initial_wave_speed(np.empty((0, 3)), np.empty(0)) == (1e-12,) * 3
