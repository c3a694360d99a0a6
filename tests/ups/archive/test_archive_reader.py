"""Reading what sus and the writer wrote, archives of other ages, and damaged ones."""

import io
import itertools
import re
import shutil
import struct
import zlib
from dataclasses import astuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from other_programs import without_checksums

from ups.archive import Archive, ArchiveError, ArchiveWriter, Box, Grid, Level, Patch, Variable
from ups.archive.variables import ELEMENTS

NAMES = ("disks_sulsky", "disks_gzip_2ranks", "mpmice_two_levels")


def raw_blocks(step_folder, label, material, level=0):
    """Return (patch, number of particles, plain bytes) of a variable; knows nothing of the package."""
    found = []
    for table in sorted((step_folder / f"l{level}").glob("p*.xml")):
        for body in re.findall(r"<Variable .*?</Variable>", table.read_text(), re.DOTALL):
            tags = dict(re.findall(r"<(\w+)>([^<]*)</", body))
            if tags["variable"] != label or int(tags["index"]) != material:
                continue
            data = (table.parent / tags["filename"]).read_bytes()[int(tags["start"]) : int(tags["end"])]
            plain = zlib.decompress(data[8:]) if "compression" in tags else data
            found.append((int(tags["patch"]), int(tags.get("numParticles", 0)), plain))
    return sorted(found)


@pytest.mark.parametrize("name", ["disks_sulsky", "disks_gzip_2ranks"])
@pytest.mark.parametrize(
    ("label", "width"), [("p.x", 3), ("p.volume", 1), ("p.velocity", 3), ("p.stress", 9)]
)
def test_particles_are_the_bytes_that_sus_wrote(sus, name, label, width):
    archive = Archive(sus(name))
    for timestep in archive.timesteps:
        found = raw_blocks(archive.path / f"t{timestep.step:05d}", label, 0)
        expected = [value for _patch, _n, raw in found for (value,) in struct.iter_unpack("<d", raw)]
        values = archive.particles(timestep.step, label, 0)
        assert len(expected) == 832 * width
        assert values.reshape(-1).tolist() == expected


def test_the_disks_of_sus_have_the_numbers_of_their_history(sus):
    """Mass and momentum of the particles are those that sus summed over the grid."""
    archive = Archive(sus("disks_sulsky"))
    checkpoint = archive.checkpoints
    step = checkpoint.timesteps[-1].step
    mass = checkpoint.particles(step, "p.mass", 0)
    velocity = checkpoint.particles(step, "p.velocity", 0)
    history = archive.reductions
    at = np.flatnonzero(history["TotalMass"].times == checkpoint.timesteps[-1].time)[0]
    assert step == 151
    assert mass.sum() == pytest.approx(history["TotalMass"].values[at], rel=1e-14)
    assert mass @ velocity == pytest.approx(history["TotalMomentum"].values[at], abs=1e-12)
    assert archive.grid_variable(step, "g.mass", 0).values.sum() == pytest.approx(13.0, rel=1e-12)


def test_nodes_of_all_patches_are_put_together(sus):
    archive = Archive(sus("disks_sulsky"))
    field = archive.grid_variable(51, "g.mass", 0)
    assert field.values.shape == (21, 21, 2)
    assert field.origin == (0, 0, 0)
    blocks = {patch: raw for patch, _n, raw in raw_blocks(archive.path / "t00051", "g.mass", 0)}
    sizes = {0: (10, 10, 2), 1: (10, 11, 2), 2: (11, 10, 2), 3: (11, 11, 2)}
    starts = {0: (0, 0), 1: (0, 10), 2: (10, 0), 3: (10, 10)}
    for patch, (nx, ny, nz) in sizes.items():
        numbers = iter(struct.unpack(f"<{nx * ny * nz}d", blocks[patch]))
        x0, y0 = starts[patch]
        for k in range(nz):
            for j in range(ny):
                for i in range(nx):
                    assert field.values[x0 + i, y0 + j, k] == next(numbers)


def test_matrices_on_the_grid_keep_their_rows(sus):
    archive = Archive(sus("disks_gzip_2ranks"))
    values = archive.grid_variable(41, "g.stressFS", 0).values
    (_patch, _n, raw) = raw_blocks(archive.path / "t00041", "g.stressFS", 0)[0]
    first_patch = np.array(struct.unpack(f"<{10 * 10 * 2 * 9}d", raw)).reshape(2, 10, 10, 3, 3)
    assert np.any(first_patch)
    assert np.array_equal(values[:10, :10], first_patch.transpose(2, 1, 0, 3, 4))


