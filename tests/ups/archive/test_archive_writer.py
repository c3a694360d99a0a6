"""What the writer leaves on the disk, byte by byte, and what is left when the disk refuses."""

import re
import resource
import struct
import zlib
from contextlib import contextmanager

import numpy as np
import pytest
from lxml import etree

from ups.archive import Archive, ArchiveError, ArchiveWriter, Box, Grid, ReductionFormat, Variable
from ups.archive.naming import next_numbered_directory, point_link

X = Variable("p.x", "ParticleVariable", "Point")
VOLUME = Variable("p.volume", "ParticleVariable", "double")
STRESS = Variable("p.stress", "ParticleVariable", "Matrix3")
ID = Variable("p.particleID", "ParticleVariable", "long64")
FLAG = Variable("p.localizedMPM", "ParticleVariable", "int")
MASS = Variable("g.mass", "NCVariable", "double")
VELOCITY = Variable("g.velocity", "NCVariable", "Vector")
PRESSURE = Variable("press_CC", "CCVariable", "double")
ENERGY = Variable("KineticEnergy", "ReductionVariable", "double")
MOMENTUM = Variable("TotalMomentum", "ReductionVariable", "Vector")
DELT = Variable("delT", "ReductionVariable", "double")

# Two materials: particles of the first in both patches, of the second in the right one only.
POSITIONS = {
    0: np.array([[1.25, 0.25, 0.25], [0.25, 0.25, 0.25], [1.75, 0.75, 0.25]]),
    1: np.array([[1.5, 0.5, 0.1]]),
}


def particle_fields():
    return {X: POSITIONS, VOLUME: {0: np.array([1.0, 2.0, 3.0]), 1: np.array([4.0])}}


def entries(folder, name="p00000"):
    root = etree.parse(folder / f"{name}.xml").getroot()
    return [
        {"type": item.get("type")} | {child.tag: child.text for child in item}
        for item in root.iter("Variable")
    ]


def block(folder, entry):
    return (folder / entry["filename"]).read_bytes()[int(entry["start"]) : int(entry["end"])]


class LineScanner:
    """Reads index.xml and timestep.xml as Uintah does: line by line, failing where it would."""

    LEAF = re.compile(r"<(\w+)>([^<>]+)</(\w+)>")

    def __init__(self, path):
        self.raw = path.read_text().split("\n")
        self.lines = [line.strip(" \t\r") for line in self.raw]

    def block(self, tag, start=0):
        first = self.lines.index(f"<{tag}>", start)
        return self.lines[first + 1 : self.lines.index(f"</{tag}>", first)]

    def leaves(self, lines):
        found = []
        for line in lines:
            match = self.LEAF.fullmatch(line)
            assert match, line
            assert match[1] == match[3]
            found.append((match[1], match[2]))
        return found


def scan_index(path):
    scanner = LineScanner(path)
    assert scanner.raw[0].startswith("<?xml")
    assert scanner.raw[1] == "<Uintah_DataArchive>"
    assert scanner.lines[2].startswith("<numberOfProcessors>")
    assert scanner.raw[-1] == ""
    assert scanner.raw[-2] == "</Uintah_DataArchive>"
    assert max(map(len, scanner.raw)) < 4095
    meta = dict(scanner.leaves(scanner.block("Meta")))
    assert meta["endianness"] == "little_endian"
    assert meta["nBits"] == "64"
    for tag in ["variables"] + ["globals"] * ("<globals>" in scanner.lines):
        for line in scanner.block(tag):
            assert line.startswith("<variable ")
            assert etree.fromstring(line).get("type")
    for line in scanner.block("timesteps"):
        assert line.startswith("<timestep ")
        assert float(etree.fromstring(line).get("time")) >= 0
    return scanner, meta


