from __future__ import annotations

import math

import numpy as np
import pytest
from contact_scenes import block, make_grid, place
from scipy.optimize import minimize

from solver.contact.friction_lr import FrictionLR
from solver.contact.friction_lr_var import FrictionEntry, FrictionLRVar, VariableFriction
from solver.contact.logistic_regression import NO_ALPHA, touching_surfaces
from solver.contact.specified_friction import SpecifiedFriction


def two_bodies(scene, velocities=((0, 0, 0), (0, 0, 0)), tilt=0.0, gap=-0.05, **changes):
    """Body 0 below and body 1 above a plane through the middle of the domain, tilted about the y axis."""
    grid = make_grid((4, 4, 4), (1.0, 1.0, 1.0))
    low, high = block(grid, (0.5, 1, 0.5), (3.5, 3, 2)), block(grid, (0.5, 1, 2), (3.5, 3, 3))
    high.position[:, 2] += gap
    centre = np.array(grid.anchor) + 2.0
    turn = np.array([[math.cos(tilt), 0, math.sin(tilt)], [0, 1, 0], [-math.sin(tilt), 0, math.cos(tilt)]])
    for body in (low, high):
        body.position[:] = (body.position - centre) @ turn.T + centre
        body.deformation_gradient[:] = turn
    return place(scene(2, grid, particles=[low, high], **changes), velocities)


MIDDLE = (2, 2, 2)


def test_alpha_is_the_material_of_most_mass_where_two_meet(scene):
    s = two_bodies(scene)
    alpha = s.once(touching_surfaces).alpha
    shared = s.owned_nodes & (s.nodal.mass > 1e-3).all(axis=0)
    assert shared.any()
    np.testing.assert_array_equal(alpha[shared], np.argmax(s.nodal.mass, axis=0)[shared])
    assert (alpha[~shared] == NO_ALPHA).all()


def test_a_rigid_material_is_alpha_before_one_of_more_mass(scene):
    s = two_bodies(scene, rigid=(False, True))
    s.nodal.mass[0] *= 10.0
    alpha = s.once(touching_surfaces).alpha
    assert set(alpha) == {NO_ALPHA, 1}


def test_a_material_that_may_not_be_alpha_does_not_count(scene):
    s = two_bodies(scene, possible_alpha=(True, False))
    assert (s.once(touching_surfaces).alpha == NO_ALPHA).all()


@pytest.mark.parametrize("tilt", [0.0, 0.4, -1.0])
def test_normals_point_from_alpha_to_the_other_body_across_the_plane_between_them(scene, tilt):
    s = two_bodies(scene, tilt=tilt)
    surfaces = s.once(touching_surfaces)
    n = s.grid.flat(*MIDDLE)
    assert surfaces.alpha[n] != NO_ALPHA
    upwards = np.array([math.sin(tilt), 0.0, math.cos(tilt)])
    sign = 1.0 if surfaces.alpha[n] == 0 else -1.0
    np.testing.assert_allclose(surfaces.normal[n], sign * upwards, atol=0.05)
    np.testing.assert_allclose(np.linalg.norm(surfaces.normal[surfaces.alpha != NO_ALPHA], axis=1), 1.0)


def test_normals_minimise_the_penalised_misfit(scene):
    """The plane is that of a general minimiser where bodies interlock, so that the minimum is a mild one."""
    s = two_bodies(scene)
    random = np.random.default_rng(2)
    for body in s.particles:
        body.position[:] += random.uniform(-0.6, 0.6, body.position.shape)
    place(s, ((0, 0, 0), (0, 0, 0)))
    surfaces = s.once(touching_surfaces)
    n = s.grid.flat(*MIDDLE)
    node = s.node_positions[n]
    points, sides = [], []
    for m, body in enumerate(s.particles):
        near = (np.abs(body.position - node) < 1.0 - 1e-12).all(axis=1)
        points.append(body.position[near])
        sides.append(np.full(near.sum(), -1.0 if surfaces.alpha[n] == m else 1.0))
    x, c = np.concatenate(points), np.concatenate(sides)

    def misfit(phi):
        f = np.tanh(0.5 * (x @ phi[:3] + phi[3]))
        return ((c - f) ** 2).sum() + 1e-7 * (phi[:3] ** 2).sum()

    phi = minimize(misfit, np.zeros(4), method="BFGS", options={"gtol": 1e-9}).x[:3]
    np.testing.assert_allclose(surfaces.normal[n], phi / np.linalg.norm(phi), atol=2e-3)


def test_prominence_is_how_far_surface_particles_reach_along_the_normal(scene):
    s = two_bodies(scene, gap=0.125)
    surfaces = s.once(touching_surfaces)
    n = s.grid.flat(*MIDDLE)
    sign = 1.0 if surfaces.alpha[n] == 0 else -1.0
    normal = surfaces.normal[n]
    for m, body in enumerate(s.particles):
        near = (np.abs(body.position - s.node_positions[n]) < 1.0 - 1e-12).all(axis=1)
        along = body.position[near] @ normal
        reach = 0.25 * np.abs(normal).max()
        expected = (along + reach).max() if surfaces.alpha[n] == m else (along - reach).min()
        assert surfaces.prominence[m, n] == pytest.approx(expected, abs=1e-13)
    assert sign * (surfaces.prominence[1, n] - surfaces.prominence[0, n]) == pytest.approx(0.125, abs=1e-3)


