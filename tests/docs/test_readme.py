"""The commands and the program text of the README do what they say."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from solver.declare import FAMILIES
from ups.deck import Flags

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()


def block_after(text: str) -> str:
    match = re.match(r".*?```\w+\n(.*?)```", README[README.index(text) :], re.DOTALL)
    assert match
    return match[1]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the decks, in which commands may leave what they like."""
    place = tmp_path_factory.mktemp("readme")
    shutil.copytree(ROOT / "inputs", place / "inputs")
    return place


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, *arguments]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300, check=False
    )


def test_the_commands_of_the_first_deck_work(folder: Path) -> None:
    lines = [line for line in block_after("Run it, look at it").splitlines() if line]
    assert len(lines) == 6
    for line in lines:
        program, *arguments = shlex.split(line, comments=True)
        assert program == "ups"
        outcome = run(folder, str(ROOT / "cli.py"), *arguments)
        assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    assert (folder / "collidingDisks.uda").is_symlink()
    assert (folder / "disks.png").is_file()
    assert (folder / "disks.pvd").is_file()


def test_the_python_of_the_first_deck_works(folder: Path) -> None:
    text = block_after("or from Python")
    outcome = run(folder, "-c", text + "\nprint(stress.shape, len(times) == len(energy))")
    assert outcome.stdout.split("\n")[-2] == "(416, 3, 3) True", outcome.stdout + outcome.stderr


def test_mistakes_are_told_as_the_readme_shows(folder: Path) -> None:
    text = (folder / "inputs" / "MPM" / "thickCylinderMPM.ups").read_text()
    text = re.sub(r"<density>( *7830.0 )</density>", r"<densty>\1</densty>", text)
    text = text.replace('"vonMises"', '"vonmises"').replace("<Gamma_0> 1.69", "<Gamma_0> -1.69")
    (folder / "ring.ups").write_text(text)
    outcome = run(folder, str(ROOT / "cli.py"), "lint", "ring.ups")
    command, shown = block_after("## Mistakes").split("\n", 1)
    assert command == "$ ups lint ring.ups"
    assert outcome.returncode == 1
    assert outcome.stdout.strip() == shown.strip()


def test_the_models_that_the_readme_names_exist() -> None:
    table = README[README.index("## What runs") : README.index("## What does not")]
    rows = dict(re.findall(r"^\| (\w[\w ]*) \| (.*) \|$", table, re.MULTILINE))
    for row, family in (("Shapes", "geometry"), ("Contact", "contact"), ("Interpolators", "interpolator")):
        named = re.findall(r"`(\w+)`", rows[row])
        known = FAMILIES[family]
        assert named
        assert [name for name in named if known.find(name) is None] == []
    assert Flags().interpolator in re.findall(r"`(\w+)`", rows["Interpolators"])