def test_levels_and_cells_of_sus(sus):
    archive = Archive(sus("mpmice_two_levels"))
    grid = archive.grid(-1)
    assert len(grid.levels) == 2
    assert [len(level.patches) for level in grid.levels] == [8, len(grid.levels[1].patches)]
    for level in (0, 1):
        field = archive.grid_variable(7, "press_CC", 0, level)
        assert field.values.shape == grid.levels[level].whole("CCVariable").shape
        assert field.coordinates[0][0] == pytest.approx(
            grid.levels[level].anchor[0] + (field.origin[0] + 0.5) * grid.levels[level].spacing[0]
        )
        (_patch, _n, raw) = raw_blocks(archive.path / "t00007", "press_CC", 0, level)[0]
        box = grid.levels[level].extent(0, "CCVariable")
        assert struct.unpack("<d", raw[:8])[0] == field.values[box.within(field.origin)][0, 0, 0]
        assert struct.unpack("<d", raw[-8:])[0] == field.values[box.within(field.origin)][-1, -1, -1]
    assert archive.materials(7, "vel_CC") == [0, 1]
    assert archive.materials(7, "p.x") == archive.materials(7, "p.x", level=1)
    assert archive.particle_count(7, archive.materials(7, "p.x")[0]) == len(archive.particles(7, "p.x"))


def test_checkpoints_hold_globals_and_components(sus):
    archive = Archive(sus("disks_gzip_2ranks")).checkpoints
    assert [timestep.step for timestep in archive.timesteps] == [21, 41]
    raw = (archive.path / "t00041" / "global.data").read_bytes()
    expected = struct.unpack("<d", zlib.decompress(raw[8:]))[0]
    assert archive.global_values(41)["delT"][-1] == expected
    assert [section.tag for section in archive.sections(41)] == ["MPM", "MaterialProperties", "PhysicalBC"]


def test_histories_of_sus(sus):
    archive = Archive(sus("disks_sulsky"))
    energy = archive.reductions["KineticEnergy"]
    words = [line.split() for line in (archive.path / "KineticEnergy.dat").read_text().splitlines()]
    assert energy.times.tolist() == [float(word) for word, _value in words]
    assert energy.values.tolist() == [float(value) for _time, value in words]
    assert archive.reductions["TotalMomentum"].values.shape == (len(words), 3)
    assert set(archive.reductions) == {
        "KineticEnergy",
        "TotalMass",
        "StrainEnergy",
        "CenterOfMassPosition",
        "TotalMomentum",
    }


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("tree", [".", "checkpoints"])
def test_an_archive_of_sus_written_again_is_the_same_bytes(sus, tmp_path, name, tree):
    archive = Archive(sus(name) / tree)
    grid = archive.grid(archive.timesteps[0].step)
    with ArchiveWriter.create(tmp_path / "again", grid, input_xml="<a/>") as writer:
        for timestep in archive.timesteps:
            fields = [archive.fields(timestep.step, level.index) for level in grid.levels]
            writer.write_timestep(timestep.step, timestep.time, timestep.old_delt, fields)
    for timestep in archive.timesteps:
        originals = sorted((archive.path / f"t{timestep.step:05d}").glob("l*/p*"))
        assert len(originals) >= 2
        for original in originals:
            again = tmp_path / "again" / original.relative_to(archive.path)
            assert again.read_bytes() == original.read_bytes(), original
    for pattern in ("<timestep .*", "<variable type.*"):
        lines = [
            set(re.findall(pattern, (folder / "index.xml").read_text()))
            for folder in (archive.path, writer.directory)
        ]
        assert lines[0] - lines[1] <= {line for line in lines[0] if "delT" in line}


@pytest.mark.parametrize("name", NAMES)
def test_a_checkpoint_of_sus_written_again_is_the_same_bytes(sus, tmp_path, name):
    checkpoints = Archive(sus(name)).checkpoints
    types = {listed.name: listed.type_name for listed in checkpoints.index.globals_}
    grid = checkpoints.grid()
    with ArchiveWriter.create(tmp_path / "again", grid, input_xml="<a/>") as writer:
        for step, time, old_delt, _href in (astuple(timestep) for timestep in checkpoints.timesteps):
            fields = [checkpoints.fields(step, level.index) for level in grid.levels]
            packed = {"gzip"} & {variable.compression for level in fields for variable in level}
            kept = {
                Variable.from_type(label, types[label], *packed): by_material
                for label, by_material in checkpoints.global_values(step).items()
            }
            writer.write_checkpoint(step, time, old_delt, fields, global_values=kept)
    compared = [*checkpoints.path.glob("t*/l*/p*"), *checkpoints.path.glob("t*/global.*")]
    assert len(compared) >= 8
    for original in compared:
        again = tmp_path / "again" / "checkpoints" / original.relative_to(checkpoints.path)
        assert again.read_bytes() == original.read_bytes(), original


