"""Values at places, against closed forms and what Uintah's lineextract prints."""

import csv
import io
import math

import numpy as np
import pytest
from click.testing import CliRunner

from cli import main
from ups.archive import Archive, ArchiveError, ArchiveWriter, Box, Grid, Variable
from ups.inspect.extract import along_line, at_point, extract, of_particle


@pytest.mark.parametrize("point", [(0.0, 0.0, 0.0), (2.0, 1.0, 0.5), (0.3, 0.77, 0.1), (1.5, 0.5, 0.5)])
def test_a_linear_field_is_interpolated_exactly(make, point):
    table = at_point(Archive(make()), ["g.mass"], point)
    assert table.names == ("step", "time", "g.mass")
    x, y, z = point
    expected = [1 + x + 10 * y + 100 * z + 1000 * step for step in (1, 4, 9)]
    assert table["g.mass"] == pytest.approx(expected, rel=1e-14)
    assert table["time"].tolist() == [0.125, 0.5, 1.125]


def test_cell_values_hold_beyond_the_last_centre(make):
    # cells are numbered 0.. over 6 x 4 x 1 with extra cells; centre of the cell (1, 0, 0) is (0.75, 0.25, 0.25)
    archive = Archive(make())
    assert at_point(archive, ["press_CC"], (0.75, 0.25, 0.25), steps=[4])["press_CC"] == [9 + 4]
    assert at_point(archive, ["press_CC"], (1.0, 0.25, 0.5), steps=[4])["press_CC"] == [9 + 2 + 4]


def test_measures_and_components(make):
    table = at_point(Archive(make()), ["speed", "p.stress", "stress:XY"], (0.8, 0.2, 0.1), steps=[4])
    assert table["p.velocity:magnitude"] == [pytest.approx(math.hypot(3, 16))]
    # the particle at (0.75, 0.25, 0.25) is the only one in this cell
    assert [table[f"p.stress.{n}"][0] for n in ("XX", "XY", "ZZ")] == [36, 40, 68]
    assert table["p.stress:XY"] == [40]


def test_particles_are_averaged_over_the_cell(tmp_path):
    grid = Grid.single_level([Box((0, 0, 0), (2, 2, 1))], spacing=(1, 1, 1))
    x = np.array([[0.1, 0.1, 0.5], [0.9, 0.4, 0.5], [1.5, 0.5, 0.5]])
    with ArchiveWriter.create(tmp_path / "a", grid, input_xml="<a/>") as writer:
        fields = {
            Variable("p.x", "ParticleVariable", "Point"): {0: x},
            Variable("p.mass", "ParticleVariable", "double"): {0: np.array([1.0, 2.0, 5.0])},
        }
        writer.write_timestep(1, 0.1, 0.1, fields)
    archive = Archive(tmp_path / "a")
    table = along_line(archive, ["mass"], (0.5, 0.5, 0.5), (2.0, 0.5, 0.5), count=4)
    assert table["p.mass"].tolist() == [1.5, 5.0, 5.0, 5.0]
    assert table["distance"].tolist() == [0.0, 0.5, 1.0, 1.5]
    assert np.isnan(at_point(archive, ["p.mass"], (0.5, 1.5, 0.5))["p.mass"]).all()


def test_a_line_has_a_point_a_cell_by_default(make):
    table = along_line(Archive(make()), ["g.mass"], (0, 0.25, 0), (2, 0.25, 0), material=1, steps=[1, -1])
    assert table["x"].tolist() == [0, 0.5, 1, 1.5, 2] * 2
    assert table["g.mass"] == pytest.approx([s * 1000 + 3.5 + x for s in (1, 9) for x in (0, 0.5, 1, 1.5, 2)])


def test_periodic_values_continue(tmp_path):
    grid = Grid.single_level([Box((0, 0, 0), (4, 1, 1))], spacing=(1, 1, 1), periodic=(True, False, False))
    with ArchiveWriter.create(tmp_path / "a", grid, input_xml="<a/>") as writer:
        nodes = np.broadcast_to(np.array([0.0, 1.0, 2.0, 3.0])[:, None, None], (4, 2, 2))
        writer.write_timestep(1, 0.1, 0.1, {Variable("g.mass", "NCVariable", "double"): {0: nodes}})
    archive = Archive(tmp_path / "a")
    assert at_point(archive, ["g.mass"], (3.5, 0.5, 0.5))["g.mass"] == [1.5]
    assert at_point(archive, ["g.mass"], (4.0, 0.5, 0.5))["g.mass"] == [0.0]


