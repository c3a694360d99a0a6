from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shipped_decks import run_shipped
from validation_case import Case

pytestmark = pytest.mark.slow


def test_profile_and_stress(case: Case, tmp_path: Path) -> None:
    result = run_shipped("siliconFilm", tmp_path)
    c, stress = result["p.concentration"][-1], result["p.stress"][-1]
    nodes = result["g.concentration"][-1][:, 1, 1]
    case.compare(
        mean=float(c.mean()),
        base=float(nodes[1]),
        middle=float(nodes[11]),
        stress_at_base=float(stress[0, 1, 1] / 1.0e6),
        thickening=float(result["p.displacement"][-1][:, 0].max() * 1.0e9),
    )
    assert np.isfinite(stress).all()
