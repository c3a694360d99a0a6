"""Archives of several levels as VTK's blocks and hierarchies, read back with VTK."""

import json

import numpy as np
import pytest
from lxml import etree

from ups.archive import Archive, ArchiveError, ArchiveWriter, Grid, Level, Patch, Variable
from ups.convert import Region, convert

xml = pytest.importorskip("vtkmodules.vtkIOXML")
core = pytest.importorskip("vtkmodules.vtkCommonCore")
data_model = pytest.importorskip("vtkmodules.vtkCommonDataModel")
to_numpy = pytest.importorskip("vtkmodules.util.numpy_support").vtk_to_numpy

X = Variable("p.x", "ParticleVariable", "Point")
NODES = Variable("g.velocity", "NCVariable", "Vector")
CELLS = Variable("press_CC", "CCVariable", "double")
FACES = Variable("uvel_FC", "SFCXVariable", "double")
TIMES = {1: 0.1, 4: 0.4}


def read(reader, path):
    """Read a file, failing where VTK complains."""
    complaints = []
    reader.AddObserver(core.vtkCommand.ErrorEvent, lambda *_: complaints.append(path))
    reader.SetFileName(str(path))
    reader.Update()
    assert not complaints
    return reader.GetOutputDataObject(0)


def blocks(path):
    found = read(xml.vtkXMLMultiBlockDataReader(), path)
    name = data_model.vtkCompositeDataSet.NAME()
    return {found.GetMetaData(i).Get(name): found.GetBlock(i) for i in range(found.GetNumberOfBlocks())}


def hierarchy(path):
    reader = xml.vtkXMLUniformGridAMRReader()
    reader.SetMaximumLevelsToReadByDefault(0)
    found = read(reader, path)
    levels = range(found.GetNumberOfLevels())
    return found, [
        [found.GetDataSetAsCartesianGrid(level, i) for i in range(found.GetNumberOfBlocks(level))]
        for level in levels
    ]


def on(level, container, step):
    """x + 10 y + 100 z + 1000 step at the places of a level."""
    places = level.coordinates(container, level.whole(container))
    x, y, z = np.meshgrid(*places, indexing="ij")
    return x + 10 * y + 100 * z + 1000 * step


def check_image(image, step):
    """See that every value of an image is the one of its place."""
    cells = to_numpy(image.GetCellData().GetArray("press_CC_0"))
    faces = to_numpy(image.GetCellData().GetArray("uvel_FC_1"))
    nodes = to_numpy(image.GetPointData().GetArray("velocity_0"))
    place = np.array([1.0, 10.0, 100.0])
    low, high = (np.array(image.GetExtent()[side::2]) for side in (0, 1))
    shape = (high - low)[::-1]
    for index in range(image.GetNumberOfCells()):
        ijk = low + np.unravel_index(index, shape)[::-1] + 0.5
        due = (image.GetOrigin() + ijk * image.GetSpacing()) @ place + 1000 * step
        if not image.IsCellVisible(index) and np.isnan(cells[index]):
            continue  # in no patch
        assert cells[index] == pytest.approx(due, rel=1e-14)
        assert faces[index] == pytest.approx(due, rel=1e-14)
    for index in range(image.GetNumberOfPoints()):
        if not np.isnan(nodes[index]).any():
            due = np.array(image.GetPoint(index)) @ place + 1000 * step
            assert nodes[index] == pytest.approx([due, 2 * due, -due], rel=1e-14)


