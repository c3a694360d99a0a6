from __future__ import annotations

import math

import numpy as np
import pytest
from contact_scenes import block, make_grid, place

from solver.contact.approach import ApproachContact
from solver.contact.friction_bard import FrictionBard
from solver.contact.normals import SurfaceFields, surface_fields
from solver.nodal import EMPTY_MASS


def random_surface(s, seed=5):
    """Random unit normals, positions and tractions, given to a scene in place of those of its particles."""
    random = np.random.default_rng(seed)
    shape = s.nodal.velocity.shape
    normal = random.normal(size=shape)
    normal /= np.linalg.norm(normal, axis=2)[..., None]
    surface = SurfaceFields(normal, random.uniform(size=shape), random.normal(size=shape[:2]))
    s._shared[surface_fields] = surface
    return surface


def reference(s, velocity, surface, materials, mu, volume=0.0, separation=math.inf, pressed=True):
    """Coulomb friction node by node, written from the equations; returns the velocities."""
    result = velocity.copy()
    mass = s.nodal.mass
    for n in np.flatnonzero(s.owned_nodes):
        total = mass[materials, n].sum()
        if total <= 1e-14:
            continue
        filling = (8 * s.node_to_cell_weight[n] * s.nodal.volume[materials, n]).sum() / s.cell_volume
        if filling <= volume:
            continue
        common = mass[materials, n] @ velocity[materials, n] / total
        centre = mass[materials, n] @ surface.position[materials, n] / total
        for m in materials:
            own = mass[m, n]
            if own / total <= 1e-14 or total - own <= 1e-14:
                continue
            if np.linalg.norm(centre - surface.position[m, n]) * total / (total - own) >= separation:
                continue
            dv, normal = velocity[m, n] - common, surface.normal[m, n]
            w = dv @ normal
            if not (w > 0 or (pressed and surface.traction[m, n] < -1e-12)):
                continue
            slip = dv - w * normal
            speed = np.linalg.norm(slip)
            change = -w * normal - slip / speed * min(mu * abs(w), speed)
            strain = max(abs(change / s.grid.spacing)) * s.dt * max(1.0, own / (total - own))
            result[m, n] = velocity[m, n] + change * min(strain, 0.5) / strain
    return result


