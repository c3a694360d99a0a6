"""Loads against what Uintah's sus made of them: saved forces, and the momentum and heat they bring."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from load_cases import STEEL, applied, make_grid

from solver.creation import GeometryObject, ParticleIds, create_particles
from solver.geometry.box import Box
from solver.geometry.cylinder import Cylinder
from solver.geometry.difference import Difference
from solver.loads.curve import LoadCurve, TimePoint
from solver.loads.heat_flux import HeatFlux
from solver.loads.pressure import Pressure
from solver.loads.surface import LoadedSurface

REFERENCE = Path(__file__).parents[4] / "shared" / "reference"

pytestmark = pytest.mark.skipif(not REFERENCE.is_dir(), reason="the reference runs are not here")


def cylinder(radius):
    return Cylinder(bottom=(0.0, 0.0, 0.0), top=(0.0, 0.0, 0.02), radius=radius)


def ramp(number, load):
    return LoadCurve(number, (TimePoint(0.0, 0.0), TimePoint(1.0e-5, load)))


def test_thick_cylinder_has_the_curves_and_forces_of_sus():
    saved = np.load(REFERENCE / "thick_cylinder" / "particles.npz")
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


def points(*rows):
    return tuple(TimePoint(time, load) for time, load in rows)


BEAM = Pressure(
    geom_object=LoadedSurface(Box(min=(0.99, 1.0, 8.0), max=(1.01, 6.0, 10.0))),
    load_curve=LoadCurve(1, points((0.0, 1e4), (2.0, 4e5), (20.0, 4e5))),
)
TWISTED_ROD = Pressure(
    geom_object=LoadedSurface(
        Cylinder(bottom=(0.0, 0.0, 0.999), top=(0.0, 0.0, 1.001), radius=0.5, cylinder_end=True)
    ),
    load_curve=LoadCurve(1, points((0.0, -0.1), (0.0002, -1.0e5), (0.01001, -1.1e5), (0.015001, -1.2e5))),
)
HEATED_BLOCK = HeatFlux(
    geom_object=LoadedSurface(Box(min=(-0.51, -0.5, -0.5), max=(-0.49, 0.5, 0.0))),
    load_curve=LoadCurve(1, points((0.0, 1e7), (0.001, 1e7), (0.01, 1.2e7)), material=1),
)
HEATED_PLATE = HeatFlux(
    geom_object=LoadedSurface(Box(min=(0.0, 0.0039, 0.0), max=(0.02, 0.0041, 0.001))),
    load_curve=LoadCurve(1, points((0.0, 1e7), (0.99e-3, 1e7), (1.01e-3, 0.0))),
)


@pytest.mark.parametrize(
    ("case", "column", "load", "lag"),
    [
        ("beam_pressure", "TotalMomentum.x", BEAM, 0),
        ("load_curve_press_torque", "TotalMomentum.z", TWISTED_ROD, 0),
        ("load_curve_heat_flux", "ThermalEnergy", HEATED_BLOCK, 1),
        ("thermal_expansion", "ThermalEnergy", HEATED_PLATE, 1),
    ],
)
def test_momentum_and_heat_grow_by_the_total_load_at_the_start_of_each_step(case, column, load, lag):
    # ThermalEnergy is that of the temperatures at the start of a step, so it lags by one step.
    with (REFERENCE / case / "history.csv").open() as file:
        rows = [row for _, row in zip(range(4), csv.DictReader(file), strict=False)]
    time = np.array([0.0] + [float(row["time"]) for row in rows])
    total = np.array([float(row[column]) for row in rows])
    gained = np.diff(total)[lag : lag + 2] / np.diff(time)[1:3]
    expected = [load.magnitude(t, count=1) for t in time[1:3]]
    np.testing.assert_allclose(gained, expected, rtol=2e-6)
