"""Runs of the decks that ship, in full or shortened."""

from __future__ import annotations

from pathlib import Path

import ups

FOLDER = Path(__file__).resolve().parents[2] / "inputs" / "MPM"
NAMES = sorted(path.stem for path in FOLDER.glob("*.ups"))


def run_shipped(name: str, folder: Path, changes: dict[str, object] | None = None) -> ups.Result:
    """Run a deck with some tags changed (path of tags -> value); the archive goes into ``folder``."""
    overrides = [(path, str(value)) for path, value in (changes or {}).items()]
    return ups.read(FOLDER / f"{name}.ups", overrides=overrides).run(output=folder / f"{name}.uda")
