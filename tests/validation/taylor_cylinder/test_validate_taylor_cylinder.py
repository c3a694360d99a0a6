from __future__ import annotations

from pathlib import Path

import pytest
from shipped_decks import run_shipped
from validation_case import Case

pytestmark = pytest.mark.slow

LENGTH, RADIUS, CELL = 0.02347, 3.81e-3, 3.81e-4
HALF_PARTICLE = 0.25 * CELL


def test_recovered_rod(case: Case, tmp_path: Path) -> None:
    result = run_shipped("taylorCylinder", tmp_path)
    position = result["p.x"][-1]
    case.compare(
        length=float((position[:, 1].max() + HALF_PARTICLE) / LENGTH),
        foot=float((position[:, 0].max() + HALF_PARTICLE) / RADIUS),
    )