ELEMENT_NAMES = sorted(ELEMENTS)


def random_values(element, outer, seed):
    random = np.random.default_rng(seed)
    shape = (*outer, *element.shape)
    if element.dtype.kind == "f":
        return random.normal(size=shape).astype(element.dtype)
    limits = np.iinfo(element.dtype)
    return random.integers(limits.min, limits.max, size=shape, dtype=element.dtype, endpoint=True)


@st.composite
def grids(draw):
    parts = tuple(draw(st.integers(1, 2)) for _ in range(3))
    cells = tuple(n * draw(st.integers(1, 2)) for n in parts)
    periodic = tuple(draw(st.booleans()) for _ in range(3))
    return Grid.single_level(
        Box((0, 0, 0), cells).split(parts),
        spacing=(0.5, 0.25, 1.0),
        extra_cells=tuple(0 if p else draw(st.integers(0, 1)) for p in periodic),
        periodic=periodic,
        procs=draw(st.integers(1, 2)),
    )


@settings(max_examples=40, deadline=None)
@given(
    grids(),
    st.sampled_from(ELEMENT_NAMES),
    st.sampled_from(["NCVariable", "CCVariable", "SFCXVariable", "SFCYVariable", "SFCZVariable", "PerPatch"]),
    st.sampled_from(["", "gzip"]),
    st.integers(0, 2**32 - 1),
)
def test_grid_variables_come_back(tmp_path_factory, grid, element, container, compression, seed):
    level = grid.levels[0]
    variable = Variable("v", container, element, compression)
    outer = (len(level.patches),) if container == "PerPatch" else level.whole(container).shape
    values = {m: random_values(ELEMENTS[element], outer, seed + m) for m in (0, 3)}
    with ArchiveWriter.create(tmp_path_factory.mktemp("a") / "a", grid, input_xml="<a/>") as writer:
        writer.write_timestep(5, 1.5, 0.25, {variable: values})
    archive = Archive(writer.directory)
    assert archive.grid(5) == grid
    assert archive.variables["v"].type_name == variable.type_name
    for material, expected in values.items():
        if container == "PerPatch":
            assert np.array_equal(archive.per_patch(5, "v", material), expected)
        else:
            assert np.array_equal(archive.grid_variable(5, "v", material).values, expected)


@settings(max_examples=40, deadline=None)
@given(
    grids(),
    st.sampled_from(ELEMENT_NAMES),
    st.sampled_from(["", "gzip"]),
    st.lists(st.integers(0, 9), min_size=1, max_size=3),
    st.integers(0, 2**32 - 1),
)
def test_particles_come_back(tmp_path_factory, grid, element, compression, counts, seed):
    random = np.random.default_rng(seed)
    high = grid.levels[0].bounds(grid.levels[0].interior)[1]
    positions = {m: random.uniform(0.0, high, size=(n, 3)) for m, n in enumerate(counts)}
    values = {m: random_values(ELEMENTS[element], (n,), seed + m) for m, n in enumerate(counts)}
    fields = {
        Variable("p.x", "ParticleVariable", "Point"): positions,
        Variable("v", "ParticleVariable", element): values,
    }
    where = tmp_path_factory.mktemp("a") / "a"
    with ArchiveWriter.create(where, grid, input_xml="<a/>", compression=compression) as writer:
        writer.write_timestep(5, 1.5, 0.25, fields)
    archive = Archive(where)
    for material, expected in values.items():
        stored, points = archive.particles(5, "v", material), archive.particles(5, "p.x", material)
        assert len(stored) == archive.particle_count(5, material) == counts[material]
        order = [int(np.flatnonzero((positions[material] == point).all(axis=1))[0]) for point in points]
        assert np.array_equal(stored, expected[order])
        owners = grid.levels[0].patch_of_position(points)
        assert (np.diff(owners) >= 0).all()
    assert len(archive.particles(5, "v")) == sum(counts)


X = Variable("p.x", "ParticleVariable", "Point")
ID = Variable("p.particleID", "ParticleVariable", "long64")
FLAG = Variable("p.localizedMPM", "ParticleVariable", "int")
MASS = Variable("g.mass", "NCVariable", "double")
NORMAL = Variable("g.normal", "NCVariable", "Vector")
ENERGY = Variable("KineticEnergy", "ReductionVariable", "double")