def scan_timestep(path):
    scanner = LineScanner(path)
    assert scanner.raw[1] == "<Uintah_timestep>"
    assert scanner.lines[-2] == "</Uintah_timestep>"
    assert scanner.lines.index("<Meta>") < scanner.lines.index("<Grid>") < scanner.lines.index("<Data>")
    scanner.leaves(scanner.block("Meta"))
    scanner.leaves(scanner.block("Time"))
    plain = [
        line for line in scanner.block("Grid") if line not in ("<Level>", "</Level>", "<Patch>", "</Patch>")
    ]
    allowed = {
        "numLevels",
        "numPatches",
        "totalCells",
        "extraCells",
        "anchor",
        "id",
        "cellspacing",
        "periodic",
    }
    allowed |= {
        "proc",
        "lowIndex",
        "highIndex",
        "interiorLowIndex",
        "interiorHighIndex",
        "nnodes",
        "lower",
        "upper",
    }
    assert {tag for tag, _text in scanner.leaves(plain)} <= allowed
    for line in scanner.block("Data"):
        assert line.startswith("<Datafile ")
    return scanner


def test_the_text_files_pass_a_line_scanner(grid, create):
    section = etree.fromstring("<MPM><a>1\n 2</a><!-- gone --><b type='x&lt;y'>odd<c/></b></MPM>")
    with create(grid, title="bar & rod") as writer:
        writer.append_reductions(1, 0.5, {ENERGY: {-1: 1.0}, MOMENTUM: {1: [1, 2, 3]}})
        writer.write_timestep(1, 0.5, 0.5, particle_fields(), sections=[section])
        writer.write_checkpoint(1, 0.5, 0.5, particle_fields(), global_values={DELT: {-1: 0.5}})
    scanner, meta = scan_index(writer.directory / "index.xml")
    scan_index(writer.directory / "checkpoints" / "index.xml")
    assert meta["title"] == "bar &amp; rod"
    assert scanner.block("globals") == [
        '<variable href="KineticEnergy.dat" type="ReductionVariable&lt;double&gt;" name="KineticEnergy"/>',
        '<variable href="TotalMomentum_1.dat" type="ReductionVariable&lt;Vector&gt;" name="TotalMomentum"/>',
    ]
    assert scanner.block("variables")[0] == (
        '<variable type="ParticleVariable&lt;Point&gt;" name="p.x" numMaterials="2"/>'
    )
    assert scanner.block("timesteps") == [
        '<timestep href="t00001/timestep.xml" time="0.5" oldDelt="0.5">1</timestep>'
    ]
    step = scan_timestep(writer.directory / "t00001" / "timestep.xml")
    after = step.lines[step.lines.index("</Data>") + 1 :]
    assert after[:-2] == ["<MPM>", "<a>1 2</a>", '<b type="x&lt;y">', "odd", "<c/>", "</b>", "</MPM>"]
    checkpoint = scan_timestep(writer.directory / "checkpoints" / "t00001" / "timestep.xml")
    assert checkpoint.block("Data") == [
        '<Datafile href="l0/p00000.xml" proc="0"/>',
        '<Datafile href="global.xml"/>',
    ]


def test_a_new_archive_can_be_scanned_before_its_first_step(grid, create):
    with create(grid) as writer:
        scanner, _meta = scan_index(writer.directory / "index.xml")
    assert scanner.block("variables") == []
    assert scanner.block("timesteps") == []


@pytest.mark.parametrize("name", ["", "  ", "a<b", "x\ny"])
def test_an_odd_user_name_does_not_break_the_scanner(grid, create, monkeypatch, name):
    monkeypatch.setattr("getpass.getuser", lambda: name)
    with create(grid) as writer:
        pass
    _scanner, meta = scan_index(writer.directory / "index.xml")
    assert meta["username"] == {"": "unknown", "  ": "unknown", "a<b": "a&lt;b", "x\ny": "x y"}[name]


def test_a_long_title_does_not_break_the_scanner(grid, create):
    with create(grid, title="& " * 5000) as writer:
        pass
    _scanner, meta = scan_index(writer.directory / "index.xml")
    assert meta["title"].startswith("&amp; &amp;")


def test_a_user_without_a_name_is_unknown(grid, create, monkeypatch):
    def nobody():
        raise KeyError("uid not found")

    monkeypatch.setattr("getpass.getuser", nobody)
    with create(grid) as writer:
        pass
    assert scan_index(writer.directory / "index.xml")[1]["username"] == "unknown"


