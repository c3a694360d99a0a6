"""Converted archives, read back with VTK and numpy."""

import csv
import math
import re

import numpy as np
import pytest
from lxml import etree
from other_programs import without_checksums

from ups.archive import Archive, ArchiveError, ArchiveWriter, Grid, Level, Patch, Variable, reader
from ups.convert import FORMATS, Format, Region, convert, register, vtkpieces
from ups.convert import csv as convert_csv

STEPS = (3, 8)


@pytest.fixture(scope="module")
def vtk():
    """Return functions that read .vtp and .vti files with VTK and fail where VTK complains."""
    xml = pytest.importorskip("vtkmodules.vtkIOXML")
    support = pytest.importorskip("vtkmodules.util.numpy_support")
    core = pytest.importorskip("vtkmodules.vtkCommonCore")

    class Reader:
        @staticmethod
        def read(path):
            reader = {".vtp": xml.vtkXMLPolyDataReader, ".vti": xml.vtkXMLImageDataReader}[path.suffix]()
            complaints = []
            reader.AddObserver(core.vtkCommand.ErrorEvent, lambda *_: complaints.append(path))
            reader.SetFileName(str(path))
            reader.Update()
            assert not complaints
            return reader.GetOutput()

        @staticmethod
        def arrays(attributes):
            count = attributes.GetNumberOfArrays()
            found = [attributes.GetArray(i) for i in range(count)]
            return {array.GetName(): support.vtk_to_numpy(array) for array in found}

        @staticmethod
        def points(data):
            return support.vtk_to_numpy(data.GetPoints().GetData())

    return Reader


def series(path):
    """Return the (time, part, file) that a .pvd lists."""
    listed = etree.parse(path).getroot().iter("DataSet")
    return [
        (float(item.get("timestep")), int(item.get("part")), path.parent / item.get("file"))
        for item in listed
    ]


def test_particles_for_paraview(archive, tmp_path, vtk):
    done = []
    files = convert(archive, tmp_path / "out.pvd", progress=lambda *counts: done.append(counts))
    assert files == [tmp_path / "out.pvd", tmp_path / "out_grid.pvd"]
    assert done == [(1, 2), (2, 2)]
    listed = series(files[0])
    assert [(time, part) for time, part, _file in listed] == [(3 / 7, 0), (8 / 7, 0)]
    data = vtk.read(listed[1][2])
    assert data.GetNumberOfVerts() == 4
    assert vtk.points(data).tolist() == Archive(archive).particles(8, "p.x").tolist()
    arrays = vtk.arrays(data.GetPointData())
    assert list(arrays) == ["material", "stress", "particleID", "damage"]
    assert arrays["material"].tolist() == [0, 0, 0, 1]
    assert arrays["particleID"].tolist() == [1, 2, 3, 1 << 50]
    assert arrays["stress"][:3].tolist() == (np.arange(27.0).reshape(3, 9) + 8).tolist()
    assert np.isnan(arrays["damage"][:3]).all()
    assert arrays["damage"][3] == 0.5
    stress = data.GetPointData().GetArray("stress")
    names = [stress.GetComponentName(i) for i in range(9)]
    assert names == ["XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ"]
    assert vtk.arrays(data.GetFieldData())["TimeValue"].tolist() == [8 / 7]


def test_a_periodic_grid_for_paraview(archive, tmp_path, vtk):
    files = convert(archive, tmp_path / "out")
    assert files == [tmp_path / "out" / "particles.pvd", tmp_path / "out" / "grid.pvd"]
    time, part, file = series(files[1])[0]
    assert (time, part) == (3 / 7, 0)
    data = vtk.read(file)
    assert data.GetExtent() == (0, 4, 0, 2, 0, 1)
    assert data.GetOrigin() == (1.0, 0.0, 0.0)
    assert data.GetSpacing() == (0.5, 0.25, 1.0)
    nodes, cells = vtk.arrays(data.GetPointData()), vtk.arrays(data.GetCellData())
    assert list(nodes) == ["mass_0", "mass_1", "velocity_0"]
    for index in range(data.GetNumberOfPoints()):
        x, y, z = data.GetPoint(index)
        wrapped = 1.0 if x == 3.0 else x
        assert nodes["mass_0"][index] == pytest.approx(wrapped + 10 * y + 100 * z + 3000, rel=1e-15)
    assert np.array_equal(nodes["mass_1"], -nodes["mass_0"])
    # node (1, 1, 0) of the interior is [1, 2, 0] of the array with one extra node in y
    assert nodes["velocity_0"][1 + 5 * 1].tolist() == np.arange(120.0).reshape(4, 5, 2, 3)[1, 2, 0].tolist()
    pressure = np.arange(16.0).reshape(4, 4, 1)[:, 1:3]
    assert cells["press_CC_0"].dtype == np.float32
    assert cells["press_CC_0"].tolist() == pressure.transpose(2, 1, 0).reshape(-1).tolist()
    face = np.arange(20.0).reshape(4, 5, 1)
    assert (
        cells["v_FC_0"].tolist()
        == ((face[:, 1:3] + face[:, 2:4]) / 2).transpose(2, 1, 0).reshape(-1).tolist()
    )


