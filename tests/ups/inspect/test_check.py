"""Damaged archives: what is wrong is found and named, and what was whole is readable after a repair."""

import shutil

import numpy as np
import pytest
from click.testing import CliRunner
from other_programs import without_checksums

from cli import main
from ups.archive import Archive, ArchiveError
from ups.inspect.check import check_archive, repair_archive


def readable(archive):
    """Everything that the listed steps hold, by step, label and material."""
    opened = Archive(archive)
    return {
        (t.step, variable.name, material): values.copy()
        for t in opened.timesteps
        for variable, by_material in opened.fields(t.step).items()
        for material, values in by_material.items()
    }


@pytest.mark.parametrize("compression", ["", "gzip"])
def test_a_whole_archive_needs_nothing(make, compression):
    archive = make(compression=compression)
    health = check_archive(archive)
    assert health.is_sound
    assert health.whole == [1, 4, 9]
    index = (archive / "index.xml").read_bytes()
    assert repair_archive(archive) == []
    assert (archive / "index.xml").read_bytes() == index


@pytest.mark.parametrize("compression", ["", "gzip"])
@pytest.mark.parametrize("name", ["timestep.xml", "l0/p00000.xml", "l0/p00001.data"])
@pytest.mark.parametrize("kept", [0.0, 0.3, 0.99])
def test_a_crash_in_the_last_step(make, compression, name, kept):
    archive = make(compression=compression)
    before = readable(archive)
    file = archive / "t00009" / name
    raw = file.read_bytes()
    file.write_bytes(raw[: min(len(raw) - 8, int(kept * len(raw)))])
    health = check_archive(archive)
    assert (health.whole, health.damaged) == ([1, 4], [9])
    done = repair_archive(archive)
    assert done[0].startswith("took step 9 off the list: ")
    assert check_archive(archive).is_sound
    after = readable(archive)
    assert set(after) == {key for key in before if key[0] != 9}
    assert all(np.array_equal(values, before[key]) for key, values in after.items())
    assert (archive / "index.xml.damaged").exists()


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        (
            "timestep.xml",
            "<currentTime>0.5<",
            "<currentTime>0.7<",
            "this is time 0.7, but index.xml says 0.5",
        ),
        (
            "l0/p00000.xml",
            "<variable>g.mass<",
            "<variable>g.mast<",
            "g.mast is stored, but index.xml does not",
        ),
        ("l0/p00001.xml", "<index>1<", "<index>3<", "is missing on the patches"),
    ],
)
def test_tables_that_contradict_each_other_are_noticed(make, name, old, new, message):
    archive = without_checksums(make())
    file = archive / "t00004" / name
    assert old in file.read_text()
    file.write_text(file.read_text().replace(old, new, 1))
    health = check_archive(archive)
    assert health.damaged == [4]
    assert any(message in str(problem) for problem in health.problems)


def test_a_missing_file_is_named(make):
    archive = make()
    (archive / "t00004" / "l0" / "p00001.data").unlink()
    health = check_archive(archive, values=False)
    assert health.damaged == [4]
    assert all(problem.path.name == "p00001.data" for problem in health.problems)


def test_damage_inside_a_compressed_block_is_found_by_reading_it(make):
    archive = without_checksums(make(compression="gzip"))
    data = archive / "t00004" / "l0" / "p00000.data"
    raw = bytearray(data.read_bytes())
    raw[20] ^= 0xFF
    data.write_bytes(bytes(raw))
    assert check_archive(archive, values=False).is_sound
    assert check_archive(archive).damaged == [4]


def test_a_table_of_contents_cut_anywhere_is_made_anew(make):
    archive = make()
    before, types = readable(archive), dict(Archive(archive).variables)
    index = (archive / "index.xml").read_bytes()
    for kept in range(0, len(index) - 2, 97):
        (archive / "index.xml").write_bytes(index[:kept])
        assert not check_archive(archive).is_sound
        assert repair_archive(archive)[0].startswith("made index.xml anew")
        after = readable(archive)
        assert after.keys() == before.keys()
        opened = Archive(archive)
        assert opened.variables == types
        assert [(t.time, t.old_delt) for t in opened.timesteps] == [(s / 8, 0.125) for s in (1, 4, 9)]
        assert opened.reductions["TotalMomentum"].values.tolist() == [[1, s, 3] for s in (1, 4, 9)]
        assert opened.index.processes == 2


def test_a_step_that_was_written_but_not_yet_listed(make):
    archive = make()
    index = (archive / "index.xml").read_text().splitlines(keepends=True)
    (archive / "index.xml").write_text("".join(line for line in index if "t00009/" not in line))
    assert any("does not list" in str(problem) for problem in check_archive(archive).problems)
    assert repair_archive(archive) == ["listed step 9, which was whole but not listed"]
    assert [t.step for t in Archive(archive).timesteps] == [1, 4, 9]
    assert check_archive(archive).is_sound


def test_remains_and_unfinished_lines_are_removed(make):
    archive = make()
    shutil.copytree(archive / "t00009", archive / "t00012.partial")
    with (archive / "KineticEnergy.dat").open("a") as file:
        file.write("1.25\t0.0")
    assert "last line is unfinished" in str(check_archive(archive).problems[0])
    repair_archive(archive)
    assert not (archive / "t00012.partial").exists()
    assert (archive / "KineticEnergy.dat").read_text().endswith("1.125\t4.5\n")