@pytest.mark.parametrize("part", [1, 2])
@pytest.mark.parametrize(
    ("materials", "parameters"),
    [
        ((), {"mu": 0.3}),
        ((0, 2), {"mu": 0.0}),
        ((0, 1), {"mu": 100.0}),
        ((), {"mu": 0.3, "volume_constraint": 1.6}),
        ((0, 1), {"mu": 0.3, "separation_factor": 1.2}),
    ],
)
@pytest.mark.parametrize("dt", [1e-3, 10.0])
def test_friction_agrees_with_its_equations(scene, part, materials, parameters, dt):
    s = scene(dt=dt)
    surface = random_surface(s)
    velocity = s.velocity(part)
    chosen = list(materials) or [0, 1, 2]
    expected = reference(
        s,
        velocity,
        surface,
        chosen,
        parameters["mu"],
        parameters.get("volume_constraint", 0.0),
        parameters.get("separation_factor", math.inf) * s.cell_volume ** (1 / 3),
    )
    assert not np.array_equal(expected, velocity)
    FrictionBard(materials=materials, **parameters).apply(part, s)
    np.testing.assert_allclose(velocity, expected, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("part", [1, 2])
def test_approach_contact_disregards_traction(scene, part):
    s = scene()
    surface = random_surface(s)
    velocity = s.velocity(part)
    expected = reference(s, velocity, surface, [0, 1, 2], 0.4, volume=0.8, pressed=False)
    assert not np.array_equal(expected, velocity)
    ApproachContact(mu=0.4, volume_constraint=0.8).apply(part, s)
    np.testing.assert_allclose(velocity, expected, rtol=1e-12, atol=1e-13)


def test_friction_with_one_step_acts_after_the_forces_only(scene):
    s = scene()
    random_surface(s)
    before = s.nodal.velocity.copy()
    FrictionBard(mu=0.3, OneOrTwoStep=1).apply(1, s)
    np.testing.assert_array_equal(s.nodal.velocity, before)


def two_blocks(scene, velocities, stress=0.0, **changes):
    """Block 0 below and block 1 above the plane z = 2, moving with the given velocities."""
    grid = make_grid((4, 4, 4), (1.0, 1.0, 1.0))
    blocks = [
        block(grid, (1, 1, 0), (3, 3, 2), stress=stress),
        block(grid, (1, 1, 2), (3, 3, 4), stress=stress),
    ]
    return place(scene(2, grid, particles=blocks, **changes), velocities)


def interface(s):
    return s.owned_nodes & (s.nodal.mass > 1e-3).all(axis=0)


def test_normals_of_touching_blocks_point_out_of_each_and_at_each_other(scene):
    s = two_blocks(scene, ((0, 0, 0), (0, 0, 0)), stress=-2.0)
    surface = s.once(surface_fields)
    middle = interface(s) & np.isclose(s.node_positions[:, :2], [1.0, 2.5]).all(axis=1)
    assert middle.sum() == 1
    np.testing.assert_allclose(surface.normal[0, middle], [[0, 0, 1]], atol=1e-14)
    np.testing.assert_allclose(surface.normal[1, middle], [[0, 0, -1]], atol=1e-14)
    assert (surface.traction[:, interface(s)] < 0.0).all()
    np.testing.assert_allclose(surface.normal[0, interface(s)], -surface.normal[1, interface(s)], atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(surface.normal[:, interface(s)], axis=2), 1.0)


def test_surface_fields_agree_with_sums_over_particles(scene):
    s = two_blocks(scene, ((0, 0, 0), (0, 0, 0)), stress=3.0, colinear_normals=False)
    surface = s.once(surface_fields)
    particles = s.particles[1]
    offset = particles.position[None] - s.node_positions[:, None]
    hat = np.maximum(0.0, 1.0 - np.abs(offset))
    slope = np.where(np.abs(offset) < 1.0, -np.sign(offset), 0.0)
    weights = hat.prod(axis=2)
    gradient = np.stack(
        [slope[..., a] * hat[..., (a + 1) % 3] * hat[..., (a + 2) % 3] for a in range(3)], axis=-1
    )
    normal = np.einsum("npk,p->nk", gradient, particles.mass)
    size = np.linalg.norm(normal, axis=1)
    shared = (s.nodal.mass > EMPTY_MASS).all(axis=0)
    held = shared & (size > 1e-8)
    np.testing.assert_allclose(surface.normal[1, held], normal[held] / size[held, None], atol=1e-12)
    massive = shared & (s.nodal.mass[1] > 1e-8)
    position = (weights @ (particles.mass[:, None] * particles.position)) / s.nodal.mass[1][:, None]
    np.testing.assert_allclose(surface.position[1, massive], position[massive], atol=1e-12)
    np.testing.assert_allclose(surface.traction[1, held], 3.0 * weights.sum(axis=1)[held], rtol=1e-12)


def test_axisymmetric_normals_weight_density_with_gradients_per_cell(scene):
    s = two_blocks(scene, ((0, 0, 0), (0, 0, 0)), axisymmetric=True, colinear_normals=False)
    s.particles[0].volume[:] *= np.linspace(1.0, 3.0, len(s.particles[0]))
    surface = s.once(surface_fields)
    assert (surface.normal[..., 2] == 0.0).all()
    particles = s.particles[0]
    offset = particles.position[None] - s.node_positions[:, None]
    hat = np.maximum(0.0, 1.0 - np.abs(offset))
    gradient_x = (
        np.where(np.abs(offset[..., 0]) < 1.0, -np.sign(offset[..., 0]), 0.0) * hat[..., 1] * hat[..., 2]
    )
    gradient_y = (
        np.where(np.abs(offset[..., 1]) < 1.0, -np.sign(offset[..., 1]), 0.0) * hat[..., 0] * hat[..., 2]
    )
    density = particles.mass / particles.volume
    normal = np.stack([gradient_x @ density, gradient_y @ density], axis=1)
    size = np.linalg.norm(normal, axis=1)
    held = (s.nodal.mass > EMPTY_MASS).all(axis=0) & (size > 1e-8)
    np.testing.assert_allclose(surface.normal[0, held, :2], normal[held] / size[held, None], atol=1e-12)


def test_symmetry_is_applied_to_normals_before_they_become_unit_vectors(scene):
    class NoZ:
        def apply_symmetry(self, vectors, material, touched=None):
            vectors[:, 2] = 0.0

    s = two_blocks(scene, ((0, 0, 0), (0, 0, 0)), boundary_conditions=NoZ(), colinear_normals=False)
    normal = s.once(surface_fields).normal
    assert (normal[..., 2] == 0.0).all()
    size = np.linalg.norm(normal, axis=2)
    assert (np.isclose(size, 1.0) | (size < 1e-15)).all()
    assert np.isclose(size, 1.0).any()


def test_nodes_of_one_material_have_no_surface(scene):
    s = two_blocks(scene, ((0, 0, 0), (0, 0, 0)), stress=1.0)
    surface = s.once(surface_fields)
    alone = ~(s.nodal.mass > EMPTY_MASS).all(axis=0)
    assert not surface.normal[:, alone].any()
    assert not surface.traction[:, alone].any()


def test_surface_fields_are_made_once_a_step(scene):
    s = two_blocks(scene, ((0, 0, 0), (0, 0, 0)))
    assert s.once(surface_fields) is s.once(surface_fields)


def test_periodic_images_count_for_the_nodes_they_repeat(scene):
    """A row of particles around a periodic seam has the same normal as one inside the domain."""
    normals = []
    for start in (1.0, 3.0):
        grid = make_grid((4, 4, 4), (1.0, 1.0, 1.0), periodic=(1, 0, 0))
        low = np.array(grid.anchor)
        particles = block(grid, (start, 1, 1), (start + 2, 2, 2))
        particles.position[:, 0] = low[0] + (particles.position[:, 0] - low[0]) % 4.0
        s = scene(2, grid, particles=[particles, particles], colinear_normals=False)
        s.nodal.mass[:] = 1.0
        fields = s.once(surface_fields)
        box = grid.as_box(fields.normal[0])[1:5, 1:, 1:]
        place = grid.as_box(fields.position[0])[1:5, 1:, 1:] - low
        normals.append((np.roll(box, -int(start), axis=0), np.roll(place[..., 1:], -int(start), axis=0)))
    np.testing.assert_allclose(normals[0][0], normals[1][0], atol=1e-12)
    np.testing.assert_allclose(normals[0][1], normals[1][1], atol=1e-12)


def test_mean_positions_at_a_periodic_seam_lie_beside_the_node(scene):
    grid = make_grid((4, 4, 4), (1.0, 1.0, 1.0), periodic=(1, 0, 0))
    low = np.array(grid.anchor)
    particles = block(grid, (3.5, 1, 1), (4.0, 2, 2))
    s = scene(2, grid, particles=[particles, particles])
    weight = (1.0 - 0.25) * particles.mass.sum() / 4.0
    s.nodal.mass[:] = weight
    seam = grid.flat(0, 1, 1)
    assert s.once(surface_fields).position[0, seam, 0] == pytest.approx(low[0] - 0.25)


@pytest.mark.parametrize("law", [FrictionBard(mu=0.3), ApproachContact(mu=0.3)])
def test_momentum_is_kept_and_energy_lost_when_blocks_collide_obliquely(scene, law):
    s = two_blocks(scene, ((1.0, 0.5, 2.0), (-0.5, 0.0, -1.0)))
    mass = s.nodal.mass[..., None]
    momentum, energy = (mass * s.nodal.velocity).sum(axis=0), (mass * s.nodal.velocity**2).sum()
    law.apply(1, s)
    np.testing.assert_allclose((mass * s.nodal.velocity).sum(axis=0), momentum, atol=1e-14)
    assert (mass * s.nodal.velocity**2).sum() < energy


def middle_node(s):
    return int(s.grid.flat(2, 2, 2))


def test_slip_beyond_coulombs_limit_is_reduced_by_mu_times_the_approach(scene):
    s = two_blocks(scene, ((5.0, 0.0, 1.0), (-5.0, 0.0, -1.0)))
    FrictionBard(mu=0.25).apply(1, s)
    n = middle_node(s)
    np.testing.assert_allclose(s.nodal.velocity[0, n], [5.0 - 0.25, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(s.nodal.velocity[1, n], [-5.0 + 0.25, 0.0, 0.0], atol=1e-12)


def test_slip_within_coulombs_limit_ends(scene):
    s = two_blocks(scene, ((0.2, 0.0, 1.0), (-0.2, 0.0, -1.0)))
    FrictionBard(mu=0.25).apply(1, s)
    np.testing.assert_allclose(s.nodal.velocity[:, middle_node(s)], 0.0, atol=1e-12)


def test_separating_blocks_are_left_alone(scene):
    s = two_blocks(scene, ((3.0, 0.0, -1.0), (0.0, 0.0, 1.0)))
    before = s.nodal.velocity.copy()
    FrictionBard(mu=0.25).apply(1, s)
    n = middle_node(s)
    np.testing.assert_array_equal(s.nodal.velocity[:, n], before[:, n])
    ApproachContact(mu=0.25).apply(1, s)
    np.testing.assert_array_equal(s.nodal.velocity[:, n], before[:, n])


def test_separating_blocks_that_press_on_each_other_are_held_by_friction_bard_only(scene):
    s = two_blocks(scene, ((0.0, 0.0, -1.0), (0.0, 0.0, 1.0)), stress=-1.0)
    before = s.nodal.velocity.copy()
    n = middle_node(s)
    ApproachContact(mu=0.25).apply(1, s)
    np.testing.assert_array_equal(s.nodal.velocity[:, n], before[:, n])
    FrictionBard(mu=0.25).apply(1, s)
    np.testing.assert_allclose(s.nodal.velocity[:, n], 0.0, atol=1e-12)


def test_axisymmetric_nodes_near_the_axis_have_smaller_cells(scene):
    s = scene(axisymmetric=True)
    random_surface(s)
    before = s.nodal.velocity.copy()
    s.node_positions[:, 0] = 1e-3
    FrictionBard(mu=0.3, volume_constraint=3.0).apply(1, s)
    filled = s.nodal.volume.sum(axis=0) > 3.0 * 1e-3 * s.grid.spacing[0] * s.grid.spacing[1]
    changed = (s.nodal.velocity != before).any(axis=(0, 2))
    assert changed.any()
    assert not changed[~filled].any()