def test_the_grid_of_a_step(grid, create):
    with create(grid) as writer:
        writer.write_timestep(3, 0.1, 0.05, particle_fields())
    scanner = scan_timestep(writer.directory / "t00003" / "timestep.xml")
    assert scanner.leaves(scanner.block("Time")) == [
        ("timestepNumber", "3"),
        ("currentTime", "0.10000000000000001"),
        ("oldDelt", "0.050000000000000003"),
    ]
    level = scanner.block("Level")
    assert scanner.leaves(level[: level.index("<Patch>")]) == [
        ("numPatches", "2"),
        ("totalCells", "24"),
        ("extraCells", "[1, 1, 0]"),
        ("anchor", "[0, 0, 0]"),
        ("id", "0"),
        ("cellspacing", "[0.5, 0.5, 0.5]"),
    ]
    assert scanner.leaves(scanner.block("Patch")) == [
        ("id", "0"),
        ("proc", "0"),
        ("lowIndex", "[-1, -1, 0]"),
        ("highIndex", "[2, 3, 1]"),
        ("interiorLowIndex", "[0, 0, 0]"),
        ("interiorHighIndex", "[2, 2, 1]"),
        ("nnodes", "30"),
        ("lower", "[-0.5, -0.5, 0]"),
        ("upper", "[1, 1.5, 0.5]"),
        ("totalCells", "12"),
    ]


def test_a_periodic_level_says_so(create):
    grid = Grid.single_level([Box((0, 0, 0), (2, 2, 1))], spacing=(1, 1, 1), periodic=(True, False, False))
    with create(grid) as writer:
        writer.write_timestep(0, 0.0, 0.0, {MASS: {0: np.zeros((2, 3, 2))}})
    scanner = scan_timestep(writer.directory / "t00000" / "timestep.xml")
    assert "<periodic>[1, 0, 0]</periodic>" in scanner.lines
    assert not any(line.startswith(("<extraCells>", "<interior")) for line in scanner.lines)


def test_every_material_has_an_entry_on_every_patch(grid, create):
    with create(grid) as writer:
        writer.write_timestep(1, 0.1, 0.1, particle_fields())
    folder = writer.directory / "t00001" / "l0"
    table = entries(folder)
    assert [(e["variable"], e["patch"], e["index"], e["numParticles"]) for e in table] == [
        ("p.x", "0", "0", "1"),
        ("p.x", "0", "1", "0"),
        ("p.x", "1", "0", "2"),
        ("p.x", "1", "1", "1"),
        ("p.volume", "0", "0", "1"),
        ("p.volume", "0", "1", "0"),
        ("p.volume", "1", "0", "2"),
        ("p.volume", "1", "1", "1"),
    ]
    assert list(table[0]) == [
        "type",
        "variable",
        "index",
        "patch",
        "start",
        "numParticles",
        "end",
        "filename",
    ]
    assert table[1]["start"] == table[1]["end"]
    assert struct.unpack("<3d", block(folder, table[0])) == (0.25, 0.25, 0.25)
    assert struct.unpack("<2d", block(folder, table[6])) == (1.0, 3.0)


def test_blocks_begin_at_multiples_of_1024_and_the_file_ends_with_the_last(grid, create):
    with create(grid) as writer:
        writer.write_timestep(1, 0.1, 0.1, particle_fields())
    folder = writer.directory / "t00001" / "l0"
    table, raw = entries(folder), (folder / "p00000.data").read_bytes()
    assert all(int(entry["start"]) % 1024 == 0 for entry in table)
    assert len(raw) == max(int(entry["end"]) for entry in table)
    assert raw[24:1024] == bytes(1000)