def make(path, ratio=(2, 2, 2)):
    """6 x 4 x 2 cells of 1 m, and an L of three patches that divides cells by `ratio`."""
    rx, ry, rz = ratio
    coarse = Level(
        0,
        (0.5, 0.0, -1.0),
        (1.0, 1.0, 1.0),
        (1, 1, 0),
        (False,) * 3,
        (Patch(0, 0, (0, 0, 0), (3, 4, 2)), Patch(1, 1, (3, 0, 0), (6, 4, 2))),
    )
    corner = [((1, 1), (3, 2)), ((3, 1), (4, 2)), ((1, 2), (2, 3))]
    fine = Level(
        1,
        (0.5, 0.0, -1.0),
        (1.0 / rx, 1.0 / ry, 1.0 / rz),
        (1, 0, 0),
        (False,) * 3,
        tuple(
            Patch(2 + n, n % 2, (a * rx, b * ry, 0), (c * rx, d * ry, 2 * rz))
            for n, ((a, b), (c, d)) in enumerate(corner)
        ),
    )
    grid = Grid((coarse, fine))
    with ArchiveWriter.create(path, grid, input_xml="<a/>") as writer:
        for step, time in TIMES.items():
            fields = []
            for level in grid.levels:
                nodes = on(level, "NCVariable", step)
                fields.append(
                    {
                        NODES: {0: np.stack([nodes, 2 * nodes, -nodes], axis=-1)},
                        CELLS: {0: on(level, "CCVariable", step)},
                        FACES: {1: on(level, "SFCXVariable", step)},
                    }
                )
            fields[0][X] = {0: np.empty((0, 3))}
            fields[1][X] = {0: np.array([[2.0, 1.5, 0.0], [4.0, 1.5, 0.0]])}
            writer.write_timestep(step, time, 0.1, fields)
    return path


@pytest.fixture(scope="module")
def two_levels(tmp_path_factory):
    return make(tmp_path_factory.mktemp("levels") / "two.uda")


def test_blocks(two_levels, tmp_path):
    (listing,) = convert(two_levels, tmp_path / "out.vtm")
    assert listing == tmp_path / "out.pvd"
    listed = [
        (float(d.get("timestep")), d.get("file")) for d in etree.parse(listing).getroot().iter("DataSet")
    ]
    assert listed == [(0.1, "out_00001.vtm"), (0.4, "out_00004.vtm")]
    for step in TIMES:
        found = blocks(tmp_path / f"out_0000{step}.vtm")
        assert list(found) == ["particles", "level 0", "level 1"]
        assert found["particles"].GetNumberOfPoints() == 2
        check_image(found["level 0"], step)
        check_image(found["level 1"], step)
        stamp = found["level 1"].GetFieldData().GetArray("TimeValue").GetValue(0)
        assert stamp == TIMES[step]
    coarse, fine = found["level 0"], found["level 1"]
    seen = [sum(map(image.IsCellVisible, range(image.GetNumberOfCells()))) for image in (coarse, fine)]
    assert seen == [6 * 4 * 2 - 4 * 2, 4 * 2 * 8]
    volume = sum(n * h for n, h in zip(seen, (1.0, 0.125), strict=True))
    assert volume == 6 * 4 * 2


def test_a_series_has_the_levels_as_parts(two_levels, tmp_path):
    _particles, grid = convert(two_levels, tmp_path / "out.pvd")
    listed = [(d.get("part"), d.get("file")) for d in etree.parse(grid).getroot().iter("DataSet")]
    assert listed[2:] == [("0", "out/grid_l0_00004.vti"), ("1", "out/grid_l1_00004.vti")]
    image = read(xml.vtkXMLImageDataReader(), tmp_path / "out" / "grid_l1_00004.vti")
    check_image(image, 4)
    assert image.HasAnyBlankCells()