def test_large_arrays_are_split_into_blocks(tmp_path, vtk):
    grid = Grid(
        (Level(0, (0, 0, 0), (1, 1, 1), (0, 0, 0), (False,) * 3, (Patch(0, 0, (0, 0, 0), (1, 1, 1)),)),)
    )
    points = np.random.default_rng(3).uniform(size=(100_000, 3))
    with ArchiveWriter.create(tmp_path / "a", grid, input_xml="<a/>") as writer:
        writer.write_timestep(1, 0.1, 0.1, {Variable("p.x", "ParticleVariable", "Point"): {0: points}})
        writer.write_timestep(2, 0.2, 0.1, {Variable("p.x", "ParticleVariable", "Point"): {0: points[:0]}})
    (file,) = convert(writer.directory, tmp_path / "out.pvd")
    full, empty = (vtk.read(path) for _time, _part, path in series(file))
    assert np.array_equal(vtk.points(full), points)
    assert empty.GetNumberOfPoints() == 0
    (table,) = convert(writer.directory, tmp_path / "out.csv")
    assert len(rows(table)) == len(points)


def test_levels_are_parts_of_the_series(tmp_path, vtk):
    coarse = Level(0, (0, 0, 0), (2, 2, 2), (0, 0, 0), (False,) * 3, (Patch(0, 0, (0, 0, 0), (4, 4, 1)),))
    fine = Level(1, (0, 0, 0), (1, 1, 1), (1, 1, 0), (False,) * 3, (Patch(1, 0, (2, 2, 0), (6, 6, 2)),))
    pressure = Variable("press_CC", "CCVariable", "double")
    with ArchiveWriter.create(tmp_path / "a", Grid((coarse, fine)), input_xml="<a/>") as writer:
        both = [{pressure: {0: np.zeros((4, 4, 1))}}, {pressure: {0: np.ones((6, 6, 2))}}]
        writer.write_timestep(1, 0.1, 0.1, both)
    (file,) = convert(writer.directory, tmp_path / "out.pvd")
    assert file == tmp_path / "out.pvd"
    assert [part for _time, part, _path in series(file)] == [0, 1]
    data = vtk.read(series(file)[1][2])
    assert data.GetExtent() == (2, 6, 2, 6, 0, 2)
    assert data.GetBounds() == (2, 6, 2, 6, 0, 2)


