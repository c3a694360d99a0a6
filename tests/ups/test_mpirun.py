"""``mpirun -np N ups run``, with the MPI of the extra ``[mpi]``."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from agreement import disagreement
from small_decks import CONTACT, deck, material, write

from ups.archive import Archive
from ups.deck import read_deck
from ups.session import run_deck

MPIEXEC = Path(sys.executable).parent / "mpiexec"
LIMIT = 240

try:
    import mpi4py  # noqa: F401 - only whether it is there matters
except ImportError:
    pytest.skip("needs mpi4py and mpich: pip install 'ups-mpm[mpi]'", allow_module_level=True)
if not MPIEXEC.exists():
    pytest.skip(f"needs {MPIEXEC}: pip install 'ups-mpm[mpi]'", allow_module_level=True)

BLOCKS = material("[0.1,0.1,0.0]", "[0.4,0.4,0.1]", "[20.0,13.0,0.0]", name="left") + material(
    "[0.4,0.1,0.0]", "[0.7,0.4,0.1]", "[-20.0,0.0,0.0]", name="right"
)
MAIN = "from cli import main; main()"
ROOT = Path(__file__).resolve().parents[2]


def mpirun(
    ranks: int, *arguments: object, folder: Path, program: str = MAIN
) -> subprocess.CompletedProcess[str]:
    """Run ``ups`` with some arguments on some ranks."""
    command = [str(MPIEXEC), "-n", str(ranks), sys.executable, "-c", program, *map(str, arguments)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=LIMIT, check=False
    )


def two_blocks(
    folder: Path, steps: int = 100, archiver: str = "<outputTimestepInterval>20</outputTimestepInterval>"
) -> Path:
    text = deck(materials=BLOCKS + CONTACT, archiver=archiver, time=f"<max_Timesteps>{steps}</max_Timesteps>")
    text = text.replace("linear", "gimp").replace(
        "<resolution>", "<extraCells>[1,1,1]</extraCells><resolution>"
    )
    return write(folder, text)


@pytest.mark.parametrize("ranks", [2, 4])
def test_ranks_give_what_one_process_gives(ranks: int, tmp_path: Path) -> None:
    path = two_blocks(tmp_path)
    run_deck(read_deck(path), output=tmp_path / "one.uda")
    done = mpirun(ranks, "run", path, "--output", "many.uda", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    found = disagreement(tmp_path / "one.uda", tmp_path / "many.uda")
    assert max(found.values()) < 1e-12, found
    archive = Archive(tmp_path / "many.uda")
    assert {patch.proc for patch in archive.grid().levels[0].patches} == set(range(ranks))
    files = {p.name for p in (tmp_path / "many.uda" / "t00001" / "l0").iterdir()}
    assert files == {f"p{rank:05d}.{end}" for rank in range(ranks) for end in ("xml", "data", "crc32")}
    # one rank speaks
    assert done.stdout.count("two blocks:") == done.stdout.count("done: 100 steps") == 1
    assert f"on {ranks} ranks" in done.stdout


def test_a_fault_of_the_deck_is_said_once(tmp_path: Path) -> None:
    path = two_blocks(tmp_path)
    path.write_text(path.read_text().replace("density", "densty"))
    done = mpirun(2, "run", path, "--output", "x.uda", folder=tmp_path)
    assert done.returncode == 1
    assert done.stderr.count("unknown tag <densty>") == 2  # for two materials, by one rank
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "x.uda").exists()


def test_a_live_picture_that_cannot_be_is_said_once(tmp_path: Path) -> None:
    done = mpirun(2, "run", two_blocks(tmp_path), "--live", "p.nothing", "--output", "x.uda", folder=tmp_path)
    assert done.returncode == 1
    assert done.stderr.count("--live: there is no variable p.nothing") == 1
    assert "Abort" not in done.stdout + done.stderr  # no rank was ended by another


def test_a_run_that_diverges_ends_on_all_ranks_with_one_message(tmp_path: Path) -> None:
    path = two_blocks(tmp_path)
    path.write_text(path.read_text().replace("<timestep_multiplier>0.4", "<timestep_multiplier>40."))
    done = mpirun(2, "run", path, "--output", "x.uda", folder=tmp_path)
    assert done.returncode == 1
    assert done.stderr.count("error[UPS602]") == 1
    assert done.stderr.count("1 error") == 1


FAILS_ON_RANK_1 = """
import os, solver.simulation
if os.environ.get("PMI_RANK") == "1":
    advance = solver.simulation.Simulation.advance
    def fails(self, dt):
        if self.step_number == 3:
            raise OSError("this rank has had enough")
        return advance(self, dt)
    solver.simulation.Simulation.advance = fails
from cli import main; main()
"""


def test_a_rank_that_fails_alone_ends_the_others(tmp_path: Path) -> None:
    path = two_blocks(tmp_path)
    start = time.monotonic()
    done = mpirun(2, "run", path, "--output", "x.uda", folder=tmp_path, program=FAILS_ON_RANK_1)
    assert done.returncode != 0
    assert time.monotonic() - start < 60.0
    assert done.stderr.count("internal error: OSError: this rank has had enough") == 1


def test_ctrl_c_ends_the_step_and_leaves_a_checkpoint(tmp_path: Path) -> None:
    path = two_blocks(tmp_path, steps=1_000_000)
    command = [str(MPIEXEC), "-n", "2", sys.executable, "-c", MAIN, "run", str(path), "--output", "x.uda"]
    process = subprocess.Popen(
        command,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    limit = time.monotonic() + LIMIT
    while not (tmp_path / "x.uda" / "t00001").exists() and time.monotonic() < limit:
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=LIMIT)
    assert process.returncode == 130, err
    assert out.count("interrupted:") == 1
    assert err.count("go on with: ups run --restart") == 1
    assert len(Archive(tmp_path / "x.uda").checkpoints.timesteps) == 1  # type: ignore[union-attr]  # there is one


def test_a_serial_start_does_not_load_mpi(tmp_path: Path) -> None:
    program = f"""
import sys
sys.argv = ["ups", "run", {str(two_blocks(tmp_path, steps=1))!r}, "--output", "x.uda", "-q"]
from cli import main
main(standalone_mode=False)
assert "mpi4py" not in sys.modules
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=LIMIT,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def test_ranks_without_mpi_are_told_what_to_install(tmp_path: Path) -> None:
    program = 'import sys; sys.modules["mpi4py"] = None\nfrom cli import main; main()'
    done = mpirun(2, "run", two_blocks(tmp_path), folder=tmp_path, program=program)
    assert done.returncode == 1
    assert "pip install 'ups-mpm[mpi]'" in done.stderr
