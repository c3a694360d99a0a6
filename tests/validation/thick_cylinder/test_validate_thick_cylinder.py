from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shipped_decks import FOLDER, run_shipped
from thick_cylinder_reference import burst
from validation_case import Case

import ups

pytestmark = pytest.mark.slow

PRESSURE, INNER, OUTER = 1.0e8, 0.5, 1.0
CHANGES = {
    "<time> 1.0e-5 </time> <load> 1.0e9 </load>": "<time> 2.0e-4 </time> <load> 1.0e8 </load>",
    "</interpolator>": "</interpolator> <artificial_damping_coeff>1e4</artificial_damping_coeff>",
    "[0.025, 0.025, 0.02]": "[0.05, 0.05, 0.02]",
    "5.0e-4 </maxTime>": "1.5e-3 </maxTime>",
}


def test_burst(case: Case, tmp_path: Path) -> None:
    result = run_shipped("thickCylinderMPM", tmp_path)
    displacement, position = result["p.displacement"][-1], result["p.x"][-1]
    radius = np.linalg.norm((position - displacement)[:, :2], axis=1)
    moved = np.linalg.norm(position[:, :2], axis=1) - radius
    time = float(result["p.x"].times[-1])
    tube = burst(lambda t: 1.0e9 * min(t / 1.0e-5, 1.0), end=time)

    def ratio(ring: np.ndarray) -> float:
        reference = np.interp(radius[ring], tube.radius, tube.displacement)
        return float(moved[ring].mean() / reference.mean())

    case.compare(bore=ratio(radius < 0.55), mantle=ratio(radius > 0.95))


def test_elastic_stress(case: Case, tmp_path: Path) -> None:
    """A tenth of the pressure, raised slowly with damping until the tube is at rest."""
    text = (FOLDER / "thickCylinderMPM.ups").read_text()
    for given, wanted in CHANGES.items():
        assert given in text
        text = text.replace(given, wanted)
    deck = ups.read(FOLDER / "thickCylinderMPM.ups", text=text)
    result = deck.run(output=tmp_path / "elastic.uda")
    position, stress = result["p.x"][-1][:, :2], result["p.stress"][-1]
    radius = np.linalg.norm(position, axis=1)
    normal = position / radius[:, None]
    around = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    hoop = np.einsum("pi,pij,pj->p", around, stress[:, :2, :2], around)
    factor = PRESSURE * INNER**2 / (OUTER**2 - INNER**2)
    lame = factor * (1.0 + (OUTER / radius) ** 2)
    bore, middle, mantle = radius < 0.6, (radius > 0.7) & (radius < 0.8), radius > 0.9
    case.compare(
        lame_bore=float(hoop[bore].mean() / lame[bore].mean()),
        lame_middle=float(hoop[middle].mean() / lame[middle].mean()),
        lame_mantle=float(hoop[mantle].mean() / lame[mantle].mean()),
    )
