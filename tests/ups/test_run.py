"""The loop over steps and its observers, and the library's way to run a deck."""

from __future__ import annotations

import io
import re
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_decks import LEFT, deck, write
from thread_ranks import on_ranks

import ups
from ups.archive import Archive
from ups.deck import Deck, read_deck
from ups.diagnostics import DeckError
from ups.progress import Progress
from ups.run import Observer, Run
from ups.session import run_deck


def read(tmp_path: Path, text: str) -> Deck:
    return read_deck(write(tmp_path, text))


class Witness(Observer):
    """Notes every call; asks the run to stop after a number of steps."""

    def __init__(self, stop_after: int = 0) -> None:
        self.calls: list[str] = []
        self.tried: list[float] = []
        self.done: list[float] = []
        self.lasts: list[bool] = []
        self.stop_after = stop_after

    def begin(self, run: Run) -> None:
        self.calls.append("begin")

    def before_step(self, run: Run, dt: float) -> None:
        self.calls.append("before")
        self.tried.append(dt)

    def after_step(self, run: Run) -> None:
        self.calls.append("after")
        self.done.append(run.dt)
        self.lasts.append(run.is_last)
        if run.steps_done == self.stop_after:
            run.stop("enough")

    def end(self, run: Run) -> None:
        self.calls.append("end")


def test_observers_see_every_moment(tmp_path: Path) -> None:
    witness = Witness()
    result = run_deck(read(tmp_path, deck()), output=tmp_path / "a", max_steps=3, observers=[witness])
    assert witness.calls == ["begin", *["before", "after"] * 3, "end"]
    assert witness.lasts == [False, False, True]
    assert result.steps == 3
    assert result.stop_reason == ""
    assert result.time == pytest.approx(sum(witness.done), rel=1e-15)


def test_an_observer_can_stop_the_run_and_a_checkpoint_is_left(tmp_path: Path) -> None:
    result = run_deck(read(tmp_path, deck()), output=tmp_path / "a", observers=[Witness(stop_after=4)])
    assert (result.steps, result.stop_reason) == (4, "enough")
    checkpoints = Archive(result.directory).checkpoints
    assert checkpoints is not None
    assert [t.step for t in checkpoints.timesteps] == [4]


def test_end_is_called_where_a_step_fails(tmp_path: Path) -> None:
    class Failing(Witness):
        def after_step(self, run: Run) -> None:
            raise MemoryError("all is used")

    witness = Failing()
    with pytest.raises(DeckError, match="not enough memory: all is used"):
        run_deck(read(tmp_path, deck()), output=tmp_path / "a", observers=[witness])
    assert witness.calls == ["begin", "before", "end"]
    assert [t.step for t in Archive(tmp_path / "a").timesteps] == [1]


def test_times_of_output_are_met_where_the_deck_asks_for_it(tmp_path: Path) -> None:
    text = deck(
        archiver="<outputInterval>0.9e-3</outputInterval><outputLastTimestep>true</outputLastTimestep>",
        time="<clamp_time_to_output>true</clamp_time_to_output>"
        "<end_at_max_time_exactly>true</end_at_max_time_exactly>",
        max_time="2.0e-3",
    )
    result = run_deck(read(tmp_path, text), output=tmp_path / "a")
    times = [t.time for t in result.archive.timesteps]
    np.testing.assert_allclose(times[1:], [0.9e-3, 1.8e-3, 2.0e-3], rtol=1e-14)
    assert result.time == 2.0e-3


FAST = LEFT.replace("[20.0,3.0,0.0]", "[2000.0,0.0,0.0]").replace(",0.1]</max>", ",0.3]</max>")


def thick(text: str) -> str:
    """The deck three cells thick: only nodes that are inside in every direction can be too fast."""
    return text.replace("0.5,0.1]</upper>", "0.5,0.3]</upper>").replace("[8,5,1]", "[8,5,3]")


