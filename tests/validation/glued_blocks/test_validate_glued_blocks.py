from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shipped_decks import run_shipped
from validation_case import Case

pytestmark = pytest.mark.slow

WORK = np.e * 20.0e3 * 1.0e-3 * 0.3 * 0.1


def test_energy_of_separation(case: Case, tmp_path: Path) -> None:
    _, energy = run_shipped("gluedBlocks", tmp_path).history("KineticEnergy")
    case.compare(work=float((energy[0] - energy[-1]) / WORK))
