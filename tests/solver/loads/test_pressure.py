"""Total force and direction of pressures on every kind of surface, against p A."""

from __future__ import annotations

import math

import numpy as np
import pytest
from load_cases import applied, body, carriers, curve, make_grid, total_force

from solver.geometry.box import Box
from solver.geometry.cone import Cone
from solver.geometry.cylinder import Cylinder
from solver.geometry.sphere import Sphere
from solver.loads.curve import LoadCurve, TimePoint
from solver.loads.pressure import Pressure
from solver.loads.surface import LoadedSurface


def pressure(piece, load=3.0e5, **more):
    return Pressure(geom_object=LoadedSurface(piece), load_curve=curve(load), **more)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_on_a_box_the_force_is_p_times_the_face_along_the_thin_axis(axis):
    grid = make_grid(cells=(10, 8, 6))
    cube = body(Box(min=(0.2, 0.2, 0.2), max=(0.5, 0.5, 0.5)), grid)
    low, high = [0.2, 0.2, 0.2], [0.5, 0.5, 0.5]
    low[axis], high[axis] = 0.49, 0.51
    load = pressure(Box(min=tuple(low), max=tuple(high)))
    applied([load], grid, cube)
    expected = np.zeros(3)
    expected[axis] = 3.0e5 * 0.3 * 0.3
    np.testing.assert_allclose(total_force(cube), expected, rtol=1e-12)
    loaded = carriers(cube)
    assert loaded.sum() == 36
    assert (cube.particles.position[loaded, axis] > 0.45).all()
    np.testing.assert_array_equal(cube.particles.external_force[~loaded], 0.0)


def test_the_force_follows_the_ramp():
    grid = make_grid()
    cube = body(Box(min=(0.2, 0.2, 0.2), max=(0.5, 0.5, 0.5)), grid)
    face = Box(min=(0.49, 0.2, 0.2), max=(0.51, 0.5, 0.5))
    ramp = LoadCurve(1, (TimePoint(0.0, 0.0), TimePoint(2.0, 100.0), TimePoint(3.0, -50.0)))
    acting = applied([Pressure(geom_object=LoadedSurface(face), load_curve=ramp)], grid, cube)
    for time, p in [(0.0, 0.0), (0.7, 35.0), (2.5, 25.0), (8.0, -50.0)]:
        acting.apply(time, [cube.particles])
        np.testing.assert_allclose(total_force(cube), [p * 0.09, 0.0, 0.0], rtol=1e-12, atol=1e-12)


def quarter_ring(grid):
    """A pipe about z, the part at x > 0 and y > 0 of which the grid holds; the rest is outside."""
    return body(Cylinder(bottom=(0.5, 0.5, 0.0), top=(0.5, 0.5, 0.4), radius=0.4), grid, res=(4, 4, 2))


def test_on_the_side_of_a_cylinder_the_force_points_away_from_the_axis():
    grid = make_grid(cells=(10, 10, 5))
    rod = quarter_ring(grid)
    load = pressure(Cylinder(bottom=(0.5, 0.5, 0.0), top=(0.5, 0.5, 0.4), radius=0.4), load=-2.0e6)
    applied([load], grid, rod)
    f, loaded = rod.particles.external_force, carriers(rod)
    arm = rod.particles.position[loaded] - np.array([0.5, 0.5, 0.0])
    arm[:, 2] = 0.0
    radius = np.linalg.norm(arm, axis=1)
    assert (np.abs(radius - 0.4) <= 1.2 * 0.025).all()
    outward = np.einsum("pi,pi->p", f[loaded], arm / radius[:, None])
    assert outward.sum() == pytest.approx(-2.0e6 * 2.0 * math.pi * 0.4 * 0.4, rel=1e-12)
    np.testing.assert_allclose(f[loaded], outward[:, None] * arm / radius[:, None], rtol=1e-12, atol=1e-6)


def test_on_the_end_of_a_cylinder_the_force_is_p_pi_r_squared_along_the_axis():
    grid = make_grid(cells=(10, 10, 5))
    rod = quarter_ring(grid)
    end = Cylinder(bottom=(0.5, 0.5, 0.399), top=(0.5, 0.5, 0.401), radius=0.4, cylinder_end=True)
    applied([pressure(end, load=-1.0e5)], grid, rod)
    np.testing.assert_allclose(total_force(rod), [0.0, 0.0, -1.0e5 * math.pi * 0.16], rtol=1e-12)
    assert (rod.particles.position[carriers(rod), 2] > 0.35).all()


