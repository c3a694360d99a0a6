"""Loads that go to the grid from the corners of the particles' faces (CBDI)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from load_cases import applied, body, carriers, curve, make_grid

from solver.geometry.box import Box
from solver.geometry.cylinder import Cylinder
from solver.loads.loads import Loads
from solver.loads.pressure import Pressure
from solver.loads.surface import LoadedSurface
from solver.loads.torque import Torque

CUBE = Box(min=(0.2, 0.2, 0.2), max=(0.5, 0.5, 0.5))
RIGHT = Box(min=(0.49, 0.2, 0.2), max=(0.51, 0.5, 0.5))
LEFT = Box(min=(0.19, 0.2, 0.2), max=(0.21, 0.5, 0.5))
TOP = Box(min=(0.2, 0.2, 0.49), max=(0.5, 0.5, 0.51))


def pressure(surface, load=1.0e4, number=1, outward=True):
    return Pressure(
        geom_object=LoadedSurface(surface), load_curve=curve(load, number), outward_normal=outward
    )


def on_grid(acting, creation, grid):
    nodal = np.zeros((grid.number_of_nodes, 3))
    acting.scatter_corner_forces(0, creation.particles, grid, nodal)
    return nodal


def moment(nodal, grid):
    return np.cross(grid.node_positions(), nodal).sum(axis=0)


@pytest.mark.parametrize(
    ("surface", "outward", "centre"),
    [(RIGHT, True, [0.5, 0.35, 0.35]), (LEFT, False, [0.2, 0.35, 0.35])],
)
def test_the_force_acts_in_the_plane_of_the_face(surface, outward, centre):
    grid = make_grid()
    cube = body(CUBE, grid)
    nodal = on_grid(applied([pressure(surface, outward=outward)], grid, cube, on_corners=True), cube, grid)
    force = np.array([1.0e4 * 0.09, 0.0, 0.0])
    np.testing.assert_allclose(nodal.sum(axis=0), force, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(moment(nodal, grid), np.cross(centre, force), rtol=1e-12, atol=1e-9)


def test_external_force_is_that_of_a_corner():
    grid = make_grid()
    cube = body(CUBE, grid)
    applied([pressure(RIGHT)], grid, cube, on_corners=True)
    np.testing.assert_allclose(cube.particles.external_force[carriers(cube)], [[6.25, 0.0, 0.0]] * 36)


def test_the_force_grows_with_the_area_of_the_face_and_the_stretch_of_the_particle():
    grid = make_grid()
    cube = body(CUBE, grid)
    cube.particles.deformation_gradient[:] = np.diag([1.4, 1.5, 1.2])
    nodal = on_grid(applied([pressure(RIGHT)], grid, cube, on_corners=True), cube, grid)
    force = np.array([1.0e4 * 0.09 * 1.5 * 1.2, 0.0, 0.0])
    centre = [0.475 + 1.4 * 0.025, 0.35, 0.35]
    np.testing.assert_allclose(nodal.sum(axis=0), force, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(moment(nodal, grid), np.cross(centre, force), rtol=1e-12, atol=1e-9)


def reference(particles, spacing, count, load, outward):
    """Force on the corners and their positions, particle by particle, for the rod of the next test."""
    forces, corners = [], []
    for x, F, size in zip(particles.position, particles.deformation_gradient, particles.size, strict=True):
        arm = x - np.array([0.5, 0.5, 0.0])
        arm[2] = 0.0
        normal = arm / np.linalg.norm(arm)
        edges = np.diag(spacing) @ F @ size
        cosines = normal @ edges / np.linalg.norm(edges, axis=0)
        i = int(np.argmax(np.abs(cosines)))
        out = edges[:, i] * np.sign(cosines[i]) * (1.0 if outward else -1.0)
        a, b = edges[:, (i + 1) % 3], edges[:, (i + 2) % 3]
        # The particles and cells of the test are cubes, so cell units scale both areas alike.
        initial = np.diag(spacing) @ size
        ratio = np.linalg.norm(np.cross(a, b)) / np.linalg.norm(
            np.cross(initial[:, (i + 1) % 3], initial[:, (i + 2) % 3])
        )
        R = np.linalg.svd(F)
        forces.append(0.25 * ratio * load / count * (R[0] @ R[2] @ normal))
        corners.append([x + 0.5 * (out + s * a + t * b) for s in (-1, 1) for t in (-1, 1)])
    return np.array(forces), np.array(corners)


@pytest.mark.parametrize("outward", [True, False])
def test_deformed_particles_around_a_rod_agree_with_a_plain_reference(outward):
    random = np.random.default_rng(3)
    grid = make_grid()
    side = Cylinder(bottom=(0.5, 0.5, 0.2), top=(0.5, 0.5, 0.6), radius=0.3)
    rod = body(side, grid)
    particles = rod.particles
    particles.deformation_gradient[:] = np.eye(3) + 0.05 * random.normal(size=(len(particles), 3, 3))
    load = pressure(side, load=-3.0e3, outward=outward)
    acting = applied([load], grid, rod, on_corners=True, follow_rotation=True)
    nodal = on_grid(acting, rod, grid)
    f, corners = reference(particles, grid.spacing, acting.counts[1], -3.0e3 * load.area, outward)
    loaded = carriers(rod)
    np.testing.assert_allclose(
        particles.external_force[loaded], f[loaded], rtol=2e-8, atol=2e-8
    )  # R is that exact
    expected = np.cross(corners[loaded], f[loaded][:, None, :]).sum(axis=(0, 1))
    np.testing.assert_allclose(nodal.sum(axis=0), 4.0 * f[loaded].sum(axis=0), rtol=2e-8, atol=1e-6)
    np.testing.assert_allclose(moment(nodal, grid), expected, rtol=2e-8, atol=1e-6)


def test_a_particle_under_two_loads_gives_each_from_its_own_face():
    grid = make_grid()
    cube = body(CUBE, grid)
    loads = [pressure(RIGHT), pressure(TOP, number=2)]
    nodal = on_grid(applied(loads, grid, cube, on_corners=True), cube, grid)
    p = 1.0e4 * 0.09
    np.testing.assert_allclose(nodal.sum(axis=0), [p, 0.0, p], rtol=1e-12, atol=1e-9)
    expected = np.cross([0.5, 0.35, 0.35], [p, 0.0, 0.0]) + np.cross([0.35, 0.35, 0.5], [0.0, 0.0, p])
    np.testing.assert_allclose(moment(nodal, grid), expected, rtol=1e-12, atol=1e-9)


def test_corners_out_of_the_grid_lose_their_part():
    grid = make_grid(cells=(5, 10, 10))
    cube = body(CUBE, grid)
    cube.particles.deformation_gradient[:] = np.diag([10.0, 1.0, 1.0])
    nodal = on_grid(applied([pressure(RIGHT)], grid, cube, on_corners=True), cube, grid)
    np.testing.assert_array_equal(nodal, 0.0)


def test_corners_on_the_last_nodes_lose_nothing():
    grid = replace(make_grid(cells=(10, 10, 1)), extra_cells=(1, 1, 0))
    slab = body(Box(min=(0.2, 0.2, 0.0), max=(0.5, 0.5, 0.1)), grid, res=(2, 2, 1))
    load = pressure(Box(min=(0.49, 0.2, 0.0), max=(0.51, 0.5, 0.1)))
    nodal = on_grid(applied([load], grid, slab, on_corners=True), slab, grid)
    np.testing.assert_allclose(nodal.sum(axis=0), [1.0e4 * 0.03, 0.0, 0.0], rtol=1e-12, atol=1e-9)


def test_outward_normal_is_asked_for():
    load = Pressure(geom_object=LoadedSurface(RIGHT), load_curve=curve(1.0, 6))
    turn = Torque(
        geom_object=LoadedSurface(Cylinder(bottom=(0.5, 0.5, 0.1), top=(0.5, 0.5, 0.9), radius=0.4)),
        load_curve=curve(1.0, 7),
    )
    for lacking, words in ((load, "<pressure> with load curve 6"), (turn, "<torque> with load curve 7")):
        with pytest.raises(ValueError, match=words + " needs <outward_normal>"):
            Loads([lacking], make_grid(), on_corners=True)
        Loads([lacking], make_grid())