def test_compressed_blocks_are_a_size_and_a_zlib_stream(grid, create):
    with create(grid, compression="gzip") as writer:
        writer.write_timestep(1, 0.1, 0.1, particle_fields())
    folder = writer.directory / "t00001" / "l0"
    for entry in entries(folder):
        raw = block(folder, entry)
        assert entry["compression"] == "gzip"
        assert raw[8:10] == b"\x78\x9c"
        width = 24 if entry["variable"] == "p.x" else 8
        assert (
            struct.unpack("<Q", raw[:8])[0]
            == int(entry["numParticles"]) * width
            == len(zlib.decompress(raw[8:]))
        )
        assert entry["numParticles"] != "0" or len(raw) == 16


def test_a_variable_may_choose_its_compression(grid, create):
    fields = {
        Variable("p.x", "ParticleVariable", "Point", "none"): POSITIONS,
        VOLUME: {0: np.zeros(3), 1: np.zeros(1)},
    }
    with create(grid, compression="gzip") as writer:
        writer.write_timestep(1, 0.1, 0.1, fields)
    chosen = {(e["variable"], e.get("compression")) for e in entries(writer.directory / "t00001" / "l0")}
    assert chosen == {("p.x", None), ("p.volume", "gzip")}


def test_grid_values_are_stored_with_x_fastest_and_a_shared_node_once(grid, create):
    level = grid.levels[0]
    origin, shape = level.whole("NCVariable").low, level.whole("NCVariable").shape
    i, j, k = np.indices(shape)
    values = (i + origin[0]) + 100.0 * (j + origin[1]) + 10000.0 * (k + origin[2])
    with create(grid) as writer:
        writer.write_timestep(1, 0.1, 0.1, {MASS: {0: values}})
    folder = writer.directory / "t00001" / "l0"
    left, right = (np.frombuffer(block(folder, entry)) for entry in entries(folder))
    assert left.size == 3 * 5 * 2  # nodes -1..1, -1..3, 0..1: node 2 is the right patch's
    assert left[:4].tolist() == [-101, -100, -99, -1]
    assert right.size == 4 * 5 * 2
    assert right[:5].tolist() == [-98, -97, -96, -95, 2]
    assert right[-1] == 5 + 300 + 10000


def test_a_vector_on_the_grid_keeps_its_components_together(create):
    grid = Grid.single_level([Box((0, 0, 0), (1, 1, 1))], spacing=(1, 1, 1))
    values = np.arange(24.0).reshape(2, 2, 2, 3)
    with create(grid) as writer:
        writer.write_timestep(1, 0.1, 0.1, {VELOCITY: {0: values}})
    folder = writer.directory / "t00001" / "l0"
    stored = np.frombuffer(block(folder, entries(folder)[0])).reshape(8, 3)
    assert stored[1].tolist() == values[1, 0, 0].tolist()
    assert stored[2].tolist() == values[0, 1, 0].tolist()
    assert stored[4].tolist() == values[0, 0, 1].tolist()


@pytest.mark.parametrize("shape", [(3, 3, 3), (3, 9)])
def test_a_matrix_is_stored_by_rows(grid, create, shape):
    values = np.arange(27.0).reshape(shape)
    with create(grid) as writer:
        writer.write_timestep(1, 0.1, 0.1, {STRESS: {0: values}}, positions=POSITIONS)
    folder = writer.directory / "t00001" / "l0"
    assert struct.unpack("<9d", block(folder, entries(folder)[0])) == tuple(range(9, 18))


def test_ids_keep_all_their_bits(grid, create):
    ids = np.array([1 << 62, -1, (5 << 16) | (7 << 32) | 3])
    with create(grid) as writer:
        writer.write_timestep(1, 0.1, 0.1, {ID: {0: ids}}, positions=POSITIONS)
    assert sorted(Archive(writer.directory).particles(1, "p.particleID").tolist()) == sorted(ids.tolist())


