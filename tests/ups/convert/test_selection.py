"""Parts of archives converted: regions, every so-manieth step, measures; boxes, and several steps at once."""

import csv
import sys

import numpy as np
import pytest
from click.testing import CliRunner

from cli import main
from ups.archive import Archive, ArchiveError, ArchiveWriter, Box, Grid, Variable
from ups.convert import Region, convert
from ups.convert.glyphs import particle_edges

POSITION = Variable("p.x", "ParticleVariable", "Point")
STRESS = Variable("p.stress", "ParticleVariable", "Matrix3")
DEFORMATION = Variable("p.deformationMeasure", "ParticleVariable", "Matrix3")
VOLUME = Variable("p.volume", "ParticleVariable", "double")
SHEAR = np.array([[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


@pytest.fixture
def growing(tmp_path):
    """Five steps; at step s material 0 has s + 1 particles in a row, material 1 has 2; sheared by SHEAR."""
    grid = Grid.single_level([Box((0, 0, 0), (8, 2, 2))], spacing=(1, 1, 1))
    level = grid.levels[0]
    nodes, cells = (level.whole(kind).shape for kind in ("NCVariable", "CCVariable"))
    with ArchiveWriter.create(tmp_path / "grow.uda", grid, input_xml="<a/>") as writer:
        for step in range(1, 6):
            x = {
                0: np.array([[i + 0.5, 0.5, 0.5] for i in range(step + 1)]),
                1: np.array([[0.5, 1.5, 0.5], [6.5, 1.5, 0.5]]),
            }
            fields = {
                POSITION: x,
                STRESS: {
                    m: np.array([np.diag([3.0 * step * (i + 1), 0, 0]) for i in range(len(x[m]))]) for m in x
                },
                DEFORMATION: {m: np.broadcast_to(SHEAR, (len(x[m]), 3, 3)) for m in x},
                VOLUME: {m: np.full(len(x[m]), 0.125) for m in x},
                Variable("g.mass", "NCVariable", "double"): {0: np.indices(nodes)[0] + 100.0 * step},
                Variable("press_CC", "CCVariable", "double"): {0: np.indices(cells)[0] + 10.0 * step},
            }
            writer.write_timestep(step, step / 10, 0.1, fields)
    return writer.directory


@pytest.fixture
def pyvista():
    return pytest.importorskip("pyvista")


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_measures(growing, tmp_path, pyvista):
    convert(growing, tmp_path / "out.pvd", variables=["stress:vonMises", "stress:XX", "stress:pressure"])
    data = pyvista.read(tmp_path / "out" / "particles_00002.vtp")
    assert set(data.point_data) == {"material", "stress_vonMises", "stress_XX", "stress_pressure"}
    assert data["stress_vonMises"].tolist() == pytest.approx([6, 12, 18, 6, 12])
    assert data["stress_pressure"].tolist() == pytest.approx([-2, -4, -6, -2, -4])
    (table,) = convert(growing, tmp_path / "out.csv", variables=["stress:vonMises"], steps=[2])
    assert [float(row["p.stress:vonMises"]) for row in rows(table)] == pytest.approx([6, 12, 18, 6, 12])
    (file,) = convert(growing, tmp_path / "out.npz", variables=["stress:vonMises"])
    with np.load(file) as found:
        assert found["t00002/0/p.stress:vonMises"] == pytest.approx([6, 12, 18])


def test_every_second_step(growing, tmp_path, pyvista):
    convert(growing, tmp_path / "out.pvd", variables=["p.volume"], every=2)
    assert pyvista.get_reader(tmp_path / "out.pvd").time_values == [0.1, 0.3, 0.5]
    convert(growing, tmp_path / "some.pvd", variables=["p.volume"], steps=[1, 2, -1], every=2)
    assert pyvista.get_reader(tmp_path / "some.pvd").time_values == [0.1, 0.5]


def test_a_region(growing, tmp_path, pyvista):
    region = Region((2.0, 0.0, 0.0), (4.2, 2.0, 1.0))
    convert(growing, tmp_path / "out.pvd", region=region, steps=[5])
    particles = pyvista.read(tmp_path / "out" / "particles_00005.vtp")
    assert particles.points[:, 0].tolist() == [2.5, 3.5]
    assert particles["material"].tolist() == [0, 0]
    assert particles["stress"][:, 0].tolist() == [45, 60]
    grid = pyvista.read(tmp_path / "out" / "grid_l0_00005.vti")
    assert grid.bounds == (2, 5, 0, 2, 0, 1)  # the cells that the region touches
    assert sorted(set(grid.point_data["mass_0"])) == [502, 503, 504, 505]
    assert sorted(set(grid.cell_data["press_CC_0"])) == [52, 53, 54]
    files = convert(growing, tmp_path / "out.csv", region=region, steps=[5])
    particle_rows, node_rows, cell_rows = map(rows, files)
    assert [row["x"] for row in particle_rows] == ["2.5", "3.5"]
    assert (len(node_rows), len(cell_rows)) == (4 * 3 * 2, 3 * 2 * 1)
    (file,) = convert(growing, tmp_path / "out.npz", region=region, steps=[5])
    with np.load(file) as found:
        assert found["t00005/0/p.x"][:, 0].tolist() == [2.5, 3.5]
        assert len(found["t00005/1/p.x"]) == 0
        assert found["t00005/l0/0/g.mass"].shape == (4, 3, 2)
        assert found["t00005/l0/0/g.mass/low"].tolist() == [2, 0, 0]


def test_a_region_outside_the_grid_gives_no_cells(growing, tmp_path):
    (particles,) = convert(
        growing, tmp_path / "o.pvd", region=Region((20, 0, 0), (30, 1, 1)), variables=["p.volume", "g.mass"]
    )
    assert "grid" not in particles.read_text()
    with pytest.raises(ValueError, match="is empty"):
        Region((0, 0, 0), (1, 0, 1))


def test_particles_as_deformed_boxes(growing, tmp_path, pyvista):
    convert(growing, tmp_path / "out.pvd", variables=["p.volume"], glyphs=True, steps=[1])
    data = pyvista.read(tmp_path / "out" / "particles_00001.vtu")
    assert data.n_cells == 4
    assert data.compute_cell_sizes()["Volume"] == pytest.approx([0.125] * 4)
    assert data.cell_data["volume"].tolist() == [0.125] * 4
    corners = data.get_cell(0).points
    assert corners.mean(axis=0) == pytest.approx([0.5, 0.5, 0.5])
    # the edge along y leans by half its length, as the shear has it
    assert corners[3] - corners[0] == pytest.approx(0.5 * SHEAR[:, 1])


@pytest.mark.parametrize("suffix", [".vtp", ".vtu"])
def test_particles_only(growing, tmp_path, pyvista, suffix):
    assert convert(growing, tmp_path / f"a{suffix}", steps=[2]) == [tmp_path / f"a{suffix}"]
    data = pyvista.read(tmp_path / f"a{suffix}")
    assert data.points.tolist() == Archive(growing).particles(2, "p.x").tolist()
    assert data["material"].tolist() == [0, 0, 0, 1, 1]
    assert data.point_data.active_vectors_name is None
    assert data.GetPointData().GetTensors().GetName() == "stress"
    assert (data.n_cells, data.n_points) == (5, 5)
    assert convert(growing, tmp_path / f"b{suffix}") == [tmp_path / "b.pvd"]
    reader = pyvista.get_reader(tmp_path / "b.pvd")
    reader.set_active_time_value(0.5)
    assert reader.read()[0].n_points == 8
    assert sorted(p.name for p in tmp_path.glob("b*")) == [
        "b.pvd",
        *(f"b_0000{s}{suffix}" for s in range(1, 6)),
    ]


def test_a_suffix_in_capitals_is_the_same_format(growing, tmp_path):
    for name in ("a.vtp", "a.VTP"):
        convert(growing, tmp_path / name, steps=[2])
    assert (tmp_path / "a.vtp").read_bytes() == (tmp_path / "a.VTP").read_bytes()


def test_boxes_in_a_file_of_their_own(growing, tmp_path, pyvista):
    convert(growing, tmp_path / "a.vtu", steps=[2], glyphs=True)
    data = pyvista.read(tmp_path / "a.vtu")
    assert data.n_cells == 5
    assert data.compute_cell_sizes()["Volume"] == pytest.approx([0.125] * 5)
    with pytest.raises(ArchiveError, match=r"boxes do not fit into this format; write a \.vtu or a \.pvd"):
        convert(growing, tmp_path / "a.vtp", glyphs=True)


@pytest.mark.parametrize(
    ("heights", "sides"), [((0.25,), (0.2, 0.2, 0.5)), ((0.125, 0.375), (0.02 ** (1 / 3),) * 3)]
)
def test_boxes_in_a_grid_of_one_layer(tmp_path, heights, sides):
    grid = Grid.single_level([Box((0, 0, 0), (4, 4, 1))], spacing=(0.5, 0.5, 0.5))
    x = np.array([[0.3, 0.3, z] for z in heights])
    with ArchiveWriter.create(tmp_path / "a", grid, input_xml="<a/>") as writer:
        writer.write_timestep(1, 0.1, 0.1, {POSITION: {0: x}, VOLUME: {0: np.full(len(x), 0.02)}})
    edges = particle_edges(Archive(tmp_path / "a"), 1, 0, grid.levels[0])
    assert edges == pytest.approx(np.tile(np.diag(sides), (len(x), 1, 1)))


def test_boxes_of_rotational_symmetry(tmp_path):
    grid = Grid.single_level([Box((0, 0, 0), (4, 4, 1))], spacing=(0.5, 0.5, 0.5))
    x, sides, stretch = (
        np.array([[0.5, 0.3, 0.25], [1.5, 0.3, 0.25]]),
        np.array([0.1, 0.2]),
        np.diag([2.0, 0.5, 1.5]),
    )
    fields = {
        POSITION: {0: x},
        DEFORMATION: {0: np.stack([np.eye(3), stretch])},
        VOLUME: {0: x[:, 0] * sides**2},
    }
    deck = "<a><MPM><axisymmetric>true</axisymmetric></MPM></a>"
    with ArchiveWriter.create(tmp_path / "a", grid, input_xml=deck) as writer:
        writer.write_timestep(1, 0.1, 0.1, fields)
    edges = particle_edges(Archive(tmp_path / "a"), 1, 0, grid.levels[0])
    assert edges[0, :2, :2] == pytest.approx(0.1 * np.eye(2))
    assert edges[1, :2, :2] == pytest.approx(0.2 * stretch[:2, :2])


def test_steps_written_at_the_same_time_are_the_same(growing, tmp_path):
    counts = []
    convert(growing, tmp_path / "one.pvd")
    convert(growing, tmp_path / "two.pvd", jobs=3, progress=lambda *done: counts.append(done))
    assert counts == [(i, 5) for i in range(1, 6)]
    files = sorted((tmp_path / "one").iterdir())
    assert [f.name for f in files] == sorted(f.name for f in (tmp_path / "two").iterdir())
    assert all(f.read_bytes() == (tmp_path / "two" / f.name).read_bytes() for f in files)


def test_vtkhdf(growing, tmp_path, pyvista):
    pytest.importorskip("h5py")
    hdf = pytest.importorskip("vtkmodules.vtkIOHDF")
    files = convert(
        growing, tmp_path / "out.vtkhdf", variables=["stress", "stress:vonMises", "g.mass", "press_CC"]
    )
    assert [file.name for file in files] == ["out.vtkhdf", "out_grid.vtkhdf"]
    archive = Archive(growing)
    for path, check in zip(files, (_check_particles, _check_grid), strict=True):
        reader = hdf.vtkHDFReader()
        reader.SetFileName(str(path))
        reader.UpdateInformation()
        assert reader.GetNumberOfSteps() == 5
        for step in range(1, 6):
            reader.SetStep(step - 1)
            reader.Modified()
            reader.Update()
            assert reader.GetTimeValue() == step / 10
            check(archive, step, pyvista.wrap(reader.GetOutputDataObject(0)))


def _check_particles(archive, step, data):
    parts = [data[i] for i in range(data.n_partitions)]
    points = np.concatenate([part.points for part in parts])
    assert points.tolist() == archive.particles(step, "p.x").tolist()
    stress = np.concatenate([part["stress"] for part in parts])
    assert stress.tolist() == archive.particles(step, "p.stress").reshape(-1, 9).tolist()
    assert sum(part.n_verts for part in parts) == len(points)
    assert all(part.verts.reshape(-1, 2)[:, 1].tolist() == list(range(part.n_points)) for part in parts)
    assert np.concatenate([part["material"] for part in parts]).tolist() == [0] * (step + 1) + [1] * 2


def _check_grid(archive, step, data):
    assert data.bounds == (0, 8, 0, 2, 0, 2)
    expected = archive.grid_variable(step, "g.mass", 0).values
    assert data.point_data["mass_0"].tolist() == expected.ravel(order="F").tolist()
    expected = archive.grid_variable(step, "press_CC", 0).values
    assert data.cell_data["press_CC_0"].tolist() == expected.ravel(order="F").tolist()


def test_without_h5py_the_way_to_get_it_is_said(growing, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(ArchiveError, match=r"pip install 'ups-mpm\[archive\]', or write a \.pvd"):
        convert(growing, tmp_path / "out.vtkhdf")


def test_the_command(growing, tmp_path):
    out = tmp_path / "out.csv"
    arguments = ["convert", str(growing), str(out), "--variable", "stress:XX", "--every", "2"]
    done = CliRunner().invoke(main, [*arguments, "--region", *["0", "0", "0", "1", "1", "1"]])
    assert done.output == f"{out}\n"
    assert [(row["step"], row["p.stress:XX"]) for row in rows(out)] == [("1", "3"), ("3", "9"), ("5", "15")]
    wrong = CliRunner().invoke(main, [*arguments, "--region", *["0", "0", "0", "1", "1", "0"]])
    assert wrong.exit_code == 2
    assert "is empty" in wrong.output
