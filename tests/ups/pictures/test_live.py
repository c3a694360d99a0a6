"""The picture of a run while it goes on: drawn at each output, by another process, without changing the run."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image
from thread_ranks import ThreadRank, on_ranks

from cli import main
from ups.archive import Archive
from ups.deck import read_deck
from ups.inspect.compare import Tolerances, compare_archives
from ups.pictures.live import Live, draw_at_each, picture_of
from ups.session import run_deck

ROOT = Path(__file__).resolve().parents[3]
DECK = ROOT / "inputs" / "MPM" / "collidingDisks.ups"


def run(folder: Path, *options: str) -> Path:
    """Run a few steps of a deck; the archive."""
    output = folder / "run.uda"
    arguments = ["run", *options, "--output", str(output), "--max-steps", "30"]
    done = CliRunner().invoke(main, arguments)
    assert done.exit_code == 0, done.output
    return output


@pytest.fixture(autouse=True)
def no_display(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setenv("SSH_CONNECTION", "of a machine without a display")


def test_the_picture_of_a_run_that_is_not_changed_by_it(tmp_path: Path) -> None:
    (tmp_path / "with").mkdir()
    archive = run(tmp_path / "with", str(DECK), "--live", "p.velocity:X")
    picture = picture_of(archive)
    assert picture.name == "run.uda.png"
    with Image.open(picture) as drawn:
        assert drawn.size[0] > 500
        assert len(drawn.convert("RGB").getcolors(1 << 20)) > 20
    assert sorted(p.name for p in picture.parent.iterdir()) == ["run.uda", "run.uda.png"]
    (tmp_path / "without").mkdir()
    plain = run(tmp_path / "without", str(DECK))
    assert not picture_of(plain).exists()
    assert compare_archives(archive, plain, Tolerances(0.0, 0.0)).status == 0


def test_the_picture_of_several_ranks_shows_the_particles_of_all(tmp_path: Path) -> None:
    """That of three ranks is that of one, and not that of the particles of the first."""
    deck = read_deck(DECK)
    run_deck(deck, output=tmp_path / "one", max_steps=30, observers=[Live("p.velocity:X", window=False)])

    def go(rank: ThreadRank) -> int:
        watching = [Live("p.velocity:X", window=False)] if rank.rank == 0 else []
        result = run_deck(
            read_deck(DECK), output=tmp_path / "many", max_steps=30, observers=watching, communicator=rank
        )
        grid = result.archive.grid().levels[0]
        return sum(len(result.archive.particles(-1, "p.x", 0, p.id)) for p in grid.patches if p.proc == 0)

    of_first = on_ranks(3, go)[0]
    assert of_first < len(Archive(tmp_path / "many").particles(-1, "p.x", 0))
    one, many = (np.asarray(Image.open(picture_of(tmp_path / name))) for name in ("one", "many"))
    assert one.shape == many.shape
    assert np.mean((one != many).any(axis=2)) < 1e-3


def test_the_deck_may_stand_behind_the_option(tmp_path: Path) -> None:
    assert picture_of(run(tmp_path, "--live", str(DECK))).is_file()


def test_a_variable_that_is_not_saved_is_said_before_the_run(tmp_path: Path) -> None:
    output = tmp_path / "run.uda"
    done = CliRunner().invoke(main, ["run", str(DECK), "--live", "temperature", "--output", str(output)])
    assert done.exit_code == 1
    assert "--live: there is no variable temperature" in done.output
    assert "the deck saves: p.x, p.particleID, p.velocity, p.stress" in done.output
    assert not output.exists()


def test_a_run_goes_on_where_nothing_can_be_drawn(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "run.uda.png").mkdir()  # where the picture should go
    run(tmp_path, str(DECK), "--live")
    assert "no live picture: " in capfd.readouterr().err


def test_each_picture_replaces_the_one_before_as_a_whole(make) -> None:  # type: ignore[no-untyped-def]
    archive = make((4, 2, 1))
    picture, seen = picture_of(archive), []

    def lines():  # type: ignore[no-untyped-def]
        for _ in range(3):
            yield ""
            seen.append((picture.stat().st_ino, picture.read_bytes()[:4]))

    draw_at_each(lines(), archive, None)
    assert len(set(seen)) == 1  # no new step, so nothing to draw again
    assert seen[0][1] == b"\x89PNG"
    assert [p.name for p in archive.parent.iterdir() if "partial" in p.name] == []


@pytest.mark.skipif(shutil.which("xvfb-run") is None, reason="needs xvfb-run, a display in memory")
def test_a_window_opens_where_there_is_a_display(make) -> None:  # type: ignore[no-untyped-def]
    archive = make((4, 2, 1))
    script = (
        "import sys, threading, time\n"
        "from ups.pictures import live, window\n"
        "opened = []\n"
        "window.Window.loop = lambda self: opened.append((self.viewer.step, self.viewer.variable))\n"
        f"live.open_window([''], live.Path({str(archive)!r}), 'p.volume')\n"
        "print(window.has_display(), opened)\n"
    )
    command = ["xvfb-run", "-a", sys.executable, "-c", script]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    environment.pop("SSH_CONNECTION")
    outcome = subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=120, check=False
    )
    assert outcome.stdout == "True [(6, 'p.volume')]\n", outcome.stderr


def test_looking_for_new_steps_costs_a_step_next_to_nothing(make) -> None:  # type: ignore[no-untyped-def]
    from ups.pictures.live import Live
    from ups.run import Run

    live = Live(None, window=False)
    run_ = Run.__new__(Run)
    run_.directory = make((4, 2, 1))
    live.begin(run_)
    start = time.perf_counter()
    for _ in range(1000):
        live.after_step(run_)
    each = (time.perf_counter() - start) / 1000
    live.end(run_)
    assert each < 1e-3
