"""Archives damaged at any byte: each reading ends with the numbers that were written, or with a diagnostic.

An archive with checksums must hold to this whatever byte of whatever file is changed or cut off. One without, as
sus leaves it, must hold to it wherever a file is cut off; of a changed byte, what is structure is
found, and a changed digit or byte of data is not: it still ends without a traceback.

``UPS_EVERY_BYTE=1 pytest -m slow tests/ups/archive/test_damage.py -s`` goes through every byte and prints the
counts that docs/validation.md tells.
"""

import os
from collections import Counter

import numpy as np
import pytest
from other_programs import without_checksums

from ups.archive import Archive, ArchiveError, ArchiveWriter, Box, Grid, Variable, checksums
from ups.inspect.check import check_archive

X = Variable("p.x", "ParticleVariable", "Point")
MASS = Variable("g.mass", "NCVariable", "double")
ENERGY = Variable("KineticEnergy", "ReductionVariable", "double")
DELT = Variable("delT", "ReductionVariable", "double")

SAMPLES = 10
"""Places in each file of the sampled form."""


def write_small(folder, compression):
    """One step and its checkpoint: two patches, two materials, one of which is empty on the left patch."""
    boxes = Box((0, 0, 0), (2, 1, 1)).split((2, 1, 1))
    grid = Grid.single_level(boxes, spacing=(1.0, 1.0, 1.0), extra_cells=(1, 0, 0), procs=2)
    nodes = grid.levels[0].whole("NCVariable").shape
    with ArchiveWriter.create(folder, grid, input_xml="<a/>", compression=compression) as writer:
        fields = {
            X: {0: np.array([[0.5, 0.5, 0.5], [1.5, 0.25, 0.5]]), 1: np.array([[1.75, 0.5, 0.5]])},
            MASS: {0: np.arange(float(np.prod(nodes))).reshape(nodes)},
        }
        for step in (1, 2, 3):
            writer.append_reductions(step, step / 10, {ENERGY: {-1: step / 7}})
        writer.write_timestep(3, 0.3, 0.1, fields)
        delt, state = {DELT: {-1: 0.1}}, {"a": np.arange(3)}
        writer.write_checkpoint(3, 0.3, 0.1, fields, global_values=delt, state=state)
    return folder


def contents(path):
    """Every number that an archive, or the folder of its checkpoints, gives."""
    found = []
    archive = Archive(path)
    for timestep in archive.timesteps:
        found += [timestep.step, timestep.time, timestep.old_delt]
        for level in archive.grid(timestep.step).levels:
            found += [level.anchor, level.spacing, level.extra_cells, level.periodic, level.patches]
        for variable, by_material in archive.fields(timestep.step).items():
            found += [variable.name, variable.type_name]
            found += [(material, values.tolist()) for material, values in by_material.items()]
        for label, by_material in archive.global_values(timestep.step).items():
            found += [(label, material, value.tolist()) for material, value in by_material.items()]
    for name, history in archive.reductions.items():
        found += [name, history.times.tolist(), history.values.tolist()]
    if path.name == "checkpoints":
        found.append(archive.state(3)["a"].tolist())
    return found


def files_of(origin):
    return sorted(p for p in origin.rglob("*") if p.is_file() and not p.name.startswith("input"))


def damages(raw, every, kind):
    """A file cut off at each length, or changed at each place; at some of them where not `every`."""
    places = (
        range(len(raw)) if every else sorted({*range(0, len(raw), max(1, len(raw) // SAMPLES)), len(raw) - 1})
    )
    for place in places:
        if kind == "cut":
            yield raw[:place]
        else:
            yield raw[:place] + bytes([raw[place] ^ 1]) + raw[place + 1 :]


def try_all(origin, every, kind):
    """Damage each file in turn; count by kind of file what reading gave: refused, the same, or other numbers."""
    counts = Counter()
    for file in files_of(origin):
        tree = origin / "checkpoints" if "checkpoints" in file.parts else origin
        whole, expected = file.read_bytes(), contents(tree)
        for damaged in damages(whole, every, kind):
            file.write_bytes(damaged)
            try:
                outcome = "the same" if contents(tree) == expected else "other numbers"
            except ArchiveError:
                outcome = "refused"
            counts[file.suffix, outcome] += 1
        file.write_bytes(whole)
        assert contents(tree) == expected
    return counts


def tell(counts, title):
    print(f"\n{title}: {sum(counts.values())} damages")
    for (suffix, outcome), count in sorted(counts.items()):
        print(f"  {suffix:7} {outcome:13} {count}")


every_byte = pytest.mark.skipif(
    "UPS_EVERY_BYTE" not in os.environ, reason="takes minutes; set UPS_EVERY_BYTE"
)
EXTENTS = [False, pytest.param(True, marks=[pytest.mark.slow, every_byte])]


@pytest.mark.parametrize("kind", ["cut", "changed"])
@pytest.mark.parametrize("compression", ["", "gzip"])
@pytest.mark.parametrize("every", EXTENTS, ids=lambda every: "every byte" if every else "some bytes")
def test_with_checksums_no_damage_gives_other_numbers(tmp_path, every, compression, kind):
    counts = try_all(write_small(tmp_path / "a", compression), every, kind)
    tell(counts, f"with checksums, {compression or 'plain'}, {kind}")
    assert not any(outcome == "other numbers" for _suffix, outcome in counts)
    assert counts[".xml", "refused"] > 50


@pytest.mark.parametrize("compression", ["", "gzip"])
@pytest.mark.parametrize("every", EXTENTS, ids=lambda every: "every byte" if every else "some bytes")
def test_without_checksums_a_cut_is_found(tmp_path, every, compression):
    counts = try_all(without_checksums(write_small(tmp_path / "a", compression)), every, "cut")
    tell(counts, f"without checksums, {compression or 'plain'}, cut")
    others = {suffix for suffix, outcome in counts if outcome == "other numbers"}
    assert others <= {".dat"}  # a history that ends earlier


@pytest.mark.parametrize("compression", ["", "gzip"])
@pytest.mark.parametrize("every", EXTENTS, ids=lambda every: "every byte" if every else "some bytes")
def test_without_checksums_a_change_is_never_a_traceback(tmp_path, every, compression):
    counts = try_all(without_checksums(write_small(tmp_path / "a", compression)), every, "changed")
    tell(counts, f"without checksums, {compression or 'plain'}, changed")
    if compression:
        assert counts[".data", "other numbers"] == 0  # zlib has its own


def test_mapped_blocks_are_held_against_their_checksums_by_a_check(tmp_path):
    grid = Grid.single_level([Box((0, 0, 0), (1, 1, 1))], spacing=(1, 1, 1))
    with ArchiveWriter.create(tmp_path / "a", grid, input_xml="<a/>") as writer:
        writer.write_timestep(1, 0.1, 0.1, {X: {0: np.full((100_000, 3), 0.5)}})
    data = writer.directory / "t00001" / "l0" / "p00000.data"
    raw = bytearray(data.read_bytes())
    raw[1_234_567] ^= 1
    data.write_bytes(raw)
    assert check_archive(writer.directory, values=False).is_sound
    (problem,) = check_archive(writer.directory).problems
    assert problem.path == data
    assert "p.x of material 0, patch 0 was changed after it was written" in str(problem)


def test_while_a_file_is_replaced_the_sums_of_both_are_right(tmp_path):
    path = tmp_path / "index.xml"
    checksums.save(path, b"new", present=b"old")
    assert checksums.check(path, b"old")
    assert checksums.check(path, b"new")
    assert not checksums.check(path, b"older")
    checksums.save(path, b"new")
    assert not checksums.check(path, b"old")