def write_small(folder, compression="", *, checksums=False):
    """Write two steps on two patches; the second material is empty on the left patch."""
    boxes = Box((0, 0, 0), (2, 1, 1)).split((2, 1, 1))
    grid = Grid.single_level(boxes, spacing=(1.0, 1.0, 1.0), extra_cells=(1, 0, 0))
    nodes = grid.levels[0].whole("NCVariable").shape
    with ArchiveWriter.create(folder, grid, input_xml="<a/>", compression=compression) as writer:
        for step in (1, 2):
            fields = {
                X: {
                    0: np.array([[0.5, 0.5, 0.5], [1.5, 0.25, 0.5]]) + step / 8,
                    1: np.array([[1.75, 0.5, 0.5]]),
                },
                ID: {0: np.array([7, 1 << 40]), 1: np.array([9])},
                FLAG: {0: np.array([0, -1]), 1: np.array([2])},
                MASS: {0: np.arange(np.prod(nodes), dtype=float).reshape(nodes) * step},
                NORMAL: {0: np.arange(3.0 * np.prod(nodes)).reshape((*nodes, 3)) - step},
            }
            writer.append_reductions(step, step / 10, {ENERGY: {-1: step}})
            writer.write_timestep(step, step / 10, 0.1, fields)
            state = {"a": np.arange(3)}
            writer.write_checkpoint(
                step, step / 10, 0.1, fields, global_values={DELT: {-1: 0.1}}, state=state
            )
    return folder if checksums else without_checksums(folder)


DELT = Variable("delT", "ReductionVariable", "double")


def everything(path):
    """Return all that an archive holds as one list of arrays."""
    found = []
    for archive in filter(None, (Archive(path), Archive(path).checkpoints)):
        found += [np.array([t.step, t.time, t.old_delt]) for t in archive.timesteps]
        for timestep in archive.timesteps:
            for label in archive.labels(timestep.step):
                for material in archive.materials(timestep.step, label):
                    if label.startswith("p."):
                        found.append(archive.particles(timestep.step, label, material))
                    else:
                        found.append(archive.grid_variable(timestep.step, label, material).values)
            found += [
                np.asarray(v) for by in archive.global_values(timestep.step).values() for v in by.values()
            ]
        found += [history.values for history in archive.reductions.values()]
    return found


def same(left, right):
    return len(left) == len(right) and all(np.array_equal(a, b) for a, b in zip(left, right, strict=True))


def swap_bytes(path):
    """Turn a plain little-endian archive into the big-endian one of another machine."""
    widths = {"Point": 8, "Vector": 8, "double": 8, "long64": 8, "int": 4}
    for table in list(path.glob("**/l0/p*.xml")) + list(path.glob("**/global.xml")):
        data = bytearray((table.with_suffix(".data")).read_bytes())
        for body in re.findall(r"<Variable .*?</Variable>", table.read_text(), re.DOTALL):
            element = re.search(r"&lt;(\w+)&gt;", body)[1]
            start, end = (int(re.search(rf"<{tag}>(\d+)<", body)[1]) for tag in ("start", "end"))
            stored = np.frombuffer(bytes(data[start:end]), dtype=f"V{widths[element]}")
            data[start:end] = b"".join(item.tobytes()[::-1] for item in stored)
        table.with_suffix(".data").write_bytes(data)
    for text in [*path.glob("**/index.xml"), *path.glob("**/timestep.xml")]:
        text.write_text(text.read_text().replace("little_endian", "big_endian"))


def edit(path, old, new, count=-1):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, count))


def test_archives_of_big_endian_machines_are_read(tmp_path):
    expected = everything(write_small(tmp_path / "a"))
    swap_bytes(tmp_path / "a")
    assert same(everything(tmp_path / "a"), expected)
    assert Archive(tmp_path / "a").particles(1, "p.x").dtype == np.dtype("=f8")


def test_a_compressed_archive_holds_the_same(tmp_path):
    plain, packed = write_small(tmp_path / "a"), write_small(tmp_path / "b", "gzip")
    assert same(everything(packed), everything(plain))


def test_large_blocks_are_mapped_not_copied(tmp_path):
    grid = Grid.single_level([Box((0, 0, 0), (1, 1, 1))], spacing=(1, 1, 1))
    points = np.random.default_rng(1).uniform(size=(100_000, 3))
    with ArchiveWriter.create(tmp_path / "a", grid, input_xml="<a/>") as writer:
        writer.write_timestep(1, 0.1, 0.1, {X: {0: points}})
    values = Archive(writer.directory).particles(1, "p.x")
    assert np.array_equal(values, points)
    assert not values.flags.owndata
    assert not values.flags.writeable


