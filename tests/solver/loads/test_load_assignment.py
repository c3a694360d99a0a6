"""Which particles carry which curve, and what is said of doubtful loads."""

from __future__ import annotations

import numpy as np
import pytest
from load_cases import applied, body, carriers, curve, make_grid, total_force

from solver.geometry.box import Box
from solver.loads.curve import LoadCurve, TimePoint
from solver.loads.force import Force
from solver.loads.heat_flux import HeatFlux
from solver.loads.loads import Loads
from solver.loads.pressure import Pressure
from solver.loads.pressure_points import PressurePoints
from solver.loads.surface import LoadedSurface
from solver.particles import keep

CUBE = Box(min=(0.2, 0.2, 0.2), max=(0.5, 0.5, 0.5))
FACES = [
    Box(min=(0.49, 0.2, 0.2), max=(0.51, 0.5, 0.5)),
    Box(min=(0.2, 0.49, 0.2), max=(0.5, 0.51, 0.5)),
    Box(min=(0.2, 0.2, 0.49), max=(0.5, 0.5, 0.51)),
    Box(min=(0.2, 0.2, 0.19), max=(0.5, 0.5, 0.21)),
]


def pressure(face, load, number, **more):
    return Pressure(geom_object=LoadedSurface(FACES[face]), load_curve=curve(load, number, **more))


@pytest.mark.parametrize("numbers", [(1, 2, 3), (3, 1, 2), (70, 5, 900)])
def test_each_load_acts_on_its_own_surface_whatever_its_number(numbers):
    grid = make_grid()
    cube = body(CUBE, grid)
    loads = [pressure(face, 10.0 ** (face + 1), number) for face, number in enumerate(numbers)]
    acting = applied(loads, grid, cube)
    np.testing.assert_allclose(total_force(cube), [0.9, 9.0, 90.0], rtol=1e-12)
    assert acting.counts == dict.fromkeys(numbers, 36)


def test_numbers_that_uintah_would_mistake_are_noticed():
    grid = make_grid()
    heat = HeatFlux(geom_object=LoadedSurface(FACES[2]), load_curve=curve(1.0, 1))
    told = [n.message for n in Loads([heat, pressure(0, 1.0, 2)], grid).notices]
    assert len(told) == 2
    assert told[0].startswith("load curve 2 of this <pressure> is number 1")
    assert told[1].startswith("load curve 1 of this <heat_flux> is number 2")
    assert not Loads([pressure(0, 1.0, 1), pressure(1, 1.0, 2)], grid).notices


def test_heat_and_pressure_act_side_by_side():
    grid = make_grid()
    cube = body(CUBE, grid)
    heat = HeatFlux(geom_object=LoadedSurface(FACES[2]), load_curve=curve(5.0, 2))
    applied([heat, pressure(0, 1.0, 1)], grid, cube)
    assert total_force(cube)[0] == pytest.approx(0.09)
    assert cube.particles.external_heat_rate.sum() == pytest.approx(0.45)


def test_two_curves_with_one_number_are_an_error():
    with pytest.raises(ValueError, match="two loads have a load curve with id 4"):
        Loads([pressure(0, 1.0, 4), pressure(1, 1.0, 4)], make_grid())


def test_a_particle_on_an_edge_carries_both_curves_in_order():
    grid = make_grid()
    cube = body(CUBE, grid)
    applied([pressure(0, 1.0, 1), pressure(1, 1.0, 2)], grid, cube)
    edge = carriers(cube, 1) & carriers(cube, 2)
    assert edge.sum() == 6
    np.testing.assert_array_equal(cube.particles.load_curve[edge], [[1, 2, 0]] * 6)


def test_more_than_three_curves_on_a_particle_are_an_error():
    grid = make_grid()
    loads = [pressure(face, 1.0, face + 1) for face in range(3)]
    loads.append(Pressure(geom_object=LoadedSurface(FACES[0]), load_curve=curve(1.0, 4)))
    with pytest.raises(ValueError, match=r"would carry more than 3 load curves, the last with id 4"):
        applied(loads, grid, body(CUBE, grid))


def test_a_curve_for_one_material_leaves_the_others_alone():
    grid = make_grid()
    first, second = body(CUBE, grid), body(CUBE, grid)
    acting = applied([pressure(0, 2.0, 1, material=1)], grid, first, second)
    np.testing.assert_array_equal(total_force(first), 0.0)
    assert total_force(second)[0] == pytest.approx(0.18)
    assert acting.counts == {1: 36}