def test_each_rank_has_its_own_files(create):
    boxes = Box((0, 0, 0), (4, 2, 1)).split((2, 1, 1))
    grid = Grid.single_level(boxes, spacing=(0.5, 0.5, 0.5), procs=2)
    with create(grid) as writer:
        writer.write_timestep(1, 0.1, 0.1, particle_fields())
    folder = writer.directory / "t00001" / "l0"
    assert sorted(path.name for path in folder.iterdir()) == [
        f"p0000{rank}.{suffix}" for rank in (0, 1) for suffix in ("crc32", "data", "xml")
    ]
    assert {e["filename"] for e in entries(folder, "p00001")} == {"p00001.data"}
    assert {e["patch"] for e in entries(folder, "p00001")} == {"1"}
    scanner, _meta = scan_index(writer.directory / "index.xml")
    assert "<numberOfProcessors>2</numberOfProcessors>" in scanner.lines
    assert scan_timestep(folder.parent / "timestep.xml").block("Data") == [
        '<Datafile href="l0/p00000.xml" proc="0"/>',
        '<Datafile href="l0/p00001.xml" proc="1"/>',
    ]


def test_single_precision_is_for_outputs_and_doubles_only(grid, create):
    cells = grid.levels[0].whole("CCVariable").shape
    fields = particle_fields() | {PRESSURE: {0: np.full(cells, 0.1)}}
    with create(grid, double_as_float=True) as writer:
        writer.write_timestep(1, 0.1, 0.1, fields)
        writer.write_checkpoint(1, 0.1, 0.1, fields)
    stored = {name: v.type_name for name, v in Archive(writer.directory).variables.items()}
    assert stored == {
        "p.x": "ParticleVariable<Point>",
        "p.volume": "ParticleVariable<float>",
        "press_CC": "CCVariable<float>",
    }
    table = entries(writer.directory / "t00001" / "l0")
    pressure = next(e for e in table if e["variable"] == "press_CC")
    assert int(pressure["end"]) - int(pressure["start"]) == 4 * 12
    assert Archive(writer.directory).checkpoints.variables["p.volume"].element == "double"


def test_histories_are_written_as_uintah_prints_them(grid, create):
    matrix = Variable("M", "ReductionVariable", "Matrix3")
    flag = Variable("flag", "ReductionVariable", "bool")
    count = Variable("count", "ReductionVariable", "long64")
    with create(grid) as writer:
        values = {ENERGY: {-1: 0.1}, MOMENTUM: {2: [1.0, 0.1e-300, -0.5]}, matrix: {-1: np.eye(3)}}
        writer.append_reductions(1, 1 / 3, values | {flag: {-1: True}, count: {-1: 2**60}})
        writer.append_reductions(2, 2.0, {ENERGY: {-1: 12.0}})

    def line(name):
        return (writer.directory / name).read_bytes()

    assert line("KineticEnergy.dat") == b"0.33333333333333331\t0.10000000000000001\n2\t12\n"
    assert line("TotalMomentum_2.dat") == b"0.33333333333333331\t 1 1.0000000000000001e-301 -0.5 \n"
    assert line("M.dat") == b"0.33333333333333331\t1 0 0 0 1 0 0 0 1\n"
    assert line("flag.dat") == b"0.33333333333333331\t1\n"
    assert line("count.dat") == b"0.33333333333333331\t1152921504606846976\n"


def test_histories_can_be_thinned_and_numbered(grid, create):
    thin = ReductionFormat(frequency=3, on_timestep=1, step_column=True, time_column=False)
    with create(grid, reduction_format=thin) as writer:
        for step in range(1, 7):
            writer.append_reductions(step, step / 10, {ENERGY: {-1: step}}, last=step == 6)
    text = (writer.directory / "KineticEnergy.dat").read_text()
    assert text == "         1\t1\n         4\t4\n         6\t6\n"
    history = Archive(writer.directory).reductions["KineticEnergy"]
    assert history.steps.tolist() == [1, 4, 6]
    assert np.isnan(history.times).all()


def test_histories_reach_the_disk_with_a_time_step(grid, create):
    with create(grid) as writer:
        path = writer.directory / "KineticEnergy.dat"
        writer.append_reductions(1, 0.1, {ENERGY: {-1: 1.0}})
        assert path.read_text() == ""
        writer.write_timestep(1, 0.1, 0.1, particle_fields())
        assert path.read_text() == "0.10000000000000001\t1\n"