def test_a_series_opens_as_one_in_pyvista(archive, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    convert(archive, tmp_path / "out.pvd", variables=["stress"])
    reader = pyvista.get_reader(tmp_path / "out.pvd")
    assert reader.time_values == [3 / 7, 8 / 7]
    reader.set_active_time_value(8 / 7)
    assert reader.read()[0]["stress"][0].tolist() == (np.arange(9.0) + 8).tolist()


def test_only_what_is_asked_for(archive, tmp_path, vtk):
    files = convert(archive, tmp_path / "out.pvd", variables=["p.stress", "mass"], materials=[1], steps=[-1])
    (particles,), (grid,) = (series(file) for file in files)
    data = vtk.read(particles[2])
    assert data.GetNumberOfPoints() == 1
    assert list(vtk.arrays(data.GetPointData())) == ["material", "stress"]
    assert list(vtk.arrays(vtk.read(grid[2]).GetPointData())) == ["mass_1"]
    assert particles[0] == 8 / 7


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_tables(archive, tmp_path):
    files = convert(archive, tmp_path / "out.csv")
    assert [file.name for file in files] == ["out.csv", "out_nodes.csv", "out_cells.csv", "out_yfaces.csv"]
    particles, nodes, cells, faces = map(rows, files)
    assert len(particles) == 2 * 4
    last = particles[-1]
    assert (last["step"], last["material"], last["p.particleID"]) == ("8", "1", str(1 << 50))
    assert float(last["time"]) == 8 / 7
    assert [float(last[axis]) for axis in "xyz"] == [1.5, 0.2, 0.5]
    assert [float(last[f"p.stress.{name}"]) for name in ("XX", "XY", "ZZ")] == [8, 9, 16]
    assert float(last["p.damage"]) == 0.5
    assert math.isnan(float(particles[0]["p.damage"]))
    assert len(nodes) == 2 * 2 * 4 * 5 * 2
    for row in nodes:
        step, x, y, z = (float(row[name]) for name in ("step", "x", "y", "z"))
        sign = -1 if row["material"] == "1" else 1
        assert float(row["g.mass"]) == pytest.approx(sign * (x + 10 * y + 100 * z + 1000 * step), rel=1e-14)
        assert math.isnan(float(row["g.velocity.Y"])) == (row["material"] == "1")
    assert [row["j"] for row in cells[:4]] == ["-1", "0", "1", "2"]
    assert [float(row["y"]) for row in cells[:4]] == [-0.125, 0.125, 0.375, 0.625]
    assert [float(row["press_CC"]) for row in cells[:4]] == [0, 1, 2, 3]
    assert len(faces) == 2 * 4 * 5


@pytest.mark.parametrize("suffix", [".csv", ".pvd", ".vtu"])
def test_parts_of_any_size_give_the_same_files(archive, tmp_path, monkeypatch, suffix):
    convert(archive, tmp_path / "whole" / f"x{suffix}", region=Region((1.2, 0, 0), (2.4, 1, 1)))
    for module in (reader, convert_csv, vtkpieces):
        monkeypatch.setattr(module, "PART", 1)
    convert(archive, tmp_path / "parts" / f"x{suffix}", region=Region((1.2, 0, 0), (2.4, 1, 1)))
    files = [path for path in (tmp_path / "whole").rglob("*") if path.is_file()]
    assert len(files) > 2
    for path in files:
        assert (tmp_path / "parts" / path.relative_to(tmp_path / "whole")).read_bytes() == path.read_bytes()


def test_arrays(archive, tmp_path):
    (file,) = convert(archive, tmp_path / "sub" / "out.npz", variables=["p.stress", "g.mass"])
    with np.load(file) as found:
        assert found["steps"].tolist() == [3, 8]
        assert found["times"].tolist() == [3 / 7, 8 / 7]
        assert found["history/TotalMomentum"].tolist() == [[3 / 7, 1, 2, 3], [8 / 7, 1, 2, 8]]
        source = Archive(archive)
        assert np.array_equal(found["t00008/0/p.stress"], source.particles(8, "p.stress", 0))
        assert np.array_equal(found["t00003/l0/1/g.mass"], source.grid_variable(3, "g.mass", 1).values)
        assert found["t00003/l0/1/g.mass/low"].tolist() == [0, -1, 0]
        assert len(found.files) == 3 + 2 * (2 + 2 * 2)


@pytest.mark.parametrize(
    ("out", "options", "message"),
    [
        ("out.xyz", {}, r"no format is known by the suffix \.xyz; give a name ending in"),
        (
            "out.csv",
            {"variables": ["p.strain"]},
            r"there is no variable p\.strain; there are: p\.x, p\.stress",
        ),
        ("out.csv", {"steps": [4]}, "time step 4 is not stored; there are: 3, 8"),
    ],
)
def test_what_cannot_be_converted_is_said(archive, tmp_path, out, options, message):
    with pytest.raises(ArchiveError, match=message):
        convert(archive, tmp_path / out, **options)
    assert not (tmp_path / out).exists()


@pytest.mark.parametrize("out", ["out.pvd", "out.csv"])
def test_an_archive_without_variables_is_said_to_be_empty(tmp_path, grid, out):
    ArchiveWriter.create(tmp_path / "a", grid, input_xml="<a/>").close()
    with pytest.raises(ArchiveError, match="no particle or grid variable to convert"):
        convert(tmp_path / "a", tmp_path / out)


@pytest.mark.parametrize("out", ["out.pvd", "out.csv"])
def test_particles_without_positions_are_an_error(archive, tmp_path, out):
    without_checksums(archive)
    for file in [archive / "index.xml", *archive.glob("t*/l0/*.xml")]:
        text = re.sub(r"  <Variable [^\0]{0,60}<variable>p\.x<[^\0]*?</Variable>\n", "", file.read_text())
        file.write_text(re.sub(r".*name=\"p\.x\".*\n", "", text))
    with pytest.raises(ArchiveError, match=r'p\.x, are not stored; add <save label="p\.x"/>'):
        convert(archive, tmp_path / out)


@pytest.mark.parametrize("out", ["file/out.pvd", "file/out.csv", "file/out.npz"])
def test_a_place_that_cannot_be_written_is_named(archive, tmp_path, out):
    (tmp_path / "file").write_text("")
    with pytest.raises(ArchiveError, match=r"cannot write the output: (Not a directory|File exists)"):
        convert(archive, tmp_path / out)


def test_two_formats_cannot_claim_a_suffix():
    with pytest.raises(ValueError, match=r"both CSV and Other claim '\.csv'"):
        register(Format("Other", (".csv",), lambda *_: []))
    assert FORMATS[".csv"].name == "CSV"
