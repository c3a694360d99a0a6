"""The program as a person meets it: what it prints, its exit status, and no traceback for bad input."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from small_decks import CONTACT, LEFT, RIGHT, deck, material, write

import ups.commands
from cli import main
from ups.archive import Archive

CLI = Path(__file__).resolve().parents[2] / "cli.py"
COMMANDS = CLI.parent / "ups" / "commands"
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(CLI.parent)}


def invoke(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(a) for a in arguments])


def started(*arguments: object, kilobytes: int | None = None) -> subprocess.Popen[str]:
    """The program in a process of its own, where files may grow to a number of kilobytes."""
    command = [sys.executable, str(CLI), *map(str, arguments)]
    if kilobytes is not None:
        command = ["bash", "-c", f'ulimit -f {kilobytes}; exec "$@"', "bash", *command]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=ENVIRONMENT)


# ---- running ----


def test_run_says_what_it_does(tmp_path: Path) -> None:
    done = invoke("run", write(tmp_path), "--output", tmp_path / "a.uda")
    assert done.exit_code == 0, done.output
    lines = [line for line in done.stdout.splitlines() if "kernels" not in line]
    assert lines[0].startswith(
        "two blocks: 2 materials (hypo_elastic, hypo_elastic), 72 particles, 8 x 5 x 1 cells, "
    )
    assert "4 patches; first dt 0.000" in lines[0]
    assert "about 8 steps" in lines[0]
    assert lines[-1].startswith("done: 8 steps to time ")
    assert f"archive {tmp_path}/a.uda" in lines[-1]
    assert done.stderr == ""


def test_quiet_and_verbose(tmp_path: Path) -> None:
    doubtful = deck(saves=("p.x", "p.damage")).replace(
        '<SimulationComponent type="mpm"/>', "<SimulationComponent><type>mpm</type></SimulationComponent>"
    )
    path = write(tmp_path, doubtful)
    assert "warning[UPS406]" in invoke("run", path, "--output", tmp_path / "a").stderr
    assert invoke("run", path, "--output", tmp_path / "b", "-q").output == ""
    assert "note[UPS302]" in invoke("run", path, "--output", tmp_path / "c", "-v").stderr


def test_max_steps_and_set(tmp_path: Path) -> None:
    path = write(tmp_path)
    done = invoke(
        "run", path, "--output", tmp_path / "a", "--max-steps", 5, "--set", "Time/timestep_multiplier=0.2"
    )
    assert done.exit_code == 0, done.output
    assert len(Archive(tmp_path / "a").reductions["KineticEnergy"].values) == 5
    assert "<timestep_multiplier>0.2<" in (tmp_path / "a" / "input.xml").read_text()
    wrong = invoke("run", path, "--output", tmp_path / "b", "--set", "Time/maxTim=1")
    assert (wrong.exit_code, "UPS410" in wrong.stderr) == (1, True)


def test_restart(tmp_path: Path) -> None:
    path = write(tmp_path, deck(archiver='<checkpoint timestepInterval="2"/>'))
    assert invoke("run", path, "--output", tmp_path / "a", "--max-steps", 6).exit_code == 0
    on = invoke("run", "--restart", tmp_path / "a", "--from", 3)
    assert on.exit_code == 0, on.output
    assert "going on from step 3 dt" in on.stdout
    assert "done: 5 steps" in on.stdout
    assert invoke("run", "--restart", tmp_path / "nothing").exit_code == 1


@pytest.mark.parametrize(
    "arguments",
    [
        ["run"],
        ["run", "a.ups", "--restart", "b.uda"],
        ["run", "a.ups", "--from", "3"],
        ["run", "a.ups", "--max-steps", "0"],
        ["run", "a.ups", "--set", "Time"],
        ["run", "a.ups", "--colour"],
        ["lint"],
        ["lint", "a.ups", "--format", "html"],
        ["convert", "a.uda"],
        ["walk"],
    ],
)
def test_wrong_usage(arguments: list[str]) -> None:
    assert invoke(*arguments).exit_code == 2


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_leaves_a_checkpoint(tmp_path: Path, number: signal.Signals, status: int) -> None:
    path = write(tmp_path, deck(time="", max_time="1000.0"))
    process = started("run", path, "--output", tmp_path / "a")
    history = tmp_path / "a" / "t00004" / "timestep.xml"
    for _ in range(1200):
        if history.exists() or process.poll() is not None:
            break
        time.sleep(0.05)
    process.send_signal(number)
    output, errors = process.communicate(timeout=60)
    assert process.returncode == status, errors
    assert "Traceback" not in errors
    assert f"go on with: ups run --restart {tmp_path}/a" in errors
    assert "interrupted: " in output
    checkpoints = Archive(tmp_path / "a").checkpoints
    assert checkpoints is not None
    reached = checkpoints.timesteps[-1].step
    assert len(Archive(tmp_path / "a").reductions["KineticEnergy"].values) == reached
    on = invoke("run", "--restart", tmp_path / "a", "--max-steps", reached + 2)
    assert on.exit_code == 0, on.output
    assert len(Archive(tmp_path / "a").reductions["KineticEnergy"].values) == reached + 2


# ---- bad input ----

BACKWARDS = """
  <PhysicalBC><MPM><pressure>
    <geom_object><box label="side"><min>[0.69,0.1,0.0]</min><max>[0.7,0.4,0.1]</max></box></geom_object>
    <load_curve><id>1</id><time_point><time>1</time><load>1</load></time_point>
      <time_point><time>0.5</time><load>2</load></time_point></load_curve>
  </pressure></MPM></PhysicalBC>"""
OUTSIDE = material("[5,5,5]", "[6,6,6]", "[0,0,0]")

BAD = {
    "broken XML": (deck().replace("</Time>", "</Tme>"), "UPS003", "did you mean"),
    "unknown tag": (deck().replace("density>", "densty>", 2), "UPS102", "did you mean <density>?"),
    "unknown model": (deck().replace('"hypo_elastic"', '"hypo_elastik"', 1), "UPS209", "mean hypo_elastic?"),
    "value out of range": (deck().replace("heat>5.0<", "heat>-5.0<", 1), "UPS208", "must be greater than 0"),
    "load curve backwards": (deck(extra=BACKWARDS), "UPS", "time"),
    "no particles": (deck(materials=OUTSIDE), "UPS411", "no particles"),
    "unknown variable": (deck(saves=("p.stres",)), "UPS406", "did you mean p.stress?"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_deck_is_said_to_be_bad_at_its_line(tmp_path: Path, name: str) -> None:
    text, code, words = BAD[name]
    path = write(tmp_path, text)
    done = invoke("run", path, "--output", tmp_path / "a.uda")
    assert done.exit_code == 1
    assert f"error[{code}" in done.stderr
    assert words in done.stderr
    assert f"--> {path}:" in done.stderr
    assert "Traceback" not in done.output
    assert not (tmp_path / "a.uda").exists()


def test_missing_files(tmp_path: Path) -> None:
    done = invoke("run", tmp_path / "none.ups")
    assert (done.exit_code, "error[UPS001]" in done.stderr) == (1, True)
    moved = "<type>specified</type><filename>motion.txt</filename>"
    law = CONTACT.replace("<type>single_velocity</type>", moved)
    path = write(tmp_path, deck(materials=LEFT + RIGHT + law))
    done = invoke("run", path, "--output", tmp_path / "a")
    assert (done.exit_code, "error[UPS408]" in done.stderr, "motion.txt" in done.stderr) == (1, True, True)


def test_particles_outside_the_grid(tmp_path: Path) -> None:
    (tmp_path / "cloud.pts").write_text("0.2 0.2 0.05\n7.0 0.2 0.05\n")
    box = LEFT[LEFT.index("<box") : LEFT.index("</box>") + len("</box>")]
    cloud = LEFT.replace(box, "<file><name>cloud.pts</name></file>")
    done = invoke("run", write(tmp_path, deck(materials=cloud)), "--output", tmp_path / "a")
    assert done.exit_code == 1
    assert "error[UPS403]" in done.stderr
    assert "blocks.ups:" in done.stderr


def test_an_archive_that_exists_is_left_alone(tmp_path: Path) -> None:
    path = write(tmp_path)
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "notes.txt").write_text("mine")
    (tmp_path / "empty").mkdir()
    (tmp_path / "file").write_text("mine too")
    for name in ("a", "file"):
        done = invoke("run", path, "--output", tmp_path / name)
        assert done.exit_code == 1
        assert "error[UPS604]" in done.stderr
        assert "exists already; nothing was overwritten" in done.stderr
    assert [f.name for f in (tmp_path / "a").iterdir()] == ["notes.txt"]
    assert (tmp_path / "file").read_text() == "mine too"
    assert invoke("run", path, "--output", tmp_path / "empty", "-q").exit_code == 0


def test_a_run_that_diverges(tmp_path: Path) -> None:
    fast = LEFT.replace("[20.0,3.0,0.0]", "[1e180,0.0,0.0]")
    text = deck(materials=fast + RIGHT + CONTACT).replace("<delt_min>0.0<", "<delt_min>1.0<")
    done = invoke("run", write(tmp_path, text), "--output", tmp_path / "a")
    assert done.exit_code == 1
    assert "error[UPS602]" in done.stderr
    assert "after step 1 at time" in done.stderr
    assert "blocks.ups:8:" in done.stderr
    assert "<timestep_multiplier>" in done.stderr
    assert Archive(tmp_path / "a").timesteps == ()


def test_a_full_disk_leaves_what_was_written(tmp_path: Path) -> None:
    archiver = "<outputTimestepInterval>100</outputTimestepInterval>"
    calm = LEFT.replace("[20.0,3.0,0.0]", "[0.1,0.0,0.0]")
    time = "<max_Timesteps>400</max_Timesteps>"
    path = write(tmp_path, deck(time=time, archiver=archiver, patches="[1,1,1]", materials=calm))
    process = started("run", path, "--output", tmp_path / "a", kilobytes=13)  # the histories grow more
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 1, errors
    assert "error[UPS604]" in errors
    assert "cannot write" in errors
    assert "Traceback" not in errors
    archive = Archive(tmp_path / "a")
    assert [t.step for t in archive.timesteps][:2] == [1, 101]
    assert archive.particles(-1, "p.stress").shape == (36, 3, 3)
    assert len(archive.reductions["KineticEnergy"].values) > 100


# ---- the other commands ----


def test_lint(tmp_path: Path) -> None:
    good = write(tmp_path, name="good.ups")
    bad = write(tmp_path, BAD["unknown tag"][0], name="bad.ups")
    fine = invoke("lint", good)
    assert (fine.exit_code, "0 errors" in fine.stdout) == (0, True)
    text = invoke("lint", good, bad)
    assert text.exit_code == 1
    assert "error[UPS102]: unknown tag <densty>" in text.stdout
    report = json.loads(invoke("lint", bad, "--format", "json").stdout)
    assert report["version"] == 1
    assert {"UPS102"} <= {d["code"] for d in report["diagnostics"]}
    assert invoke("lint", bad, "--format", "github").stdout.startswith("::error file=")
    assert json.loads(invoke("lint", bad, "--format", "sarif").stdout)["version"] == "2.1.0"


def test_convert(tmp_path: Path) -> None:
    assert invoke("run", write(tmp_path), "--output", tmp_path / "a", "-q").exit_code == 0
    done = invoke("convert", tmp_path / "a", tmp_path / "out.csv")
    assert done.exit_code == 0, done.output
    assert all(Path(line).exists() for line in done.stdout.split())
    wrong = invoke("convert", tmp_path / "none", tmp_path / "out.csv")
    assert (wrong.exit_code, "error[UPS603]" in wrong.stderr) == (1, True)


def test_an_internal_error_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*arguments: object, **options: object) -> None:
        raise LookupError("never mind")

    monkeypatch.setattr("ups.session.run_deck", fail)
    done = invoke("run", write(tmp_path))
    assert done.exit_code == 1
    assert done.stderr.startswith("internal error: LookupError: never mind; please report it")
    assert done.stderr.count("\n") == 1


def test_help_has_a_line_for_each_command_and_starts_at_once() -> None:
    heavy = ("numpy", "numba", "lxml", "rich", "pyvista", "ups.deck")
    code = (
        "import sys, cli; cli.main(['--help'], standalone_mode=False); "
        f"print([m for m in {heavy} if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=ENVIRONMENT
    )
    *lines, loaded = done.stdout.splitlines()
    assert loaded == "[]"
    listed = [line.split(maxsplit=1) for line in lines[lines.index("Commands:") + 1 :]]
    assert [name for name, _ in listed] == sorted(file.stem for file in COMMANDS.glob("[a-z]*.py"))


def test_a_run_loads_kernels_and_no_compiler(tmp_path: Path) -> None:
    compiler = ("numba.np.linalg", "numba.typed.listobject", "numba.experimental.jitclass")
    unused = (
        "scipy",
        "yaml",
        "tomllib",
        "mpi4py",
        "rich",
        "pyvista",
        "solver.contact.logistic_regression",
    )
    code = (
        "import sys, cli; cli.main(sys.argv[1:], standalone_mode=False); "
        f"print([m for m in {(*compiler, *unused)} if m in sys.modules])"
    )
    for archive in ("a", "b"):  # the first may compile
        command = [sys.executable, "-c", code, "run", str(write(tmp_path)), "--max-steps", "2"]
        done = subprocess.run(
            [*command, "--output", str(tmp_path / archive)],
            capture_output=True,
            text=True,
            check=True,
            env=ENVIRONMENT,
        )
    assert done.stdout.splitlines()[-1] == "[]"


def test_a_command_is_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "greet.py").write_text(
        'import click\n\n@click.command()\ndef greet() -> None:\n    """Say hello."""\n    click.echo("hello")\n'
    )
    monkeypatch.setattr(ups.commands, "__path__", [*ups.commands.__path__, str(tmp_path)])
    assert invoke("greet").stdout == "hello\n"
    assert "greet      Say hello." in invoke("--help").stdout
    monkeypatch.undo()
    assert invoke("greet").exit_code == 2


def test_a_deck_of_another_method(tmp_path: Path) -> None:
    done = invoke(
        "run", write(tmp_path, deck().replace('type="mpm"', 'type="impm"')), "--output", tmp_path / "a"
    )
    assert done.exit_code == 1
    assert (
        "error[UPS412]: impm: the implicit material point method: this program does not run it" in done.stderr
    )
    assert done.stderr.count("UPS412") == 1
    assert "blocks.ups:4:" in done.stderr
