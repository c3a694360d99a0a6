"""What the documents name does exist."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
KERNELS = [f"solver.kernels.{name}" for name in ("nodes", "settle", "stress", "transfer")]
MOST_BYTES_OF_A_PICTURE = 150_000
each_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)


def resolve(dotted: str) -> None:
    """Import what a dotted name stands for; raises where there is no such thing."""
    parts = dotted.split(".")
    for n in range(len(parts), 0, -1):
        try:
            thing = importlib.import_module(".".join(parts[:n]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[n:]:
            thing = getattr(thing, attribute)
        return
    raise ModuleNotFoundError(dotted)


@each_page
def test_modules_and_functions_exist(page: Path) -> None:
    for name in re.findall(r"`((?:ups|solver)\.[\w.]+)", page.read_text()):
        if not name.endswith((".ups", ".uda", ".py")):
            resolve(name)


@each_page
def test_files_exist(page: Path) -> None:
    text = page.read_text()
    named = re.findall(r"`((?:ups|solver|inputs|docs|tests|materialdata)/[\w/.-]*)`", text)
    linked = [link for link in re.findall(r"\]\(([^)#]+)\)", text) if "://" not in link]
    missing = [name for name in named if not (ROOT / name).exists() and "swift" not in name]
    missing += [link for link in linked if not (page.parent / link).exists()]
    assert missing == []


@each_page
def test_the_command_that_makes_a_picture_stands_beside_it(page: Path) -> None:
    text = page.read_text()
    for link in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text):
        picture = (page.parent / link).resolve()
        name = picture.relative_to(ROOT)
        assert re.search(
            rf"^[^|]*(ups (plot|history) .*-o|python -m benchmarks .*--plot) {name}$", text, re.MULTILINE
        )
        assert picture.stat().st_size < MOST_BYTES_OF_A_PICTURE


def test_the_kernels_of_the_step_exist() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text()
    table = page[page.index("## The step") : page.index("## Contracts")]
    kernels = [importlib.import_module(module) for module in KERNELS]
    rows = [line for line in table.splitlines() if re.match(r"\| \d", line)]
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    elsewhere = {"stress_update", "apply_symmetry"}
    assert len(rows) == 11
    assert [name for name in named - elsewhere if not any(hasattr(k, name) for k in kernels)] == []