def test_the_deck_and_its_original_are_kept(grid, create):
    with create(
        grid, originals={"input.xml.orig": b"<a/>", "deck/bar.ups": b"<b/>", "index.xml": b"<c/>"}
    ) as writer:
        pass
    own = {"index.xml", "index.crc32"}
    kept = {path.name: path.read_bytes() for path in writer.directory.iterdir() if path.name not in own}
    assert kept == {
        "input.xml": b"<Uintah_specification/>\n",
        "input.xml.orig": b"<a/>",
        "bar.ups": b"<b/>",
        "index.xml.orig": b"<c/>",
    }


def test_checkpoints_are_a_ring_in_alphabetical_order(grid, create):
    fields = particle_fields()
    with create(grid) as writer:
        for step in (1, 2, 3):
            state = {"order": np.array([2, 0, 1]), "time": np.float64(0.1), "file": "x"}
            delt = {DELT: {-1: 0.1 * step}}
            writer.write_checkpoint(step, step / 10, 0.1, fields, global_values=delt, state=state, cycle=2)
    folder = writer.directory / "checkpoints"
    assert sorted(path.name for path in folder.iterdir()) == [
        "index.crc32",
        "index.xml",
        "index_backup.xml",
        "t00002",
        "t00003",
    ]
    backup = [item.text for item in etree.parse(folder / "index_backup.xml").iter("timestep")]
    assert backup == ["1", "2", "3"]
    scanner, _meta = scan_index(folder / "index.xml")
    assert scanner.block("globals") == [
        '<variable type="ReductionVariable&lt;double&gt;" name="delT" numMaterials="1"/>'
    ]
    assert [e["variable"] for e in entries(folder / "t00003" / "l0")][::4] == ["p.volume", "p.x"]
    assert entries(folder / "t00003", "global") == [
        {
            "type": "ReductionVariable<double>",
            "variable": "delT",
            "index": "-1",
            "patch": "-1",
            "start": "0",
            "end": "8",
            "filename": "global.data",
        }
    ]
    assert struct.unpack("<d", (folder / "t00003" / "global.data").read_bytes()) == (0.1 * 3,)
    archive = Archive(writer.directory).checkpoints
    assert archive.global_values(-1)["delT"][-1] == 0.1 * 3
    state = archive.state(3)
    assert state["order"].tolist() == [2, 0, 1]
    assert state["time"] == 0.1
    assert state["file"] == "x"


def test_an_existing_archive_is_never_overwritten(grid, create, tmp_path):
    with create(grid):
        pass
    before = (tmp_path / "x.uda.000" / "index.xml").read_bytes()
    with pytest.raises(ArchiveError, match="File exists; choose another name"):
        create(grid)
    assert (tmp_path / "x.uda.000" / "index.xml").read_bytes() == before


def test_an_empty_folder_may_become_an_archive(grid, create, tmp_path):
    (tmp_path / "x.uda.000").mkdir()
    with create(grid):
        pass
    assert Archive(tmp_path / "x.uda.000").timesteps == ()


def test_a_place_that_cannot_be_written_is_named(grid, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ArchiveError, match="cannot create the archive: Not a directory") as caught:
        ArchiveWriter.create(tmp_path / "file" / "x.uda", grid, input_xml="<a/>")
    assert caught.value.path == tmp_path / "file" / "x.uda"


def test_a_step_is_stored_once(grid, create):
    with create(grid) as writer:
        writer.write_timestep(1, 0.1, 0.1, particle_fields())
        with pytest.raises(ArchiveError, match="step 1 is stored already"):
            writer.write_timestep(1, 0.1, 0.1, particle_fields())


def test_a_step_that_fails_leaves_nothing(grid, create):
    with create(grid) as writer:
        writer.write_timestep(1, 0.1, 0.1, particle_fields())
        with pytest.raises(ValueError, match=r"p\.volume has 2 values for 3 particles"):
            writer.write_timestep(2, 0.2, 0.1, {X: {0: POSITIONS[0]}, VOLUME: {0: np.zeros(2)}})
    left = sorted(path.name for path in writer.directory.iterdir())
    assert left == ["index.crc32", "index.xml", "input.xml", "t00001"]
    assert [timestep.step for timestep in Archive(writer.directory).timesteps] == [1]


