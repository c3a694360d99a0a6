"""Tension of a plate with a hole, against Kirsch's solution."""

from __future__ import annotations

import numpy as np
import pytest
from shipped_decks import run_shipped

import ups

PULL, HOLE, WIDTH = 10.0e6, 0.01, 0.1


def kirsch(r: np.ndarray) -> np.ndarray:
    """Stress along the pull, across the hole at a distance r from its centre, in an infinite plate."""
    return 0.5 * PULL * (2.0 + (HOLE / r) ** 2 + 3.0 * (HOLE / r) ** 4)


def stress_across(result: ups.Result) -> tuple[np.ndarray, np.ndarray]:
    """Distances from the centre, and stress along the pull, of the column of particles next to x = 0."""
    position, stress = result["p.x"][-1], result["p.stress"][-1]
    column = position[:, 0] < 1.2 * position[:, 0].min()
    order = np.argsort(position[column, 1])
    return position[column, 1][order], stress[column][order][:, 0, 0]


@pytest.fixture(scope="module")
def across(tmp_path_factory: pytest.TempPathFactory) -> tuple[np.ndarray, np.ndarray]:
    return stress_across(run_shipped("plateWithHole", tmp_path_factory.mktemp("plate")))


def test_stress_beside_the_hole(across: tuple[np.ndarray, np.ndarray]) -> None:
    # Four cells on the radius: the first particle lies a quarter cell from the edge, where Kirsch has 2.62.
    r, stress = across
    assert r[0] == pytest.approx(HOLE + 0.000625, abs=1e-5)
    assert stress[0] / PULL == pytest.approx(2.40, abs=0.05)
    assert stress[0] / kirsch(r[0]) == pytest.approx(1.0, abs=0.10)


def test_stress_falls_off_as_kirsch_says(across: tuple[np.ndarray, np.ndarray]) -> None:
    # The plate is ten radii wide, not infinite, which adds some hundredths (R. C. J. Howland, 1930).
    r, stress = across
    near = (r > 1.1 * HOLE) & (r < 4.0 * HOLE)
    assert stress[near] / kirsch(r[near]) == pytest.approx(1.0, abs=0.06)


def test_the_section_carries_the_pull(across: tuple[np.ndarray, np.ndarray]) -> None:
    _, stress = across
    spacing = 0.0025 / 2.0
    assert stress.sum() * spacing == pytest.approx(PULL * WIDTH, rel=0.02)