def test_a_hierarchy(two_levels, tmp_path):
    (listing,) = convert(two_levels, tmp_path / "out.vth")
    assert listing == tmp_path / "out.vth.series"
    assert json.loads(listing.read_text()) == {
        "file-series-version": "1.0",
        "files": [{"name": "out_00001.vth", "time": 0.1}, {"name": "out_00004.vth", "time": 0.4}],
    }
    for step in TIMES:
        whole, levels = hierarchy(tmp_path / f"out_0000{step}.vth")
        assert whole.CheckValidity()
        assert whole.GetRefinementRatio(0) == 2
        assert list(map(len, levels)) == [1, 3]  # the L is no box: a file for each patch
        for image in (image for images in levels for image in images):
            assert image.GetExtent()[::2] == (0, 0, 0)
            check_image(image, step)
    assert [image.GetBounds() for image in levels[1]] == [
        (1.5, 3.5, 1, 2, -1, 1),
        (3.5, 4.5, 1, 2, -1, 1),
        (1.5, 2.5, 2, 3, -1, 1),
    ]
    coarse = levels[0][0]
    hidden = [i for i in range(coarse.GetNumberOfCells()) if not coarse.IsCellVisible(i)]
    assert hidden == [i + 6 * j + 24 * k for k in (0, 1) for i, j in ((1, 1), (2, 1), (3, 1), (1, 2))]


def test_one_step_is_one_file(two_levels, tmp_path):
    assert convert(two_levels, tmp_path / "a.vth", steps=[4]) == [tmp_path / "a.vth"]
    assert convert(two_levels, tmp_path / "b.vtm", steps=[-1], variables=["press_CC"]) == [tmp_path / "b.vtm"]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a", "a.vth", "b", "b.vtm"]
    assert list(blocks(tmp_path / "b.vtm")) == ["level 0", "level 1"]
    _whole, levels = hierarchy(tmp_path / "a.vth")
    check_image(levels[1][2], 4)


def test_levels_that_divide_axes_unequally_are_no_hierarchy(tmp_path):
    path = make(tmp_path / "flat.uda", ratio=(2, 2, 1))
    with pytest.raises(ArchiveError, match=r"level 1 divides cells by \[2, 2, 1\].*write a \.vtm or a \.pvd"):
        convert(path, tmp_path / "out.vth")
    convert(path, tmp_path / "out.vtm", steps=[4])
    found = blocks(tmp_path / "out.vtm")
    check_image(found["level 0"], 4)
    check_image(found["level 1"], 4)
    seen = [
        sum(map(image.IsCellVisible, range(image.GetNumberOfCells())))
        for image in found.values()
        if image.IsA("vtkImageData")
    ]
    assert seen == [6 * 4 * 2 - 4 * 2, 4 * 2 * 4]


def test_several_levels_do_not_fit_into_one_image(two_levels, tmp_path):
    with pytest.raises(ArchiveError, match=r"2 levels at step 1 do not fit into one image; write a \.vth"):
        convert(two_levels, tmp_path / "out.vti")


@pytest.mark.parametrize(
    ("suffix", "variable", "kind"), [(".vth", "p.x", "grid"), (".vtp", "press_CC", "particle")]
)
def test_nothing_of_the_kind_is_said(two_levels, tmp_path, suffix, variable, kind):
    with pytest.raises(ArchiveError, match=f"there is no {kind} variable to convert"):
        convert(two_levels, tmp_path / f"out{suffix}", variables=[variable])


def test_vtkhdf_has_a_file_for_each_level(two_levels, tmp_path):
    pytest.importorskip("h5py")
    hdf = pytest.importorskip("vtkmodules.vtkIOHDF")
    files = convert(two_levels, tmp_path / "x.vtkhdf")
    assert [file.name for file in files] == ["x.vtkhdf", "x_grid.vtkhdf", "x_grid_l1.vtkhdf"]
    for file, seen in zip(files[1:], (6 * 4 * 2 - 4 * 2, 4 * 2 * 8), strict=True):
        reader = hdf.vtkHDFReader()
        reader.SetFileName(str(file))
        reader.UpdateInformation()
        for row, step in enumerate(TIMES):
            reader.SetStep(row)
            reader.Modified()
            reader.Update()
            image = reader.GetOutputDataObject(0)
            assert reader.GetTimeValue() == TIMES[step]
            check_image(image, step)
            marks = to_numpy(image.GetCellData().GetArray("vtkGhostType"))
            assert np.count_nonzero(marks == 0) == seen