def test_an_archive_of_another_age_may_lack_tags(tmp_path):
    expected = everything(write_small(tmp_path / "a", "gzip"))
    index = tmp_path / "a" / "index.xml"
    edit(index, ' numMaterials="2"', "")
    edit(index, ' oldDelt="0.10000000000000001"', "")
    edit(index, "  <ParticlePosition>p.x</ParticlePosition>\n  <outputFormat>UDA</outputFormat>\n", "")
    for table in (tmp_path / "a").glob("t*/l0/p*.xml"):
        # the tag of an empty compressed block missing, its bytes too
        text, count = re.subn(
            r"<start>(\d+)</start>\n(.*<numParticles>0</numParticles>\n).*<compression>.*\n(.*)<end>\d+</end>",
            r"<start>\1</start>\n\2\3<end>\1</end>",
            table.read_text(),
        )
        assert count == 3
        table.write_text(text)
    for timestep in (tmp_path / "a").glob("t*/timestep.xml"):
        edit(timestep, "    <oldDelt>0.10000000000000001</oldDelt>\n", "")
    found = everything(tmp_path / "a")
    assert same(found[2:], expected[2:])
    assert [timestep.old_delt for timestep in Archive(tmp_path / "a").timesteps] == [0, 0]


def test_missing_entries_of_empty_patches_are_forgiven(tmp_path):
    expected = everything(write_small(tmp_path / "a"))
    for table in (tmp_path / "a").glob("t*/l0/p*.xml"):
        text, count = re.subn(
            r"  <Variable [^\0]*?</Variable>\n",
            lambda match: "" if "<numParticles>0<" in match[0] else match[0],
            table.read_text(),
        )
        assert count > 3
        table.write_text(text)
    assert same(everything(tmp_path / "a"), expected)


def test_a_missing_entry_of_a_patch_with_particles_is_not(tmp_path):
    write_small(tmp_path / "a")
    table = tmp_path / "a" / "t00001" / "l0" / "p00000.xml"
    text = re.sub(
        r"  <Variable [^\0]*?</Variable>\n",
        lambda match: (
            "" if re.search(r">p.particleID<[^\0]*<index>0<[^\0]*<patch>1<", match[0]) else match[0]
        ),
        table.read_text(),
    )
    table.write_text(text)
    with pytest.raises(
        ArchiveError, match=r"p\.particleID of material 0 is missing on patch 1 with 1 particles"
    ):
        Archive(tmp_path / "a").particles(1, "p.particleID", 0)


def move_grid(path, write):
    """Move the grid of each step into a grid.xml, as other versions of Uintah wrote it."""
    for file in path.glob("**/timestep.xml"):
        text = file.read_text()
        grid = re.search(r"  <Grid>.*</Grid>\n", text, re.DOTALL)[0]
        file.write_text(text.replace(grid, ""))
        write(file.with_name("grid.xml"), grid)


def test_a_grid_beside_the_step_as_text(tmp_path):
    expected = everything(write_small(tmp_path / "a"))
    move_grid(tmp_path / "a", lambda path, grid: path.write_text('<?xml version="1.0"?>\n' + grid))
    assert same(everything(tmp_path / "a"), expected)


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_grid_beside_the_step_in_binary(tmp_path, order):
    expected = everything(write_small(tmp_path / "a"))
    packed = struct.pack(order + "Ii", 0xDEADBEEF, 1)
    packed += struct.pack(order + "iq3i3d3ii3d", 2, 4, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1)
    for number in (0, 1):
        low, high = (-1, 0, 0), (1, 1, 1)
        packed += struct.pack(order + "ii6i", number, 0, *low, *high)
        packed += struct.pack(order + "6i", number, 0, 0, number + 1, 1, 1)
        packed += struct.pack(order + "i6di", 8, 0, 0, 0, 1, 1, 1, 2)
    packed += struct.pack(order + "I", 0xDEADBEEF)
    move_grid(tmp_path / "a", lambda path, _grid: path.write_bytes(packed))
    assert same(everything(tmp_path / "a"), expected)
    for length in range(4, len(packed)):
        (tmp_path / "a" / "t00001" / "grid.xml").write_bytes(packed[:length])
        with pytest.raises(ArchiveError, match=r"grid\.xml \(byte \d+\): the "):
            Archive(tmp_path / "a").grid(1)


