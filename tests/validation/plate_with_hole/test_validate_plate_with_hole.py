from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shipped_decks import FOLDER, run_shipped
from validation_case import Case

import ups

pytestmark = pytest.mark.slow

PULL = 10.0e6


def highest_stress(result: ups.Result) -> float:
    """Stress along the pull of the particle beside the hole, over the pull."""
    position, stress = result["p.x"][-1], result["p.stress"][-1]
    column = np.flatnonzero(position[:, 0] < 1.2 * position[:, 0].min())
    first = column[np.argmin(position[column, 1])]
    return float(stress[first, 0, 0] / PULL)


def test_two_resolutions(case: Case, tmp_path: Path) -> None:
    coarse = highest_stress(run_shipped("plateWithHole", tmp_path))
    text = (FOLDER / "plateWithHole.ups").read_text()
    text = text.replace("[42, 42, 1]", "[84, 84, 1]").replace("0.0025]", "0.00125]")
    fine = highest_stress(ups.read(FOLDER / "plateWithHole.ups", text=text).run(output=tmp_path / "fine.uda"))
    assert coarse < fine < 3.1
    case.compare(four_cells=coarse, eight_cells=fine)
