from __future__ import annotations

import numpy as np
import pytest
from load_cases import applied, body, carriers, curve, make_grid, total_force, total_moment

from solver.geometry.box import Box
from solver.geometry.cylinder import Cylinder
from solver.loads.surface import LoadedSurface
from solver.loads.torque import Torque

ROD = Cylinder(bottom=(0.5, 0.5, 0.1), top=(0.5, 0.5, 0.9), radius=0.4)


def torque(piece, load):
    return Torque(geom_object=LoadedSurface(piece), load_curve=curve(load))


@pytest.mark.parametrize("up", [True, False])
def test_the_moment_is_the_torque_against_the_axis(up):
    grid = make_grid()
    rod = body(ROD, grid)
    piece = ROD if up else Cylinder(bottom=ROD.top, top=ROD.bottom, radius=0.4)
    applied([torque(piece, -1.2e5)], grid, rod)
    axis = np.array([0.0, 0.0, 1.0 if up else -1.0])
    np.testing.assert_allclose(total_moment(rod, about=ROD.bottom), 1.2e5 * axis, rtol=1e-12, atol=1e-6)
    np.testing.assert_allclose(total_force(rod), 0.0, atol=1e-6)


def test_each_particle_gets_the_same_part_of_the_torque_along_the_circumference():
    grid = make_grid()
    rod = body(ROD, grid)
    acting = applied([torque(ROD, 10.0)], grid, rod)
    loaded = carriers(rod)
    arm = rod.particles.position[loaded] - np.array(ROD.bottom)
    arm[:, 2] = 0.0
    f = rod.particles.external_force[loaded]
    np.testing.assert_allclose(np.cross(arm, f)[:, 2], -10.0 / acting.counts[1], rtol=1e-12)
    np.testing.assert_allclose(np.einsum("pi,pi->p", arm, f), 0.0, atol=1e-12)
    radius = np.linalg.norm(arm, axis=1)
    assert (np.abs(radius - 0.4) <= 0.9 * 0.05).all()


def test_only_a_cylinder_can_be_turned():
    with pytest.raises(ValueError, match="<torque> acts on the surface of <cylinder>, not of <box>"):
        torque(Box(min=(0.0, 0.0, 0.0), max=(1.0, 1.0, 1.0)), 1.0)
