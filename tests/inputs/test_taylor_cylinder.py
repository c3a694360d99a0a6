"""The first half microsecond of a Taylor impact: the shock that runs up the rod."""

from __future__ import annotations

import numpy as np
import pytest
from shipped_decks import run_shipped

import ups

IMPACT, SOUND, SLOPE, DENSITY = 210.0, 3940.0, 1.489, 8960.0
SHOCK_SPEED = SOUND + SLOPE * IMPACT
"""Measured relation of copper, S. P. Marsh (1980); behind the shock the rod is at rest."""
SHOCK_PRESSURE = DENSITY * SHOCK_SPEED * IMPACT
"""Rankine and Hugoniot: p = rho U u."""
CELL = 3.81e-4


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> ups.Result:
    # The release from outside reaches the axis after 0.8 microseconds; until then the shock there is plane.
    changes = {"Time/maxTime": 7.0e-7, "DataArchiver/outputInterval": 2.0e-8}
    return run_shipped("taylorCylinder", tmp_path_factory.mktemp("taylor"), changes)


def test_the_shock_has_the_speed_of_copper(result: ups.Result) -> None:
    times, height, speed = result["p.x"].times, [], []
    for position, displacement, velocity in zip(
        result["p.x"], result["p.displacement"], result["p.velocity"], strict=True
    ):
        start = position - displacement
        axis = np.flatnonzero(start[:, 0] < CELL)
        order = axis[np.argsort(start[axis, 1])]
        height.append(start[order, 1])
        speed.append(-velocity[order, 1])
    arrival = [np.interp(-0.5 * IMPACT, -np.array(v), times) for v in np.transpose(speed)]
    behind_start = (height[0] > 2.0 * CELL) & (height[0] < 6.0 * CELL)
    slope, _ = np.polyfit(np.array(arrival)[behind_start], height[0][behind_start], 1)
    assert slope == pytest.approx(SHOCK_SPEED, rel=0.05)


def test_the_shocked_copper_has_the_pressure_of_hugoniot(result: ups.Result) -> None:
    # A smeared front of four cells rings; the mean over what lies behind it does not.
    pressures = []
    for position, stress, time in zip(result["p.x"], result["p.stress"], result["p.x"].times, strict=True):
        front = (SHOCK_SPEED - IMPACT) * time
        column = (position[:, 0] < 2.0 * CELL) & (position[:, 1] < front - 2.0 * CELL)
        if 4.5e-7 < time < 6.0e-7:
            pressures.append(-np.trace(stress[column], axis1=1, axis2=2).mean() / 3.0)
    assert len(pressures) >= 4
    assert np.mean(pressures) == pytest.approx(SHOCK_PRESSURE, rel=0.05)
