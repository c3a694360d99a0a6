"""A tube that bursts: the wall moves as in an independent one-dimensional computation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shipped_decks import run_shipped
from thick_cylinder_reference import burst


def pressure(time: float) -> float:
    return 1.0e9 * min(time / 1.0e-5, 1.0)


def test_the_wall_moves_as_in_one_dimension(tmp_path: Path) -> None:
    # At 100 microseconds the wave of pressure has reached the outer surface, and the bore has yielded.
    result = run_shipped("thickCylinderMPM", tmp_path, {"Time/maxTime": 1.02e-4})
    displacement, position = result["p.displacement"][-1], result["p.x"][-1]
    start = (position - displacement)[:, :2]
    radius = np.linalg.norm(start, axis=1)
    outward = np.sum(start * displacement[:, :2], axis=1) / radius

    tube = burst(pressure, end=float(result["p.x"].times[-1]))

    expected = np.interp(radius, tube.radius, tube.displacement)
    assert tube.displacement[0] == pytest.approx(2.1e-3, rel=0.05)
    # The staircase of particles at the bore spreads its own displacements by a tenth, hence rings of them.
    rings = np.digitize(radius, np.linspace(0.5, 1.0, 11))
    near = 0.03 * tube.displacement[0]
    for ring in range(1, 11):
        inside = rings == ring
        assert outward[inside].mean() == pytest.approx(expected[inside].mean(), abs=near)
