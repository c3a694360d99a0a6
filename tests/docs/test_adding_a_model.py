"""The worked example of docs/adding-a-model.md, done in a copy of the program."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "adding-a-model.md").read_text()


def block_after(text: str) -> str:
    """The code block that follows a piece of text on the page."""
    match = re.match(r".*?```\w+\n(.*?)```", PAGE[PAGE.index(text) :], re.DOTALL)
    assert match
    return match[1]


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the program with the new model in it, and a deck that uses it."""
    copy = tmp_path_factory.mktemp("program")
    for name in ("solver", "ups", "materialdata", "inputs"):
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "cli.py", copy)
    for title in ("`solver/materials/flow_stress/swift.py`:", "`tests/solver/materials/test_swift.py`:"):
        file = copy / title.strip("`:")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(block_after(title))
    text = (ROOT / "inputs" / "MPM" / "taylorCylinder.ups").read_text()
    text = re.sub(r" *<flow_model .*?</flow_model>\n", block_after("## In a deck"), text, flags=re.DOTALL)
    (copy / "swift.ups").write_text(text)
    return copy


def run(program: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    environment["PYTHONPATH"] = str(program)
    command = [sys.executable, *arguments]
    return subprocess.run(
        command, cwd=program, env=environment, capture_output=True, text=True, timeout=300, check=False
    )


def test_the_model_passes_its_test(program: Path) -> None:
    test = "tests/solver/materials/test_swift.py"
    outcome = run(program, "-m", "pytest", "-q", "-p", "no:cacheprovider", test)
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr


def test_decks_may_use_it(program: Path) -> None:
    outcome = run(program, "cli.py", "lint", "swift.ups")
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr


@pytest.mark.parametrize(
    ("given", "wrong", "said"),
    [
        ("<n> 0.28    </n>", "<n> 1.5 </n>", "1"),
        ("<n> 0.28    </n>", "<n> 0.28 </n> <e0> 0.1 </e0>", "e_0"),
        ("<K> 320.0e6 </K>", "", "K"),
    ],
)
def test_mistakes_are_named(program: Path, given: str, wrong: str, said: str) -> None:
    text = (program / "swift.ups").read_text()
    assert given in text
    (program / "wrong.ups").write_text(text.replace(given, wrong))
    outcome = run(program, "cli.py", "lint", "wrong.ups")
    assert outcome.returncode == 1
    assert re.search(rf"\b{said}\b", outcome.stdout)


@pytest.mark.slow
def test_a_deck_with_it_runs(program: Path) -> None:
    outcome = run(program, "cli.py", "run", "swift.ups", "--output", "swift.uda", "--max-steps", "5")
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