def test_a_step_with_too_fast_nodes_is_repeated_with_a_tenth(tmp_path: Path) -> None:
    flag = "<restartOnLargeNodalVelocity>true</restartOnLargeNodalVelocity>"
    text = thick(deck(materials=FAST, flags=flag, time="<max_Timesteps>2</max_Timesteps>"))
    witness = Witness()
    text = text.replace("<timestep_multiplier>0.4<", "<timestep_multiplier>2.0<")
    run_deck(read(tmp_path, text), output=tmp_path / "a", observers=[witness])
    assert witness.tried[1] == 0.1 * witness.tried[0]
    assert witness.done[0] == witness.tried[1]
    # the particles moved by the smaller step alone
    x = Archive(tmp_path / "a").particles(1, "p.x")
    still = thick(deck(materials=FAST.replace("[2000.0,0.0,0.0]", "[0,0,0]")))
    start = run_deck(read(tmp_path, still), output=tmp_path / "b", max_steps=1)["p.x"][-1]
    np.testing.assert_allclose(x - start, np.ones_like(x) * [2000.0 * witness.done[0], 0.0, 0.0], atol=1e-12)


def test_a_step_that_may_not_be_smaller_ends_the_run(tmp_path: Path) -> None:
    flag = "<restartOnLargeNodalVelocity>true</restartOnLargeNodalVelocity>"
    text = thick(deck(materials=FAST, flags=flag)).replace("<delt_min>0.0<", "<delt_min>1e-3<")
    with pytest.raises(DeckError) as caught:
        run_deck(read(tmp_path, text), output=tmp_path / "a")
    message = str(caught.value)
    assert "UPS601" in message
    assert "less than <delt_min>" in message
    assert "blocks.ups:7:" in message


def test_result_by_label(tmp_path: Path) -> None:
    path = write(tmp_path)
    result = ups.read(path).run(tmp_path / "a.uda")
    stress = result["p.stress"]
    assert [int(s) for s in stress.steps] == [1, 4, 7]
    assert stress[-1].shape == (72, 3, 3)
    assert result.series("p.stress", 1)[0].shape == (36, 3, 3)
    assert len(stress[:2]) == 2
    times, energy = result.history("KineticEnergy_0")
    assert len(times) == len(energy) == result.steps == 8
    np.testing.assert_array_equal(result["KineticEnergy_0"], energy)
    with pytest.raises(KeyError, match=r"p\.strain was not saved; there are: p\.x"):
        result["p.strain"]


def test_archives_are_numbered_beside_a_link(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = write(tmp_path)
    for number in ("000", "001"):
        result = ups.read(path).run(max_steps=1)
        assert result.directory == Path(f"blocks.uda.{number}")
        assert (tmp_path / "blocks.uda").resolve() == (tmp_path / result.directory)


def test_importing_ups_is_cheap() -> None:
    code = (
        "import sys, ups; print([m for m in ('numpy', 'numba', 'lxml', 'click', 'rich') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


class SlowStart(Observer):
    """Holds up the first step, as compiling does."""

    def before_step(self, run: Run, dt: float) -> None:
        if run.steps_done == 0:
            time.sleep(1.0)


@pytest.mark.parametrize("ranks", [1, 2])
def test_the_last_line_leaves_the_first_step_out(tmp_path: Path, ranks: int) -> None:
    path, said = write(tmp_path, deck()), io.StringIO()
    run_deck(read_deck(path), output=tmp_path / "before.uda")  # kernels are there

    def run(rank: Any) -> None:
        observers = [SlowStart(), *([Progress(said)] if rank.rank == 0 else [])]
        run_deck(read_deck(path), output=tmp_path / "a.uda", observers=observers, communicator=rank)

    on_ranks(ranks, run)
    found = re.search(r"in (\S+) s, (\S+) ms/step after the first", said.getvalue())
    assert found is not None
    assert float(found[1]) >= 1.0
    assert float(found[2]) < 100.0