def test_checkpoints_are_repaired_too(make):
    archive = make()
    (archive / "checkpoints" / "t00009" / "global.data").write_bytes(b"")
    assert not check_archive(archive).is_sound
    repair_archive(archive)
    opened = Archive(archive)
    assert [t.step for t in opened.timesteps] == [1, 4, 9]
    assert [t.step for t in opened.checkpoints.timesteps] == [4]
    assert check_archive(archive).is_sound


def test_an_archive_without_a_whole_step_cannot_be_repaired(make):
    archive = make(steps=(1,))
    (archive / "t00001" / "timestep.xml").write_text("")
    with pytest.raises(ArchiveError, match="no time step is whole"):
        repair_archive(archive)


def test_every_byte_missing_at_the_end_of_every_file_is_noticed(make):
    archive = make(steps=(1,))
    shutil.rmtree(archive / "checkpoints")
    for file in sorted(archive.rglob("t00001/**/*")):
        if file.is_dir():
            continue
        raw = file.read_bytes()
        for kept in {*range(0, len(raw) - 1, 211), len(raw) - 2}:
            file.write_bytes(raw[:kept])
            health = check_archive(archive)
            assert health.damaged == [1], (file, kept)
        file.write_bytes(raw)


def test_the_command(make):
    archive = make()
    good = CliRunner().invoke(main, ["check", str(archive)])
    assert (good.exit_code, good.output) == (0, "3 whole time steps, 0 damaged\n")
    (archive / "t00009" / "timestep.xml").write_text("<")
    bad = CliRunner().invoke(main, ["check", str(archive)])
    assert bad.exit_code == 1
    assert "t00009/timestep.xml:1: not well-formed XML" in bad.output
    repaired = CliRunner().invoke(main, ["check", str(archive), "--repair"])
    assert repaired.exit_code == 0
    assert repaired.output.endswith("2 whole time steps, 0 damaged\n")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "<anchor>[0, 0, 0]",
            "<anchor>[0, 4, 0]",
            "<lower> is [-0.5, -0.5, 0] where the cells give [-0.5, 3.5, 0]",
        ),
        (
            "<cellspacing>[0.5, ",
            "<cellspacing>[0.25, ",
            "<lower> is [-0.5, -0.5, 0] where the cells give [-0.25",
        ),
        ("<nnodes>30", "<nnodes>31", "<nnodes> is 31 where the cells give 30"),
        ("<totalCells>24", "<totalCells>42", "<totalCells> is 42 where the cells give 24"),
    ],
)
def test_a_changed_number_of_the_grid_is_found_without_checksums(make, old, new, message):
    archive = without_checksums(make())
    file = archive / "t00004" / "timestep.xml"
    assert old in file.read_text()
    file.write_text(file.read_text().replace(old, new, 1))
    health = check_archive(archive)
    assert health.damaged == [4]
    assert any(message in str(problem) for problem in health.problems)


def test_a_history_that_ends_early_is_named(make):
    archive = without_checksums(make(steps=(1, 2, 3, 4, 5, 6)))
    file = archive / "KineticEnergy.dat"
    file.write_text("".join(file.read_text().splitlines(keepends=True)[:4]))
    assert check_archive(archive).is_sound  # two lines may be thinned out
    file.write_text("".join(file.read_text().splitlines(keepends=True)[:3]))
    (problem,) = check_archive(archive).problems
    assert "the history ends at time 0.375, before the last time step" in str(problem)


def test_checksums_tell_which_file_was_changed(make):
    archive = make()
    before = readable(archive)
    file = archive / "t00004" / "timestep.xml"
    file.write_text(file.read_text().replace("<anchor>[0, 0, 0]", "<anchor>[0, 4, 0]"))
    (problem,) = check_archive(archive).problems
    assert problem.path == file
    assert "changed or damaged after it was written" in str(problem)
    assert repair_archive(archive) == [f"took step 4 off the list: {problem.message}"]
    assert check_archive(archive).is_sound
    after = readable(archive)
    assert {key[0] for key in after} == {1, 9}
    assert all(np.array_equal(values, before[key]) for key, values in after.items())


def test_a_changed_table_of_contents_is_made_anew(make):
    archive = make()
    before = readable(archive)
    index = archive / "index.xml"
    index.write_text(index.read_text().replace('time="0.5"', 'time="0.6"'))
    with pytest.raises(ArchiveError, match=r"changed or damaged .* ups check --repair makes"):
        Archive(archive)
    assert repair_archive(archive)[0].startswith("made index.xml anew, as the file was changed")
    assert check_archive(archive).is_sound
    after = readable(archive)
    assert set(after) == set(before)
    assert [timestep.time for timestep in Archive(archive).timesteps] == [1 / 8, 4 / 8, 9 / 8]


def test_a_history_cut_in_the_middle_is_repaired_to_what_is_left(make):
    archive = make(steps=(1, 2, 3))
    file = archive / "KineticEnergy.dat"
    file.write_bytes(file.read_bytes()[:-5])
    assert "the history ends at byte" in str(check_archive(archive).problems[0])
    assert any("KineticEnergy.dat" in action for action in repair_archive(archive))
    assert check_archive(archive).is_sound
    assert len(Archive(archive).reductions["KineticEnergy"].values) == 2
