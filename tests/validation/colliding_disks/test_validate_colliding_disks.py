from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shipped_decks import run_shipped
from validation_case import Case

pytestmark = pytest.mark.slow


def test_collision(case: Case, tmp_path: Path) -> None:
    result = run_shipped("collidingDisks", tmp_path)
    times, kinetic = result.history("KineticEnergy")
    total = kinetic + result["StrainEnergy"]
    case.compare(
        time_of_rest=float(times[np.argmin(kinetic)]),
        kinetic_energy=float(kinetic[-1] / kinetic[0]),
        energy=float(total[-1] / total[0]),
    )