def test_a_boundary_layer_of_a_variable(tmp_path):
    """One patch of 2 cells without extra cells, one variable stored with a layer of one."""
    write_small(tmp_path / "a")
    folder = tmp_path / "a" / "t00001"
    edit(folder / "timestep.xml", "<extraCells>[1, 0, 0]</extraCells>", "<extraCells>[0, 0, 0]</extraCells>")
    table = folder / "l0" / "p00000.xml"
    text = re.sub(
        r"(NCVariable[^\0]*?</patch>)", r"\1<boundaryLayer>[1, 0, 0]</boundaryLayer>", table.read_text()
    )
    table.write_text(text)
    field = Archive(tmp_path / "a").grid_variable(1, "g.mass", 0)
    assert field.values.shape == (5, 2, 2)
    assert field.origin == (-1, 0, 0)
    assert field.values.reshape(-1).tolist() == list(range(20))


def test_levels_that_do_not_fill_their_box_are_padded_with_nan(tmp_path):
    coarse = Level(0, (0, 0, 0), (2, 2, 2), (0, 0, 0), (False,) * 3, (Patch(0, 0, (0, 0, 0), (2, 2, 1)),))
    patches = (Patch(1, 0, (0, 0, 0), (2, 2, 2)), Patch(2, 0, (2, 2, 0), (4, 4, 2)))
    fine = Level(1, (0, 0, 0), (1, 1, 1), (0, 0, 0), (False,) * 3, patches)
    pressure = Variable("press_CC", "CCVariable", "double")
    count = Variable("n_CC", "CCVariable", "int")
    with ArchiveWriter.create(tmp_path / "a", Grid((coarse, fine)), input_xml="<a/>") as writer:
        first = {pressure: {0: np.ones((2, 2, 1))}, count: {0: np.ones((2, 2, 1), dtype=int)}}
        second = {pressure: {0: np.full((4, 4, 2), 2.0)}, count: {0: np.full((4, 4, 2), 2)}}
        writer.write_timestep(1, 0.1, 0.1, [first, second])
    archive = Archive(writer.directory)
    values = archive.grid_variable(1, "press_CC", 0, level=1).values
    assert values[:2, :2].tolist() == values[2:, 2:].tolist() == np.full((2, 2, 2), 2.0).tolist()
    assert np.isnan(values[:2, 2:]).all()
    assert not archive.grid_variable(1, "n_CC", 0, level=1).values[:2, 2:].any()


def test_a_variable_of_an_unknown_type_does_not_hide_the_others(tmp_path):
    write_small(tmp_path / "a")
    edit(tmp_path / "a" / "index.xml", "NCVariable&lt;Vector&gt;", "NCVariable&lt;Quaternion&gt;")
    edit(
        tmp_path / "a" / "t00001" / "l0" / "p00000.xml",
        "NCVariable&lt;Vector&gt;",
        "NCVariable&lt;Quaternion&gt;",
    )
    archive = Archive(tmp_path / "a")
    assert archive.unsupported == {"g.normal": "NCVariable<Quaternion>"}
    assert "g.normal" not in archive.variables
    assert archive.grid_variable(1, "g.mass", 0).values.size == 20
    with pytest.raises(ArchiveError, match="unknown element 'Quaternion'"):
        archive.grid_variable(1, "g.normal", 0)


def test_a_sole_variable_called_int_may_be_a_double(tmp_path):
    write_small(tmp_path / "a")
    edit(
        tmp_path / "a" / "checkpoints" / "t00001" / "global.xml",
        "ReductionVariable&lt;double",
        "SoleVariable&lt;int",
    )
    edit(tmp_path / "a" / "checkpoints" / "index.xml", "ReductionVariable&lt;double", "SoleVariable&lt;int")
    assert Archive(tmp_path / "a").checkpoints.global_values(1)["delT"][-1] == 0.1


