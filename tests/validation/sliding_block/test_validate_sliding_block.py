from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shipped_decks import run_shipped
from validation_case import Case

pytestmark = pytest.mark.slow

ACCELERATION = 9.81 * (np.sin(np.radians(30.0)) - 0.3 * np.cos(np.radians(30.0)))


def test_way_in_a_second(case: Case, tmp_path: Path) -> None:
    position = run_shipped("slidingBlock", tmp_path).series("p.x", 1)
    way = position[-1][:, 0].mean() - position[0][:, 0].mean()
    case.compare(way=float(way / (0.5 * ACCELERATION * position.times[-1] ** 2)))