def test_inner_particles_are_not_prominent(scene):
    s = two_bodies(scene)
    for body in s.particles:
        body.surface[:] = 0.0
    surfaces = s.once(touching_surfaces)
    assert np.isneginf(surfaces.prominence).all()


@pytest.mark.parametrize("part", [1, 2])
def test_slip_beyond_coulombs_limit_is_reduced_by_mu_times_the_approach(scene, part):
    s = two_bodies(scene, ((5.0, 0.0, 1.0), (-5.0, 0.0, -1.0)))
    FrictionLR(mu=0.25).apply(part, s)
    n = s.grid.flat(*MIDDLE)
    m0, m1 = s.nodal.mass[:, n]
    common = (m0 - m1) / (m0 + m1)
    velocity = s.velocity(part)[:, n]
    np.testing.assert_allclose(velocity[:, 2], common, atol=1e-6)
    np.testing.assert_allclose(velocity[0, 0], 5.0 - 0.25 * (1.0 - common), atol=1e-5)
    np.testing.assert_allclose(velocity[1, 0], -5.0 + 0.25 * (1.0 + common), atol=1e-5)


@pytest.mark.parametrize("mu", [0.0, 0.3, 50.0])
def test_momentum_is_kept_and_energy_lost(scene, mu):
    s = two_bodies(scene, ((1.0, 0.5, 2.0), (-0.5, 0.0, -1.0)), tilt=0.3)
    mass = s.nodal.mass[..., None]
    momentum, energy = (mass * s.nodal.velocity).sum(axis=0), (mass * s.nodal.velocity**2).sum()
    FrictionLR(mu=mu).apply(1, s)
    np.testing.assert_allclose((mass * s.nodal.velocity).sum(axis=0), momentum, atol=1e-13)
    assert (mass * s.nodal.velocity**2).sum() < energy


def test_three_bodies_agree_with_the_equations(scene):
    s = two_bodies(scene)
    other = block(s.grid, (0.5, 1, 2), (2, 3, 3))
    s = place(
        scene(3, s.grid, particles=[s.particles[0], s.particles[1], other]),
        ((0.3, 0.1, 1.0), (-0.1, 0.4, -0.5), (0.0, -1.0, -2.0)),
    )
    surfaces, mass = s.once(touching_surfaces), s.nodal.mass
    expected = s.nodal.velocity.copy()
    for n in np.flatnonzero(surfaces.alpha != NO_ALPHA):
        a = surfaces.alpha[n]
        common = mass[:, n] @ s.nodal.velocity[:, n] / mass[:, n].sum()
        for m in range(3):
            overlap = not surfaces.prominence[m, n] > surfaces.prominence[a, n]
            relative = expected[m, n] - common
            w = -relative @ surfaces.normal[n]
            if m == a or mass[m, n] <= 1e-16 or not overlap or w <= 0.0:
                continue
            slip = relative + w * surfaces.normal[n]
            speed = np.linalg.norm(slip)
            change = w * surfaces.normal[n] - slip / speed * min(0.2 * w, speed)
            expected[m, n] += change
            expected[a, n] -= change * mass[m, n] / mass[a, n]
    FrictionLR(mu=0.2).apply(1, s)
    assert not np.array_equal(expected[2], np.broadcast_to([0.0, -1.0, -2.0], expected[2].shape))
    np.testing.assert_allclose(s.nodal.velocity, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("velocities", "gap"), [(((0, 0, -1), (0, 0, 1)), 0.0), (((0, 0, 1), (0, 0, -1)), 0.125)]
)
def test_bodies_that_separate_or_do_not_overlap_are_left_alone(scene, velocities, gap):
    s = two_bodies(scene, velocities, gap=gap)
    n = s.grid.flat(*MIDDLE)
    before = s.nodal.velocity[:, n].copy()
    FrictionLR(mu=0.3).apply(1, s)
    np.testing.assert_array_equal(s.nodal.velocity[:, n], before)


def test_one_step_acts_after_the_forces_only(scene):
    s = two_bodies(scene, ((0, 0, 1), (0, 0, -1)))
    before = s.nodal.velocity.copy()
    FrictionLR(mu=0.3, OneOrTwoStep=1).apply(1, s)
    np.testing.assert_array_equal(s.nodal.velocity, before)


