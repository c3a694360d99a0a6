"""Taylor shots beside experiment, and beside two other codes with the same material."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from taylor_rod import HERE, Rod, Shot, shoot, shots

CELLS = 8
"""On the radius."""
RESULTS = HERE / "result.json"
each_shot = pytest.mark.parametrize("name", shots())


def judge(shot: Shot, found: dict[str, float]) -> None:
    for quantity, answer in shot.answers.items():
        assert found[quantity] == pytest.approx(answer.value, rel=answer.tolerance), quantity
    assert found["energy"] < 0.01


@pytest.mark.slow
@each_shot
def test_recovered_rod(name: str, tmp_path: Path) -> None:
    shot = shots()[name]
    rod = shoot(shot, CELLS, tmp_path)
    found = {quantity: float(f"{value:.4g}") for quantity, value in rod._asdict().items()}
    if os.environ.get("UPS_RECORD"):
        recorded = json.loads(RESULTS.read_text()) if RESULTS.is_file() else {}
        RESULTS.write_text(json.dumps(recorded | {name: found}, indent=2) + "\n")
    judge(shot, found)


@each_shot
def test_the_recorded_rod_is_within_the_tolerances(name: str) -> None:
    found = json.loads(RESULTS.read_text())[name]
    assert found.keys() == set(Rod._fields)
    judge(shots()[name], found)


@each_shot
def test_the_page_tells_the_recorded_rod(name: str) -> None:
    page = (HERE / "README.md").read_text()
    shot, found = shots()[name], json.loads(RESULTS.read_text())[name]
    for quantity in ("length", "foot"):
        answer = shot.answers[quantity]
        error = 100.0 * (found[quantity] / answer.value - 1.0)
        row = f"| {shot.title} | {quantity} | {answer.value:.3f} | {found[quantity]:.3f} | {error:+.1f} |"
        assert row in page


def test_the_code_to_code_case_is_within_two_percent() -> None:
    found = json.loads(RESULTS.read_text())["42CrMo4_287"]
    assert found["length"] * 32.4 == pytest.approx(26.5, rel=0.02)
    assert found["foot"] * 6.4 == pytest.approx(11.15, rel=0.02)
