"""Two blocks that tear their glue, against the work of separation of Xu and Needleman."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shipped_decks import run_shipped

MASS, AREA, OPENING = 1200.0 * 0.3 * 0.3 * 0.1, 0.3 * 0.1, 1.0e-3


def speed_left(strength: float) -> float:
    """Speed of each block once the glue is torn: what is left of 0.5 m/s after e sig_max delta_n an area."""
    return float(np.sqrt(0.5**2 - np.e * strength * OPENING * AREA / MASS))


@pytest.mark.parametrize("strength", [10.0e3, 20.0e3])
def test_the_blocks_lose_the_work_of_separation(tmp_path: Path, strength: float) -> None:
    result = run_shipped("gluedBlocks", tmp_path, {"MaterialProperties/MPM/cohesive_zone/sig_max": strength})
    for material, way in ((0, -1.0), (1, 1.0)):
        velocity = result.series("p.velocity", material)[-1].mean(axis=0)
        np.testing.assert_allclose(velocity, [way * speed_left(strength), 0.0, 0.0], rtol=2e-3, atol=1e-9)
    assert (result.series("cz.failed", 2)[-1] > 0).all()


def test_strong_glue_holds(tmp_path: Path) -> None:
    strong = {"MaterialProperties/MPM/cohesive_zone/sig_max": 60.0e3}
    opening = [s[:, 0].max() for s in run_shipped("gluedBlocks", tmp_path, strong).series("cz.separation", 2)]
    assert max(opening) < 3.0 * OPENING
    assert opening[-1] < max(opening)
