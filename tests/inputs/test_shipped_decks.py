"""What holds for every deck that ships."""

from __future__ import annotations

import re

import pytest
from shipped_decks import FOLDER, NAMES

import ups


def test_there_are_decks() -> None:
    assert {"thickCylinderMPM", "collidingDisks", "taylorCylinder"} <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_it_has_nothing_to_complain_about(name: str) -> None:
    assert list(ups.read(FOLDER / f"{name}.ups").diagnostics) == []


@pytest.mark.parametrize("name", NAMES)
def test_it_tells_a_newcomer_what_it_is_and_how_to_run_it(name: str) -> None:
    text = (FOLDER / f"{name}.ups").read_text()
    comment = re.search(r"<!--(.*?)-->", text, re.DOTALL)
    assert comment
    assert f"ups run inputs/MPM/{name}.ups" in comment[1]
    assert re.search(r"\b(18|19|20)\d\d\)", comment[1]) or "Coulomb" in comment[1] or "Carslaw" in comment[1]
