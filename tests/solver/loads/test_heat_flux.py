from __future__ import annotations

import math

import numpy as np
import pytest
from load_cases import applied, body, carriers, curve, make_grid

from solver.geometry.box import Box
from solver.geometry.cylinder import Cylinder
from solver.geometry.sphere import Sphere
from solver.loads.heat_flux import HeatFlux
from solver.loads.surface import LoadedSurface

CUBE = Box(min=(0.2, 0.2, 0.2), max=(0.5, 0.5, 0.5))
ROD = Cylinder(bottom=(0.5, 0.5, 0.1), top=(0.5, 0.5, 0.9), radius=0.4, cylinder_end=True)
BALL = Sphere(origin=(0.5, 0.5, 0.5), radius=0.3)


def flux(piece, load=1.0e7):
    return HeatFlux(geom_object=LoadedSurface(piece), load_curve=curve(load))


@pytest.mark.parametrize(
    ("shape", "surface", "area"),
    [
        (CUBE, Box(min=(0.2, 0.49, 0.2), max=(0.5, 0.51, 0.5)), 0.09),
        (ROD, ROD, 2.0 * math.pi * 0.4 * 0.8),
        (BALL, BALL, 4.0 * math.pi * 0.09),
    ],
)
def test_the_rate_of_heat_is_the_flux_times_the_area(shape, surface, area):
    grid = make_grid()
    solid = body(shape, grid)
    applied([flux(surface)], grid, solid)
    rate = solid.particles.external_heat_rate
    assert rate.sum() == pytest.approx(1.0e7 * area, rel=1e-12)
    assert np.ptp(rate[carriers(solid)]) == 0.0
    np.testing.assert_array_equal(solid.particles.external_force, 0.0)


def test_a_box_heats_particles_within_a_spacing_in_every_direction():
    grid = make_grid()
    cube = body(CUBE, grid)
    applied([flux(Box(min=(0.31, 0.49, 0.31), max=(0.39, 0.51, 0.39)))], grid, cube)
    x = cube.particles.position
    near = (np.abs(x[:, 0] - 0.35) <= 0.09) & (np.abs(x[:, 2] - 0.35) <= 0.09) & (x[:, 1] > 0.44)
    np.testing.assert_array_equal(carriers(cube), near & (cube.particles.surface == 1.0))