def test_the_normal_of_a_seam_is_that_of_the_interior(scene):
    """Bodies that meet across a periodic seam have the normal and prominence of bodies that meet inside."""
    found = []
    for shift in (0.0, 2.0):
        grid = make_grid((4, 4, 4), (1.0, 1.0, 1.0), periodic=(1, 0, 0))
        left, right = block(grid, (1, 1, 1), (2, 3, 3)), block(grid, (2, 1, 1), (3, 3, 3))
        for body in (left, right):
            body.position[:, 0] = grid.anchor[0] + (body.position[:, 0] - grid.anchor[0] + shift) % 4.0
        s = place(scene(2, grid, particles=[left, right], rigid=(True, False)), ((0, 0, 0), (0, 0, 0)))
        n = grid.flat(int(2 + shift) % 4, 2, 2)
        s.nodal.mass[:, n] = 1.0
        surfaces = s.once(touching_surfaces)
        assert surfaces.alpha[n] == 0
        found.append((surfaces.normal[n], surfaces.prominence[1, n] - surfaces.prominence[0, n]))
    np.testing.assert_allclose(found[0][0], [1.0, 0.0, 0.0], atol=1e-3)
    np.testing.assert_allclose(found[1][0], found[0][0], atol=1e-3)
    assert found[1][1] == pytest.approx(found[0][1], abs=1e-3)


def variable(**changes):
    table = VariableFriction(entry=(FrictionEntry(1.0, 0.1), FrictionEntry(3.0, 0.5)))
    return FrictionLRVar(**({"variable_friction": table, "master_material": 0} | changes))


@pytest.mark.parametrize(("color", "mu"), [(0.0, 0.1), (1.5, 0.2), (2.0, 0.3), (9.0, 0.5)])
def test_variable_friction_takes_mu_from_the_masters_colour(scene, color, mu):
    results = []
    for law in (variable(), FrictionLR(mu=mu)):
        s = two_bodies(scene, ((5.0, 0.0, 1.0), (-5.0, 0.0, -1.0)))
        s.particles[0].color[:] = color
        s.particles[1].color[:] = -7.0
        law.apply(1, s)
        results.append(s.nodal.velocity)
    np.testing.assert_allclose(results[0], results[1], atol=1e-13)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"master_material": 2}, "<master_material> 2 names no material"),
        ({"materials": (1,)}, "<master_material> 0 must be one of <materials>"),
        ({"variable_friction": VariableFriction()}, "needs at least two <entry>"),
        (
            {"variable_friction": VariableFriction(entry=(FrictionEntry(1.0, 0.1), FrictionEntry(1.0, 0.2)))},
            "colors of its entries must increase",
        ),
    ],
)
def test_bad_variable_friction_is_an_error(changes, message):
    with pytest.raises(ValueError, match=message):
        variable(**changes).check(2)
    variable().check(2)


@pytest.mark.parametrize("part", [1, 2])
def test_bodies_slide_on_a_rigid_master_that_gives_way_to_nothing(scene, part):
    s = two_bodies(scene, ((9.0, 9.0, 9.0), (2.0, 0.0, -1.0)), rigid=(True, False), xpic2=part == 1)
    law = SpecifiedFriction(materials=(0, 1), mu=0.5, stop_time=-1.0, velocity_after_stop=(0.0, 0.0, 1.0))
    law.apply(part, s)
    velocity, n = s.velocity(part), s.grid.flat(*MIDDLE)
    has_master = s.owned_nodes & (s.nodal.mass[0] > 1e-99)
    np.testing.assert_array_equal(
        velocity[0, has_master], np.broadcast_to([0.0, 0.0, 1.0], (has_master.sum(), 3))
    )
    np.testing.assert_allclose(velocity[1, n], [2.0 - 0.5 * 2.0, 0.0, 1.0], atol=1e-6)
    assert (("RigidReactionForce", -1) in s.reductions) == (part == 2)


def test_reactions_come_from_the_nodes_where_the_master_is_touched(scene):
    s = two_bodies(scene, ((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)), rigid=(True, False))
    before = s.nodal.velocity_star.copy()
    SpecifiedFriction(materials=(0, 1), mu=0.0).apply(2, s)
    change = s.nodal.velocity_star[1] - before[1]
    touched = (change != 0.0).any(axis=1)
    assert touched.any()
    force = -s.nodal.internal_force[1, touched].sum(axis=0)
    transmitted = -(s.nodal.mass[1, :, None] * change).sum(axis=0) / s.dt
    np.testing.assert_allclose(s.reductions["RigidReactionForce", -1], force)
    np.testing.assert_allclose(s.reductions["RigidReactionForce", 1], force)
    np.testing.assert_allclose(s.reductions["SumTransmittedForce", -1], transmitted)


def test_where_an_excluded_material_is_nothing_slides(scene):
    s = two_bodies(scene, ((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)), rigid=(True, False))
    before = s.nodal.velocity_star.copy()
    SpecifiedFriction(materials=(0, 1), mu=0.0, ExcludeMaterial=1).apply(2, s)
    np.testing.assert_array_equal(s.nodal.velocity_star, before)


def test_laws_with_logistic_regression_need_surface_particles():
    assert FrictionLR.needs_surface
    assert FrictionLRVar.needs_surface
    assert SpecifiedFriction.needs_surface
