"""Archives of a run that was taken up again, twice: the series keeps the earlier times."""

import shutil

import numpy as np
import pytest
from click.testing import CliRunner
from lxml import etree

from cli import main
from ups.archive import Archive, ArchiveWriter, Variable
from ups.convert import convert

X = Variable("p.x", "ParticleVariable", "Point")
MASS = Variable("p.mass", "ParticleVariable", "double")
ID = Variable("p.particleID", "ParticleVariable", "long64")
ENERGY = Variable("KineticEnergy", "ReductionVariable", "double")


def write(path, grid, steps, source=None, mass=0.0):
    with ArchiveWriter.create(path, grid, input_xml="<a/>", restarted_from=source) as writer:
        for step in steps:
            fields = {X: {0: [[0.5, 0.5, 0.2]]}, MASS: {0: [mass + step]}, ID: {0: [7]}}
            writer.append_reductions(step, step / 10, {ENERGY: {-1: mass + step}})
            writer.write_timestep(step, step / 10, 0.1, fields)


@pytest.fixture
def chain(tmp_path, grid):
    """Steps 1 to 6, taken up from 4 with steps 5 to 8, taken up from 7 with steps 8 and 9."""
    write(tmp_path / "bar.uda.000", grid, range(1, 7))
    write(tmp_path / "bar.uda.001", grid, range(5, 9), ("bar.uda.000", 4), mass=100.0)
    write(
        tmp_path / "bar.uda.002", grid, range(8, 10), (str(tmp_path / "gone" / "bar.uda.001"), 7), mass=200.0
    )
    return tmp_path / "bar.uda.002"


def test_steps_and_histories_of_all_runs(chain):
    archive = Archive(chain).with_earlier_runs()
    assert [timestep.step for timestep in archive.timesteps] == list(range(1, 10))
    due = [1, 2, 3, 4, 105, 106, 107, 208, 209]
    assert [archive.particles(step, "p.mass")[0] for step in range(1, 10)] == due
    history = archive.reductions["KineticEnergy"]
    assert history.values.tolist() == due
    assert history.times == pytest.approx(np.arange(1, 10) / 10)
    assert archive.follow("p.mass", [7]).values[:, 0].tolist() == due
    assert archive.problems(2) == []
    assert [timestep.step for timestep in Archive(chain).timesteps] == [8, 9]


def test_a_converted_series_keeps_the_earlier_times(chain, tmp_path):
    def times(path):
        return [float(item.get("timestep")) for item in etree.parse(path).getroot().iter("DataSet")]

    (series,) = convert(chain, tmp_path / "out.pvd")
    assert times(series) == pytest.approx(np.arange(1, 10) / 10)
    (series,) = convert(chain, tmp_path / "own.pvd", alone=True)
    assert times(series) == [0.8, 0.9]
    said = CliRunner().invoke(main, ["extract", str(chain), "p.mass", "--particle", "7"])
    assert said.output.splitlines()[1].startswith("1,0.10")
    assert len(said.output.splitlines()) == 10
    said = CliRunner().invoke(main, ["extract", str(chain), "p.mass", "--particle", "7", "--alone"])
    assert len(said.output.splitlines()) == 3


def test_what_is_gone_is_left_out(chain, tmp_path):
    shutil.rmtree(tmp_path / "bar.uda.000")
    archive = Archive(chain).with_earlier_runs()
    assert [timestep.step for timestep in archive.timesteps] == [5, 6, 7, 8, 9]
    shutil.rmtree(tmp_path / "bar.uda.001")
    assert Archive(chain).with_earlier_runs().timesteps == Archive(chain).timesteps


def test_archives_that_name_each_other_or_themselves_do_not_loop(tmp_path, grid):
    write(tmp_path / "a", grid, [1, 2], ("b", 5))
    write(tmp_path / "b", grid, [6, 7], ("a", 2))
    write(tmp_path / "c", grid, [1, 2], ("c", 1))
    assert [t.step for t in Archive(tmp_path / "b").with_earlier_runs().timesteps] == [1, 2, 6, 7]
    assert [t.step for t in Archive(tmp_path / "c").with_earlier_runs().timesteps] == [1, 2]