def test_a_folder_left_by_a_killed_run_is_replaced(grid, create):
    with create(grid) as writer:
        (writer.directory / "t00001" / "l0").mkdir(parents=True)
        (writer.directory / "t00001.partial").mkdir()
        writer.write_timestep(1, 0.1, 0.1, particle_fields())
    assert Archive(writer.directory).particles(1, "p.volume", 1).tolist() == [4.0]


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({MASS: {0: np.zeros((5, 5, 2))}}, r"g.mass .* has shape \(5, 5, 2\) where \(7, 5, 2\) is due"),
        ({ID: {0: np.zeros(3)}}, "cannot hold values of type float64"),
        ({FLAG: {0: np.array([0, 1, 2**31])}}, "cannot hold the value 2147483648"),
        ({VOLUME: {2: np.zeros(3)}}, "no positions for material 2"),
        ({VOLUME: {-1: np.zeros(3)}}, "material -1"),
        ({ENERGY: {0: 1.0}}, "does not belong to a level"),
        ([{}, {}], "2 levels given for a grid of 1"),
    ],
)
def test_values_that_do_not_fit_are_refused(grid, create, fields, message):
    with create(grid) as writer, pytest.raises(ValueError, match=message):
        writer.write_timestep(1, 0.1, 0.1, fields, positions=POSITIONS)


def test_particles_that_are_nowhere_are_named(grid, create):
    points = np.array([[0.5, 0.5, 0.25], [np.nan, 0.5, 0.25]])
    with create(grid) as writer, pytest.raises(ArchiveError, match="1 particles of material 0 are nowhere"):
        writer.write_timestep(1, 0.1, 0.1, {X: {0: points}})


