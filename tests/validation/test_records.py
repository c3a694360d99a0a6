"""The recorded results are what the cases expect, and what the documentation says."""

from __future__ import annotations

import pytest
from validation_case import HERE, Case, all_cases

ROOT = HERE.parents[1]
each_case = pytest.mark.parametrize("case", all_cases(), ids=lambda case: case.folder.name)


def test_every_deck_that_ships_has_a_case() -> None:
    shipped = {f"inputs/MPM/{path.name}" for path in (ROOT / "inputs" / "MPM").glob("*.ups")}
    assert {case.deck for case in all_cases()} == shipped


@each_case
def test_the_last_results_are_within_their_tolerances(case: Case) -> None:
    assert case.results.keys() == case.quantities.keys()
    case.judge(case.results)


@each_case
def test_the_documentation_tells_the_last_results(case: Case) -> None:
    page = (ROOT / "docs" / "validation.md").read_text()
    for name, answer in case.quantities.items():
        values = f"{answer['value']:g} | {case.results[name]:g} | {answer['tolerance']:.3g}"
        assert f"| {answer['meaning']} | {values} |" in page