def test_steps_are_named_by_number_or_from_the_end(tmp_path):
    archive = Archive(write_small(tmp_path / "a") / "index.xml")
    assert archive.timestep(-1).step == archive.timestep(2).step == 2
    assert archive.timestep(-2).time == 0.1
    assert archive.particles(2, "p.x", material=1, patch=1).tolist() == [[1.75, 0.5, 0.5]]
    assert archive.particles(2, "p.x", material=1, patch=0).shape == (0, 3)
    assert len(archive.particles(-1, "p.particleID")) == 3
    assert repr(archive).endswith("2 time steps)")


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda a: a.timestep(7), "time step 7 is not stored; there are: 1, 2"),
        (lambda a: a.timestep(-3), "there are only 2 time steps"),
        (
            lambda a: a.particles(1, "p.stress"),
            r"no variable p\.stress at step 1; there are: p\.x, p\.particleID",
        ),
        (
            lambda a: a.particles(1, "p.x", 4),
            r"p\.x is not stored for material 4 at step 1; its materials are: 0, 1",
        ),
        (lambda a: a.particles(1, "g.mass", 0), "not on particles"),
        (lambda a: a.grid_variable(1, "p.x", 0), "missing on the patches|not on the grid"),
        (lambda a: a.grid_variable(1, "g.mass", 0, level=3), "there is no level 3"),
        (lambda a: a.grid_variable(1, "g.mass", 5), "its materials are: 0"),
        (lambda a: a.state(1), "holds no state of this program"),
    ],
)
def test_asking_for_what_is_not_there(tmp_path, ask, message):
    archive = Archive(write_small(tmp_path / "a"))
    with pytest.raises(ArchiveError, match=message):
        ask(archive)


def test_a_folder_that_is_no_archive(tmp_path):
    with pytest.raises(ArchiveError, match=r"there is no index\.xml"):
        Archive(tmp_path)


def test_a_history_that_is_damaged_is_named(tmp_path):
    archive = Archive(write_small(tmp_path / "a"))
    path = tmp_path / "a" / "KineticEnergy.dat"
    for text, message in (
        ("0.1\t1\n0.2\tx\n", r":2: '0.2\\tx' is not"),
        ("0.1\t1\n0.2\n", ":2: 1 numbers where"),
    ):
        path.write_text(text)
        with pytest.raises(ArchiveError, match=message):
            archive.reductions["KineticEnergy"]
    path.write_text("0.1\t1\n0.2\t")
    assert archive.reductions["KineticEnergy"].values.tolist() == [1.0]
    path.unlink()
    with pytest.raises(ArchiveError, match="No such file"):
        Archive(tmp_path / "a").reductions["KineticEnergy"]


def test_an_archive_expands_no_entity(tmp_path):
    write_small(tmp_path / "a")
    (tmp_path / "secret").write_text("1")
    index = tmp_path / "a" / "index.xml"
    entity = (
        f'<!DOCTYPE Uintah_DataArchive [<!ENTITY s SYSTEM "file://{tmp_path}/secret">]>\n<Uintah_DataArchive>'
    )
    edit(index, "<Uintah_DataArchive>", entity, 1)
    edit(index, ">1</timestep>", ">&s;</timestep>")
    with pytest.raises(ArchiveError, match="'' in <timestep> is not an integer"):
        Archive(tmp_path / "a")


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        ("index.xml", "<Uintah_DataArchive>", "<Uintah_Other>", "not well-formed XML"),
        (
            "index.xml",
            "little_endian",
            "middle_endian",
            r"index\.xml:\d+: unknown byte order 'middle_endian'",
        ),
        ("index.xml", "<nBits>64", "<nBits>65", "unknown address width 65"),
        ("index.xml", "<outputFormat>UDA", "<outputFormat>PIDX", "PIDX"),
        ("index.xml", 'time="0.1', 'time="zero', "not a number"),
        ("index.xml", 'href="t00001/timestep.xml"', "", "no attribute href"),
        ("t00001/timestep.xml", "<id>1</id>", "<id>2</id>", "patch 2 stands where patch 1 is due"),
        ("t00001/timestep.xml", "<numPatches>2", "<numPatches>3", "3 patches are announced, 2 described"),
        ("t00001/timestep.xml", "<numLevels>1", "<numLevels>2", "2 levels are announced, 1 described"),
        ("t00001/timestep.xml", "<timestepNumber>1", "<timestepNumber>2", "index.xml lists it as step 1"),
        ("t00001/timestep.xml", "<anchor>[0, 0, 0]", "<anchor>[0, 0]", r"not of the form \[x, y, z\]"),
        ("t00001/timestep.xml", "<proc>0", "<proc>x", "'x' in <proc> is not an integer"),
        ("t00001/timestep.xml", "[1, 1, 1]</cellspacing>", "[1, 0, 1]</cellspacing>", "cell spacing"),
        ("t00001/l0/p00000.xml", "<patch>1", "<patch>9", "patch 9, which is not on this level"),
        (
            "t00001/l0/p00000.xml",
            "<filename>p00000.data",
            "<filename>../../x",
            "not the name of a file beside",
        ),
        ("t00001/l0/p00000.xml", "<start>1024", "<start>99999", "bytes 99999 to"),
        (
            "t00001/l0/p00000.xml",
            "<numParticles>1<",
            "<numParticles>2<",
            "has 48 bytes|bytes where 48 are due|other var",
        ),
        ("t00001/l0/p00000.xml", "    <numParticles>1</numParticles>\n", "", "has no <numParticles>"),
        (
            "t00001/l0/p00000.xml",
            "ParticleVariable&lt;int",
            "ParticleVariable&lt;float",
            "but index.xml says",
        ),
        (
            "t00001/l0/p00000.xml",
            "<end>24<",
            "<end>32<",
            "p.x of material 0, patch 0 has 32 bytes where 24 are due",
        ),
    ],
)
def test_a_damaged_text_file_is_named(tmp_path, file, old, new, message):
    write_small(tmp_path / "a")
    edit(tmp_path / "a" / file, old, new, 1)
    with pytest.raises(ArchiveError, match=message) as caught:
        everything(tmp_path / "a")
    assert caught.value.path.is_relative_to(tmp_path / "a")