@contextmanager
def full_disk(size):
    """No file can grow beyond a size, as on a full disk; ends before pytest itself writes again."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_full_disk_leaves_the_archive_readable(grid, create):
    writer = create(grid)
    writer.write_timestep(1, 0.1, 0.1, particle_fields())
    many = {X: {0: np.full((1000, 3), 0.25)}}
    with full_disk(2000):
        with pytest.raises(ArchiveError, match="cannot write the time step"):
            writer.write_timestep(2, 0.2, 0.1, many)
        with pytest.raises(ArchiveError, match="cannot write the time step"):
            writer.write_checkpoint(2, 0.2, 0.1, many)
        writer.close()
    archive = Archive(writer.directory)
    assert [timestep.step for timestep in archive.timesteps] == [1]
    assert archive.particles(1, "p.volume", 0).tolist() == [2.0, 1.0, 3.0]
    assert not list(writer.directory.glob("**/*.partial"))


def test_a_full_disk_leaves_whole_lines_in_the_histories(grid, create):
    writer = create(grid)
    writer.append_reductions(1, 0.125, {ENERGY: {-1: 1.0}})
    writer.flush()
    with full_disk(15):
        writer.append_reductions(2, 0.25, {ENERGY: {-1: 2.0}})
        writer.append_reductions(3, 0.375, {ENERGY: {-1: 3.0}})
        with pytest.raises(ArchiveError, match=r"KineticEnergy\.dat: cannot write the history"):
            writer.flush()
    path = writer.directory / "KineticEnergy.dat"
    assert path.read_text() == "0.125\t1\n"
    writer.close()
    assert path.read_text() == "0.125\t1\n0.25\t2\n0.375\t3\n"


def test_going_on_removes_what_is_later(grid, create):
    with create(grid, restarted_from=("old.uda.004", 7)) as writer:
        for step in range(1, 5):
            writer.append_reductions(step, step / 10, {ENERGY: {-1: step}})
            writer.write_timestep(step, step / 10, 0.1, particle_fields())
            writer.write_checkpoint(step, step / 10, 0.1, particle_fields())
    with (writer.directory / "KineticEnergy.dat").open("a") as file:
        file.write("0.5\t1")  # cut off by a crash
    with ArchiveWriter.open_existing(writer.directory, grid, step=2, time=0.2) as again:
        again.append_reductions(3, 0.3, {ENERGY: {-1: 30}})
        again.write_timestep(3, 0.3, 0.1, particle_fields())
    archive = Archive(writer.directory)
    assert [timestep.step for timestep in archive.timesteps] == [1, 2, 3]
    assert [timestep.step for timestep in archive.checkpoints.timesteps] == [1, 2]
    assert archive.reductions["KineticEnergy"].values.tolist() == [1, 2, 30]
    assert not (writer.directory / "t00004").exists()
    scanner, _meta = scan_index(writer.directory / "index.xml")
    assert scanner.block("restarts") == [
        '<restart from="old.uda.004" timestep="7"/>',
        '<restart from="x.uda.000" timestep="2"/>',
    ]
    assert len(scanner.block("globals")) == 1


def test_going_on_in_another_precision_is_refused(grid, create):
    with create(grid) as writer:
        writer.write_timestep(1, 0.1, 0.1, particle_fields())
    again = ArchiveWriter.open_existing(writer.directory, grid, step=1, time=0.1, double_as_float=True)
    with again, pytest.raises(ArchiveError, match=r"p\.volume is a ParticleVariable<float>, but a Particle"):
        again.write_timestep(2, 0.2, 0.1, particle_fields())


def test_going_on_keeps_a_history_without_step_and_time(grid, create):
    bare = ReductionFormat(time_column=False)
    with create(grid, reduction_format=bare) as writer:
        writer.append_reductions(1, 0.1, {ENERGY: {-1: 1.5}})
    again = ArchiveWriter.open_existing(writer.directory, grid, step=0, time=0.0, reduction_format=bare)
    again.close()
    assert (writer.directory / "KineticEnergy.dat").read_text() == "1.5\n"


def test_a_history_that_is_not_one_is_named_when_going_on(grid, create):
    with create(grid) as writer:
        writer.append_reductions(1, 0.1, {ENERGY: {-1: 1.5}})
    (writer.directory / "KineticEnergy.dat").write_text("0.1\t1\nrubbish\n")
    with pytest.raises(ArchiveError, match=r"KineticEnergy\.dat:2: the line does not begin"):
        ArchiveWriter.open_existing(writer.directory, grid, step=1, time=0.1)


def test_archives_are_numbered(tmp_path):
    base = tmp_path / "a" / "bar.uda"
    base.parent.mkdir()
    assert next_numbered_directory(base).name == "bar.uda.000"
    for name in ("bar.uda.000", "bar.uda.001", "bar.uda.003"):
        (base.parent / name).mkdir()
    assert next_numbered_directory(base) == base.parent / "bar.uda.002"


def test_numbers_grow_beyond_three_digits(tmp_path, monkeypatch):
    monkeypatch.setattr("os.path.lexists", lambda path: int(str(path).rsplit(".", 1)[1]) < 1000)
    assert next_numbered_directory(tmp_path / "bar.uda").name == "bar.uda.1000"


def test_the_link_leads_to_the_newest_archive(grid, tmp_path):
    link = tmp_path / "out" / "bar.uda"
    for _ in range(2):
        with ArchiveWriter.create(next_numbered_directory(link), grid, input_xml="<a/>", link=link):
            pass
    assert link.resolve() == (tmp_path / "out" / "bar.uda.001").resolve()
    assert not link.readlink().is_absolute()
    assert Archive(link).timesteps == ()


def test_a_file_in_the_place_of_the_link_stays(tmp_path):
    (tmp_path / "bar.uda").mkdir()
    (tmp_path / "bar.uda.000").mkdir()
    point_link(tmp_path / "bar.uda", tmp_path / "bar.uda.000")
    assert not (tmp_path / "bar.uda").is_symlink()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("", "NCVariable", "double"), "needs a name"),
        (("x", "Node", "double"), "unknown container 'Node'"),
        (("x", "NCVariable", "real"), "unknown element 'real'"),
        (("x", "NCVariable", "double", "rle"), "unknown compression 'rle'"),
    ],
)
def test_a_wrong_declaration_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Variable(*arguments)