def test_on_a_sphere_the_force_points_away_from_the_centre():
    grid = make_grid()
    centre = np.array([0.5, 0.5, 0.5])
    ball = body(Sphere(origin=(0.5, 0.5, 0.5), radius=0.3), grid)
    applied([pressure(Sphere(origin=(0.5, 0.5, 0.5), radius=0.3), load=7.0)], grid, ball)
    f = ball.particles.external_force
    arm = ball.particles.position - centre
    outward = np.einsum("pi,pi->p", f, arm) / np.linalg.norm(arm, axis=1)
    assert outward.sum() == pytest.approx(7.0 * 4.0 * math.pi * 0.09, rel=1e-12)
    np.testing.assert_allclose(np.linalg.norm(f, axis=1), np.abs(outward), rtol=1e-12)


def test_on_an_axisymmetric_end_the_force_is_that_of_one_radian():
    # Sum over particles of p r dr, by the midpoint rule exact for the linear integrand: p R^2 / 2.
    grid = make_grid(cells=(10, 10, 1))
    disk = body(Box(min=(0.0, 0.2, 0.0), max=(0.5, 0.6, 0.1)), grid, res=(2, 2, 1), axisymmetric=True)
    end = Cylinder(bottom=(0.0, 0.599, 0.0), top=(0.0, 0.601, 0.0), radius=0.5, axisymmetric_end=True)
    load = pressure(end, load=-1.0e7, res=(2, 2, 1))
    applied([load], grid, disk)
    assert load.area == pytest.approx(0.125)
    np.testing.assert_allclose(total_force(disk), [0.0, -1.0e7 * 0.125, 0.0], rtol=1e-12)
    assert carriers(disk).sum() == 10


def test_on_an_axisymmetric_side_the_force_is_that_of_one_radian():
    grid = make_grid(cells=(10, 10, 1))
    disk = body(Box(min=(0.0, 0.2, 0.0), max=(0.5, 0.6, 0.1)), grid, res=(2, 2, 1), axisymmetric=True)
    side = Cylinder(bottom=(0.0, 0.2, 0.0), top=(0.0, 0.6, 0.0), radius=0.5, axisymmetric_side=True)
    applied([pressure(side, load=-1.0e7)], grid, disk)
    radial = np.linalg.norm(disk.particles.external_force[:, [0, 2]], axis=1)
    assert radial.sum() == pytest.approx(1.0e7 * 0.5 * 0.4, rel=1e-12)
    assert np.abs(disk.particles.external_force[:, 1]).max() < 1e-9


def test_only_surface_particles_are_loaded():
    grid = make_grid()
    cube = body(Box(min=(0.2, 0.2, 0.2), max=(0.5, 0.5, 0.5)), grid)
    inside = Box(min=(0.34, 0.2, 0.2), max=(0.36, 0.5, 0.5))
    acting = applied([pressure(inside)], grid, cube)
    assert (cube.particles.surface[carriers(cube)] == 1.0).all()
    assert acting.counts == {1: 2 * (36 - 16)}


def test_a_pressure_turns_with_the_particle_if_asked():
    # F = R U with R a quarter turn about z: the force along x becomes one along y; U has no effect.
    grid = make_grid()
    face = Box(min=(0.49, 0.2, 0.2), max=(0.51, 0.5, 0.5))
    cube = body(Box(min=(0.2, 0.2, 0.2), max=(0.5, 0.5, 0.5)), grid)
    R = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    cube.particles.deformation_gradient[:] = R @ np.array([[1.3, 0.1, 0.0], [0.1, 0.9, 0.0], [0.0, 0.0, 1.1]])
    applied([pressure(face)], grid, cube, follow_rotation=True)
    np.testing.assert_allclose(total_force(cube), [0.0, 3.0e5 * 0.09, 0.0], rtol=2e-8, atol=1e-3)


def test_an_axisymmetric_end_needs_res():
    end = Cylinder(bottom=(0.0, 0.0, 0.0), top=(0.0, 0.1, 0.0), radius=0.5, axisymmetric_end=True)
    with pytest.raises(ValueError, match="needs <res>"):
        pressure(end)


def test_a_cone_cannot_be_loaded():
    cone = Cone(bottom=(0.0, 0.0, 0.0), top=(0.0, 0.0, 1.0), bottom_radius=1.0, top_radius=0.5)
    with pytest.raises(ValueError, match="<box> or <cylinder> or <sphere>, not of <cone>"):
        pressure(cone)