def test_a_truncated_data_file_is_named_with_its_offset(tmp_path):
    write_small(tmp_path / "a")
    data = tmp_path / "a" / "t00001" / "l0" / "p00000.data"
    length = data.stat().st_size
    with data.open("r+b") as file:
        file.truncate(length - 1)
    archive = Archive(tmp_path / "a")
    assert archive.particles(1, "p.x", 0).shape == (2, 3)
    with pytest.raises(
        ArchiveError, match=r"p00000\.data \(byte \d+\): the file ends at byte .* other time steps"
    ):
        archive.grid_variable(1, "g.normal", 0)
    assert archive.grid_variable(2, "g.normal", 0).values.shape == (5, 2, 2, 3)


def test_a_damaged_compressed_block_is_named(tmp_path):
    write_small(tmp_path / "a", "gzip")
    data = tmp_path / "a" / "t00001" / "l0" / "p00000.data"
    whole = data.read_bytes()
    for position, message in ((0, "declares"), (9, "damaged|gives"), (15, "damaged|gives")):
        data.write_bytes(whole[:position] + bytes([whole[position] ^ 0xFF]) + whole[position + 1 :])
        with pytest.raises(ArchiveError, match=message):
            Archive(tmp_path / "a").particles(1, "p.x", 0, patch=0)


def test_a_compressed_block_cannot_fill_the_memory(tmp_path):
    """A stream that unpacks to far more than the block's size is refused, whatever it declares."""
    write_small(tmp_path / "a", "gzip")
    data = tmp_path / "a" / "t00001" / "l0" / "p00000.data"
    bomb = zlib.compress(bytes(24 * 1000))
    data.write_bytes(struct.pack("<Q", 24) + bomb + data.read_bytes()[8 + len(bomb) :])
    edit(data.with_suffix(".xml"), "<end>", f"<end>{8 + len(bomb)}</end><was>", 1)
    text = data.with_suffix(".xml").read_text()
    data.with_suffix(".xml").write_text(re.sub(r"<was>\d+</end>", "", text))
    with pytest.raises(ArchiveError, match="gives 25 bytes where 24 are due"):
        Archive(tmp_path / "a").particles(1, "p.x", 0, patch=0)


def test_a_damaged_state_is_a_diagnostic(tmp_path):
    origin = write_small(tmp_path / "a")
    path = origin / "checkpoints" / "t00001" / "restart.npz"
    whole = path.read_bytes()
    assert np.load(io.BytesIO(whole))["a"].tolist() == [0, 1, 2]
    for length in range(0, len(whole), 16):
        path.write_bytes(whole[:length])
        with pytest.raises(ArchiveError, match=r"restart\.npz: cannot be read"):
            Archive(origin).checkpoints.state(1)
    refused, checkpoints = 0, Archive(origin).checkpoints
    for place, bit in itertools.product(range(len(whole)), (0, 3)):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1 << bit]) + whole[place + 1 :])
        try:
            assert checkpoints.state(1)["a"].tolist() == [0, 1, 2]
        except ArchiveError:
            refused += 1
    assert refused > len(whole)


def test_a_step_whose_folder_is_gone_does_not_hide_the_others(tmp_path):
    origin = write_small(tmp_path / "a")
    shutil.rmtree(origin / "t00001")
    archive = Archive(origin)
    assert len(archive.particles(2, "p.x")) == 3
    with pytest.raises(ArchiveError, match="No such file or directory; check the path"):
        archive.particles(1, "p.x")
