from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from heat_reference import exact, nodal_temperature
from shipped_decks import run_shipped
from validation_case import Case

pytestmark = pytest.mark.slow


def test_profile(case: Case, tmp_path: Path) -> None:
    result = run_shipped("heatTwoMaterials", tmp_path)
    temperature = nodal_temperature(result)
    x = np.linspace(-4.0e-5, 4.0e-5, 81)
    reference = exact(x, float(result["g.temperature"].times[-1]))
    case.compare(
        interface=float(temperature[40]),
        copper=float(temperature[35]),
        steel=float(temperature[45]),
    )
    assert np.abs(temperature - reference).max() < 1.5
