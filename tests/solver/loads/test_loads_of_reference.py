"""Load curves and forces of particles against an archive of Uintah's sus."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from load_cases import STEEL, applied, make_grid

from solver.creation import GeometryObject, ParticleIds, create_particles
from solver.geometry.cylinder import Cylinder
from solver.geometry.difference import Difference
from solver.loads.curve import LoadCurve, TimePoint
from solver.loads.pressure import Pressure
from solver.loads.surface import LoadedSurface

PARTICLES = Path(__file__).parents[4] / "shared" / "reference" / "thick_cylinder" / "particles.npz"


def cylinder(radius):
    return Cylinder(bottom=(0.0, 0.0, 0.0), top=(0.0, 0.0, 0.02), radius=radius)


def ramp(number, load):
    return LoadCurve(number, (TimePoint(0.0, 0.0), TimePoint(1.0e-5, load)))


@pytest.mark.skipif(not PARTICLES.is_file(), reason="the reference runs are not here")
def test_thick_cylinder_has_the_curves_and_forces_of_sus():
    saved = np.load(PARTICLES)
    grid = make_grid(cells=(48, 48, 1), spacing=(0.025, 0.025, 0.02))
    shape = GeometryObject(
        pieces=(Difference(pieces=(cylinder(1.0), cylinder(0.5))),),
        res=(2, 2, 1),
        velocity=(0.0, 0.0, 0.0),
        temperature=300.0,
    )
    pipe = create_particles([shape], grid, STEEL, ParticleIds(grid), find_surface=True)
    loads = [
        Pressure(geom_object=LoadedSurface(cylinder(0.5)), load_curve=ramp(1, 1.0e9)),
        Pressure(geom_object=LoadedSurface(cylinder(1.0)), load_curve=ramp(2, 101325.0)),
    ]
    applied(loads, grid, pipe, time=2.0e-4)
    ours = {int(i): p for p, i in enumerate(pipe.particles.id)}
    same = [ours[int(i)] for i in saved["t00001/0/p.particleID"]]
    np.testing.assert_array_equal(pipe.particles.load_curve[same], saved["t00001/0/p.loadCurveID"])
    np.testing.assert_allclose(
        np.linalg.norm(pipe.particles.external_force[same], axis=1),
        np.linalg.norm(saved["t00300/0/p.externalforce"], axis=1),
        rtol=1e-12,
    )
