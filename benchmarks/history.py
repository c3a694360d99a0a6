"""Results of former times, as ratios to what the machine could do, so that other machines compare."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from solver.performance.report import Report

HISTORY = Path(__file__).with_name("history.json")


class Ratios(NamedTuple):
    """The time of a particle in a step, in units of the two calibration kernels."""

    triads: float
    """Over the time of a triad of one element, 24 bytes moved."""
    multiply_adds: float
    """Over the time of one multiply-add of eight numbers, 16 operations."""


def ratios(report: Report) -> Ratios:
    """What the history keeps of a report."""
    seconds = report.seconds / report.particle_steps
    return Ratios(seconds * report.machine.bandwidth / 24.0, seconds * report.machine.flops / 16.0)


def last(path: Path = HISTORY) -> dict[str, Ratios]:
    """The newest ratios of each case in the history."""
    found: dict[str, Ratios] = {}
    for entry in json.loads(path.read_text()) if path.exists() else []:
        found |= {name: Ratios(*numbers) for name, numbers in entry["ratios"].items()}
    return found


def append(label: str, reports: Mapping[str, Report], path: Path = HISTORY) -> None:
    """Add an entry with a label that says what state of the program was measured."""
    history = json.loads(path.read_text()) if path.exists() else []
    numbers = {name: [round(r, 1) for r in ratios(report)] for name, report in reports.items()}
    path.write_text(json.dumps([*history, {"label": label, "ratios": numbers}], indent=1) + "\n")


def changes(reports: Mapping[str, Report], before: Mapping[str, Ratios]) -> str:
    """How each case compares with the history, for reading; slower is positive."""
    lines = [
        "change of the time of a particle-step since the last entry of the history, in units of the machine:"
    ]
    for name, report in reports.items():
        now, old = ratios(report), before.get(name)
        if old is None:
            lines.append(f"  {name}: {now.triads:.0f} triads, {now.multiply_adds:.0f} multiply-adds; new")
        else:
            lines.append(
                f"  {name}: {now.triads:.0f} triads ({now.triads / old.triads - 1.0:+.0%}), "
                f"{now.multiply_adds:.0f} multiply-adds ({now.multiply_adds / old.multiply_adds - 1.0:+.0%})"
            )
    return "\n".join(lines)
