"""Archives written again: the same bytes, fewer steps, several runs in one."""

import numpy as np
import pytest
from click.testing import CliRunner

from cli import main
from ups.archive import Archive, ArchiveError, ArchiveWriter, Box, Grid, Variable
from ups.convert import Region, convert
from ups.inspect.check import check_archive
from ups.inspect.compare import Tolerances, compare_archives

X = Variable("p.x", "ParticleVariable", "Point")
ENERGY = Variable("KineticEnergy", "ReductionVariable", "double")


@pytest.mark.parametrize("name", ["disks_sulsky", "disks_gzip_2ranks", "mpmice_two_levels"])
def test_every_block_of_sus_stays_as_it_is(sus, tmp_path, name):
    origin = sus(name)
    assert convert(origin, tmp_path / "again.uda") == [tmp_path / "again.uda"]
    files = [*origin.glob("t*/l*/p*"), *origin.glob("*.dat"), origin / "input.xml"]
    assert len(files) > 8
    for file in files:
        assert (tmp_path / "again.uda" / file.relative_to(origin)).read_bytes() == file.read_bytes(), file
    assert check_archive(tmp_path / "again.uda").is_sound
    outcome = compare_archives(origin, tmp_path / "again.uda", Tolerances(0, 0), extra_cells=True)
    assert (outcome.status, outcome.largest) == (0, (0.0, 0.0))
    last = Archive(origin).timesteps[-1]
    again = Archive(tmp_path / "again.uda")
    assert again.timesteps[-1] == last
    assert [s.tag for s in again.sections(last.step)] == [s.tag for s in Archive(origin).sections(last.step)]


def test_some_variables_of_some_steps(archive, tmp_path):
    convert(archive, tmp_path / "b.uda", variables=["damage", "g.mass", "stress:pressure"], steps=[8])
    source, found = Archive(archive), Archive(tmp_path / "b.uda")
    assert [timestep.step for timestep in found.timesteps] == [8]
    assert found.labels(8) == ["p.x", "p.particleID", "p.damage", "g.mass", "p.stress_pressure"]
    assert np.array_equal(found.particles(8, "p.stress_pressure"), source.particles(8, "stress:pressure"))
    assert found.materials(8, "p.damage") == [1]
    assert np.array_equal(
        found.grid_variable(8, "g.mass", 1).values, source.grid_variable(8, "g.mass", 1).values
    )
    assert (
        found.reductions["TotalMomentum"].values.tolist()
        == source.reductions["TotalMomentum"].values.tolist()
    )
    convert(archive, tmp_path / "c.uda", materials=[1])
    assert Archive(tmp_path / "c.uda").materials(3) == [1]


def test_runs_in_one_whose_grids_differ(tmp_path):
    for number, (steps, cells) in enumerate([((1, 2), 2), ((2, 3), 4)]):
        grid = Grid.single_level([Box((0, 0, 0), (cells, 1, 1))], spacing=(2.0 / cells, 1, 1))
        source = ("a.uda.000", 1) if number else None
        with ArchiveWriter.create(
            tmp_path / f"a.uda.00{number}", grid, input_xml="<a/>", restarted_from=source
        ) as writer:
            for step in steps:
                writer.append_reductions(step, step / 10, {ENERGY: {-1: step + number / 2}})
                writer.write_timestep(step, step / 10, 0.1, {X: {0: np.full((step, 3), 0.5)}})
    convert(tmp_path / "a.uda.001", tmp_path / "all.uda")
    found = Archive(tmp_path / "all.uda")
    assert [timestep.step for timestep in found.timesteps] == [1, 2, 3]
    assert [found.grid(step).levels[0].interior.shape[0] for step in (1, 2, 3)] == [2, 4, 4]
    assert found.reductions["KineticEnergy"].values.tolist() == [1, 2.5, 3.5]
    assert check_archive(found.path).is_sound


def test_what_cannot_be_written_again_is_said(archive, tmp_path):
    with pytest.raises(ArchiveError, match="a region cannot be cut out"):
        convert(archive, tmp_path / "b.uda", region=Region((0, 0, 0), (1, 1, 1)))
    (tmp_path / "c.uda").mkdir()
    (tmp_path / "c.uda" / "x").touch()
    done = CliRunner().invoke(main, ["convert", str(archive), str(tmp_path / "c.uda")])
    assert done.exit_code == 1
