"""The commands of the page on archives run, and its table lists the measures that there are."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import ups
from cli import main
from ups.archive import ArchiveWriter, Box, Grid, Variable
from ups.archive.measures import MEASURES
from ups.convert import FORMATS

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "archives.md").read_text()
BLOCKS = re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)
COMMANDS = [line.partition("#")[0].strip() for block in BLOCKS for line in block.splitlines()]
IDENTITY = 4295098368


@pytest.fixture
def disks(tmp_path, monkeypatch):
    """An archive of the variables that the page speaks of, in the present folder."""
    grid = Grid.single_level([Box((0, 0, 0), (20, 20, 1))], spacing=(0.05, 0.05, 0.05))
    points = np.stack(
        [*np.meshgrid(np.arange(0.225, 0.8, 0.05), np.arange(0.225, 0.8, 0.05)), np.full((12, 12), 0.025)], -1
    )
    x = points.reshape(-1, 3)
    with ArchiveWriter.create(tmp_path / "disks.uda", grid, input_xml="<a/>") as writer:
        for step in range(1, 7):
            fields = {
                Variable("p.x", "ParticleVariable", "Point"): x,
                Variable("p.particleID", "ParticleVariable", "long64"): IDENTITY + np.arange(len(x)),
                Variable("p.velocity", "ParticleVariable", "Vector"): x * step,
                Variable("p.stress", "ParticleVariable", "Matrix3"): x[:, :, None] * x[:, None, :] * step,
            }
            energy = {Variable("KineticEnergy", "ReductionVariable", "double"): {-1: 1.0}}
            writer.append_reductions(step, step / 10, energy)
            writer.write_timestep(step, step / 10, 0.1, {v: {0: values} for v, values in fields.items()})
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("command", [command for command in COMMANDS if not command.startswith("ups run")])
def test_a_command(disks, command):
    program, *arguments = shlex.split(command)
    assert program == "ups"
    done = CliRunner().invoke(main, arguments)
    assert done.exit_code == 0, done.output
    for written in re.findall(r"(\S+\.(?:pvd|vtu|csv|npz))$", done.output, re.MULTILINE):
        assert Path(written).is_file()


def test_the_lines_of_python(disks):
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    lines = [line.partition("#")[0].strip() for line in code.splitlines()]
    names = {"ups": ups, "archive": ups.open("disks.uda")}
    values = [eval(line, names) for line in lines if line.startswith("archive.") and ".dataset" not in line]
    assert values[1].shape == (144, 3, 3)
    assert values[3].shape == (6, 1, 3)
    assert len(values) == 6


def test_every_measure_and_format_is_on_the_page():
    assert [name for name in MEASURES if f"`{name}`" not in PAGE] == []
    assert [suffix for suffix in FORMATS if suffix and f"`x{suffix}`" not in PAGE] == []