def test_without_a_material_all_share_the_force():
    grid = make_grid()
    first, second = body(CUBE, grid), body(CUBE, grid)
    applied([pressure(0, 2.0, 1)], grid, first, second)
    assert total_force(first)[0] == pytest.approx(0.09)
    assert total_force(second)[0] == pytest.approx(0.09)


def test_a_load_that_no_particle_carries_is_noticed_and_does_nothing():
    grid = make_grid()
    cube = body(CUBE, grid)
    far = Pressure(
        geom_object=LoadedSurface(Box(min=(0.8, 0.2, 0.2), max=(0.81, 0.5, 0.5))), load_curve=curve(1.0)
    )
    acting = applied([far], grid, cube)
    assert [n.load for n in acting.notices] == [far]
    assert acting.notices[0].message.startswith("load curve 1 acts on no particle: no surface particle")
    np.testing.assert_array_equal(total_force(cube), 0.0)


def test_a_late_start_and_a_surface_out_of_the_domain_are_noticed():
    grid = make_grid()
    late = LoadCurve(1, (TimePoint(2.0, 5.0), TimePoint(3.0, 6.0)))
    outside = LoadedSurface(Box(min=(0.99, 0.2, 0.2), max=(1.01, 0.5, 0.5)))
    told = [n.message for n in Loads([Pressure(geom_object=outside, load_curve=late)], grid).notices]
    assert "starts at time 2" in told[0]
    assert "reaches out of the domain" in told[1]


def test_what_a_particle_got_before_is_not_carried_over():
    grid = make_grid()
    cube = body(CUBE, grid)
    cube.particles.external_force[:] = 9.0
    cube.particles.external_heat_rate[:] = 9.0
    applied([], grid, cube)
    np.testing.assert_array_equal(cube.particles.external_force, 0.0)
    np.testing.assert_array_equal(cube.particles.external_heat_rate, 0.0)


def test_a_force_tag_has_no_effect_and_no_number():
    grid = make_grid()
    cube = body(CUBE, grid)
    force = Force(lower=(0.0, 0.0, 0.0), upper=(1.0, 1.0, 1.0), force_density=(1.0, 1.0, 1.0))
    acting = applied([force, pressure(0, 1.0, 1)], grid, cube)
    assert len(acting) == 1
    assert not acting.notices
    np.testing.assert_allclose(total_force(cube), [0.09, 0.0, 0.0], rtol=1e-12)


def test_a_resumed_run_shares_the_load_as_at_the_start():
    # Half of the loaded particles are gone: those left must not get more than before.
    grid = make_grid()
    cube = body(CUBE, grid)
    loads = [pressure(0, 1.0, 1)]
    start = applied(loads, grid, cube)
    left = keep(cube.particles, np.arange(len(cube.particles)) % 2 == 0)
    expected = left.external_force.copy()
    resumed = Loads(loads, grid)
    resumed.resume([left], start.counts)
    left.external_force[:] = 0.0
    resumed.apply(0.0, [left])
    np.testing.assert_array_equal(left.external_force, expected)
    assert expected.any()


def listed_points(normal):
    """A body whose first ten particles a file gave the curve 2, as a particle file would."""
    cube = body(CUBE, make_grid())
    cube.particles.load_curve[:10, 0] = 2
    cube.normal[:10] = normal
    return cube._replace(loadable=np.zeros(len(cube.particles), bool))


POINTS = PressurePoints(SurfaceArea=0.5, load_curve=curve(8.0, 2))


def test_listed_points_are_pressed_along_their_normals():
    cube = listed_points([0.0, 0.6, 0.8])
    acting = applied([POINTS, pressure(0, 1.0, 1)], make_grid(), cube)
    f = cube.particles.external_force
    np.testing.assert_allclose(f[:10], [[0.0, 0.24, 0.32]] * 10, rtol=1e-14)
    np.testing.assert_array_equal(f[10:], 0.0)
    assert acting.counts == {1: 0, 2: 10}


def test_normals_stay_with_their_particles_when_others_are_lost():
    cube = listed_points(np.arange(1.0, 31.0).reshape(10, 3))
    acting = applied([POINTS], make_grid(), cube)
    expected = cube.particles.external_force[[8, 3, 20]].copy()
    left = keep(cube.particles, np.array([8, 3, 20]))
    acting.apply(0.0, [left])
    np.testing.assert_array_equal(left.external_force, expected)
    assert expected[:2].all()


def test_listed_points_without_normals_are_an_error():
    with pytest.raises(ValueError, match=r"particles of material 0 .* must give p.normal"):
        applied([POINTS], make_grid(), listed_points([0.0, 0.0, 0.0]))