def test_a_level_that_changes_does_not_fit_into_vtkhdf(tmp_path):
    pytest.importorskip("h5py")
    grids = [
        Grid((Level(0, (0, 0, 0), (1, 1, 1), (0, 0, 0), (False,) * 3, (Patch(0, 0, (0, 0, 0), (n, 2, 2)),)),))
        for n in (2, 4)
    ]
    with ArchiveWriter.create(tmp_path / "a.uda", grids[0], input_xml="<a/>") as writer:
        for step, grid in enumerate(grids, 1):
            writer.use_grid(grid)
            writer.write_timestep(step, step / 10, 0.1, {CELLS: {0: on(grid.levels[0], "CCVariable", step)}})
    with pytest.raises(ArchiveError, match=r"level 0 is another grid at step 2 .*; write a \.pvd, or fewer"):
        convert(tmp_path / "a.uda", tmp_path / "x.vtkhdf")
    assert not list(tmp_path.glob("x*"))
    convert(tmp_path / "a.uda", tmp_path / "x.vti")
    images = [read(xml.vtkXMLImageDataReader(), tmp_path / f"x_0000{step}.vti") for step in (1, 2)]
    assert [image.GetNumberOfCells() for image in images] == [8, 16]


@pytest.mark.parametrize("suffix", [".pvd", ".vtp", ".vtm", ".vth"])
def test_an_archive_without_time_steps_is_said(two_levels, tmp_path, suffix):
    index = tmp_path / "a.uda" / "index.xml"
    index.parent.mkdir()
    text = (two_levels / "index.xml").read_text()
    index.write_text("\n".join(line for line in text.splitlines() if "<timestep " not in line))
    with pytest.raises(ArchiveError, match="there are no time steps"):
        convert(index.parent, tmp_path / f"out{suffix}")
    assert not list(tmp_path.glob("out*"))


def test_a_hierarchy_of_a_region(two_levels, tmp_path):
    convert(two_levels, tmp_path / "out.vth", region=Region((1.5, 0, -1), (2.5, 4, 0)), steps=[1])
    _whole, levels = hierarchy(tmp_path / "out.vth")
    boxes = [[image.GetBounds() for image in images] for images in levels]
    assert boxes == [[(1.5, 2.5, 0, 4, -1, 0)], [(1.5, 2.5, 1, 2, -1, 0), (1.5, 2.5, 2, 3, -1, 0)]]
    check_image(levels[0][0], 1)
    check_image(levels[1][1], 1)
    convert(two_levels, tmp_path / "left.vth", region=Region((0.5, 0, -1), (1.5, 4, 1)), steps=[1])
    assert list(map(len, hierarchy(tmp_path / "left.vth")[1])) in ([1], [1, 0])


def test_the_levels_that_sus_wrote(sus, tmp_path):
    archive = Archive(sus("mpmice_two_levels"))
    convert(archive.path, tmp_path / "out.vth", variables=["press_CC", "vel_CC"])
    for timestep in archive.timesteps:
        whole, levels = hierarchy(tmp_path / f"out_{timestep.step:05d}.vth")
        assert whole.CheckValidity()
        for index, (image,) in enumerate(levels):
            for name, components in (("press_CC", 1), ("vel_CC", 3)):
                found = archive.grid_variable(timestep.step, name, 0, index)
                inside = found.values[found.interior.within(found.origin)]
                due = (
                    inside.reshape(*inside.shape[:3], components)
                    .transpose(2, 1, 0, 3)
                    .reshape(-1, components)
                )
                array = to_numpy(image.GetCellData().GetArray(f"{name}_0")).reshape(-1, components)
                assert np.array_equal(array, due)
    assert levels[1][0].GetBounds() == (2, 4, 2, 4, 2, 4)