def test_a_particle_over_time(make):
    def leave(step, fields):
        if step == 9:
            for variable, by_material in fields.items():
                if variable.is_particle:
                    by_material[0] = by_material[0][[3, 1, 0]]

    archive = Archive(make(change=leave))
    table = of_particle(archive, ["p.x", "p.velocity:Y"], 70)
    assert table["step"].tolist() == [1, 4, 9]
    assert table["p.x.X"].tolist() == [0.25] * 3
    assert table["p.velocity:Y"].tolist() == [4, 16, 36]
    assert of_particle(archive, ["p.x"], 30)["step"].tolist() == [1, 4]
    assert of_particle(archive, ["p.x"], 1 << 40)["p.x.Y"].tolist() == [0.75] * 3
    with pytest.raises(ArchiveError, match="no particle is called 31"):
        of_particle(archive, ["p.x"], 31)


@pytest.mark.parametrize(
    ("names", "options", "message"),
    [
        (["g.mass"], {"point": (0, 0, 3)}, r"\[0.0, 0.0, 3.0\] is not inside the grid"),
        (["g.mas"], {"point": (0, 0, 0)}, r"no variable g\.mas; did you mean g\.mass"),
        (["g.mass:magnitude"], {"point": (0, 0, 0)}, "has no measure magnitude"),
        (["g.mass"], {"point": (0, 0, 0), "material": 7}, "not stored for material 7"),
        (["g.mass"], {"point": (0, 0, 0), "level": 3}, "no level 3"),
        (["g.mass"], {"particle": 70}, "not on particles"),
        (["g.mass"], {"point": (0, 0, 0), "steps": [3]}, "time step 3 is not stored"),
    ],
)
def test_what_is_not_there_is_said(make, names, options, message):
    with pytest.raises(ArchiveError, match=message):
        extract(Archive(make()), names, **options)


def test_the_command(make, tmp_path):
    archive = str(make())
    done = CliRunner().invoke(
        main, ["extract", archive, "g.mass", "--point", "0.5", "0.5", "0", "--step", "-1"]
    )
    assert done.exit_code == 0
    (row,) = csv.DictReader(io.StringIO(done.output))
    assert (row["step"], float(row["g.mass"])) == ("9", 9006.5)
    out = tmp_path / "line.csv"
    done = CliRunner().invoke(
        main,
        ["extract", archive, "speed", "--line", *["0.1", "0.1", "0.1", "1.9", "0.1", "0.1"], "-o", str(out)],
    )
    assert (done.exit_code, done.output) == (0, "")
    assert out.read_text().startswith("step,time,x,y,z,distance,p.velocity:magnitude\n")
    assert CliRunner().invoke(main, ["extract", archive, "g.mass"]).exit_code == 2
    bad = CliRunner().invoke(main, ["extract", archive, "speed", "--particle", "70", "-o", "/nowhere/x.csv"])
    assert (bad.exit_code, "check the path" in bad.output) == (1, True)


def test_the_numbers_that_lineextract_prints(sus):
    archive = Archive(sus("disks_sulsky"))
    # lineextract -v g.mass -m 1 -timestep 3 -istart 4 10 0 -iend 7 10 0
    found = along_line(archive, ["g.mass"], (0.2, 0.5, 0), (0.35, 0.5, 0), material=1, steps=[151])["g.mass"]
    expected = [
        2.2245259444612850e-02,
        6.0032855977607248e-02,
        6.5383651789333447e-02,
        6.5404430327893545e-02,
    ]
    assert found == pytest.approx(expected, rel=1e-15)
    # lineextract -v p.velocity -m 0 -timestep 3 -istart 4 10 0 -iend 5 10 0, which averages over cells
    found = along_line(archive, ["velocity"], (0.225, 0.525, 0.025), (0.275, 0.525, 0.025), steps=[151])
    assert found["p.velocity.X"] == pytest.approx([2.9298412697159368e-02, 2.3691682213102624e-02], rel=1e-14)
    assert found["p.velocity.Y"] == pytest.approx([9.1074354045347056e-02, 9.8410702166509337e-02], rel=1e-14)
