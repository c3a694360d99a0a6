"""What a case of validation is: a folder with the answers expected and the results found."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Case:
    """A folder with ``expected.json`` and ``result.json``."""

    folder: Path

    @property
    def deck(self) -> str:
        return str(self._expected["deck"])

    @property
    def quantities(self) -> dict[str, dict[str, Any]]:
        """Name -> meaning, value, relative tolerance and source."""
        return dict(self._expected["quantities"])

    @property
    def results(self) -> dict[str, float]:
        """What the last recorded run found."""
        file = self.folder / "result.json"
        return dict(json.loads(file.read_text())) if file.is_file() else {}

    @property
    def _expected(self) -> dict[str, Any]:
        return dict(json.loads((self.folder / "expected.json").read_text()))

    def compare(self, **measured: float) -> None:
        """Assert the measured quantities, and write them down where ``UPS_RECORD`` is set."""
        if os.environ.get("UPS_RECORD"):
            rounded = {name: float(f"{value:.4g}") for name, value in measured.items()}
            (self.folder / "result.json").write_text(json.dumps(self.results | rounded, indent=2) + "\n")
        self.judge(measured)

    def judge(self, found: dict[str, float]) -> None:
        """Assert that each value lies within the tolerance of the answer."""
        for name, value in found.items():
            answer = self.quantities[name]
            assert value == pytest.approx(answer["value"], rel=answer["tolerance"]), answer["source"]


def all_cases() -> list[Case]:
    return [Case(file.parent) for file in sorted(HERE.glob("*/expected.json"))]
