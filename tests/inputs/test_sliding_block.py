"""A block on an incline, against Coulomb's law."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shipped_decks import run_shipped

GRAVITY, SLOPE = 9.81, np.radians(30.0)


def speed_of_block(folder: Path, mu: float) -> tuple[np.ndarray, np.ndarray]:
    """Times to 0.5 s, and the mean velocity of the block's particles along the slope."""
    result = run_shipped(
        "slidingBlock", folder, {"Time/maxTime": 0.5, "MaterialProperties/MPM/contact/mu": mu}
    )
    velocities = result.series("p.velocity", 1)
    return velocities.times, np.array([velocity[:, 0].mean() for velocity in velocities])


@pytest.mark.parametrize(("mu", "tolerance"), [(0.0, 0.015), (0.3, 0.02)])
def test_it_slides_with_the_acceleration_of_coulomb(tmp_path: Path, mu: float, tolerance: float) -> None:
    times, speed = speed_of_block(tmp_path, mu)
    late = times > 0.1
    acceleration, _ = np.polyfit(times[late], speed[late], 1)
    expected = GRAVITY * (np.sin(SLOPE) - mu * np.cos(SLOPE))
    assert acceleration == pytest.approx(expected, rel=tolerance)


def test_it_stays_where_friction_exceeds_the_slope(tmp_path: Path) -> None:
    # tan 30 = 0.577 < 0.7. The block rattles into place for a tenth of a second, and creeps a little after.
    times, speed = speed_of_block(tmp_path, 0.7)
    free = GRAVITY * np.sin(SLOPE) * times
    late = times > 0.3
    assert np.all(np.abs(speed[late]) < 0.05 * free[late])
