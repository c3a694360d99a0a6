"""What pictures show: the right numbers at the right places, with units and time; and movies of them."""

import sys

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from cli import main
from ups.archive import Archive, ArchiveError, ArchiveWriter, Variable
from ups.pictures import flat, solid
from ups.pictures.history import plot_histories
from ups.pictures.movie import movie
from ups.pictures.plot import plot
from ups.pictures.view import Slice, View, particle_frame, range_of


def view_of(archive, *arguments, **options):
    view = View.choose(Archive(archive), *arguments, **options)
    return view, range_of(view, [6])


def test_a_profile_along_the_only_axis(make):
    view, shown = view_of(make((8, 1, 1)))
    assert view.axes == (0,)
    assert view.label == "velocity:magnitude [m/s]"
    axes = flat.draw(view, 6, shown).axes[0]
    (line,) = axes.lines
    x, speed = line.get_data()
    assert speed == pytest.approx(6 * x)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [m]", "velocity:magnitude [m/s]")
    assert axes.get_title() == "a block, time 1.5 s (step 6)"
    assert axes.get_xlim() == (0, 4)


def test_particles_in_a_plane_are_the_boxes_they_fill(make):
    view, shown = view_of(make((4, 2, 1)), "speed")
    figure = flat.draw(view, 6, shown)
    axes, bar = figure.axes
    (boxes,) = axes.collections
    assert bar.get_ylabel() == "velocity:magnitude [m/s]"
    assert boxes.get_clim() == (6 * 0.125, 6 * 1.875)
    corners = boxes.get_paths()[0].vertices[:4]
    # stretched to twice its width, its volume that of two cubes of a quarter
    assert np.ptp(corners, axis=0) == pytest.approx([0.5, 0.25])
    assert axes.get_aspect() == 1
    values = particle_frame(view, 6).values
    assert sorted(boxes.get_array()) == pytest.approx(sorted(values))


@pytest.mark.parametrize("variable", ["speed", "g.temperature", "press_CC"])
def test_colours_are_those_of_the_numbers_at_their_places(make, variable):
    from matplotlib import colormaps

    view, shown = view_of(make((4, 2, 1)), variable, materials=[0])
    figure = flat.draw(view, 6, shown)
    image = flat.pixels(figure)
    for x in (0.385, 1.26, 1.635):
        fastest = (np.floor((x + 0.25) / 0.25 - 0.5) + 0.5) * 0.25  # of two boxes there, the one on top
        numbers = {"speed": 6 * fastest, "g.temperature": 6 * x / 0.5, "press_CC": np.floor(x / 0.5)}
        number = numbers[variable]
        share = (number - shown.values[0]) / (shown.values[1] - shown.values[0])
        across, up = figure.axes[0].transData.transform((x, 0.3))
        found = image[image.shape[0] - round(up), round(across)] / 255.0
        assert found == pytest.approx(colormaps["viridis"](min(share, 1.0))[:3], abs=0.04)
    assert image[3, 3].tolist() == [255, 255, 255]


def test_nodes_and_cells_in_a_plane(make):
    archive = make((4, 2, 1))
    view, shown = view_of(archive, "g.temperature")
    assert view.materials == (1,)  # both together, as the particles have one material
    assert "material" not in view.title(6)
    assert "material 0" in View.choose(view.archive, "g.temperature", materials=[0]).title(6)
    (mesh,) = flat.draw(view, 6, shown).axes[0].images
    assert np.asarray(mesh.get_array()).reshape(3, 5).tolist() == [[10, 16, 22, 28, 34]] * 3
    view, shown = view_of(archive, "press_CC")
    (mesh,) = flat.draw(view, 6, shown).axes[0].images
    assert np.asarray(mesh.get_array()).reshape(2, 4).tolist() == [[0, 1, 2, 3]] * 2


def test_a_slice_through_a_body(make):
    archive = make((4, 4, 4))
    view, shown = view_of(archive, "speed", plane=Slice.parse("x=0.6"))
    assert view.axes == (1, 2)
    places = particle_frame(view, 6).positions
    assert sorted(set(places[:, 0])) == [0.375, 0.625]  # within half a cell
    axes = flat.draw(view, 6, shown).axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("y [m]", "z [m]")
    assert "slice x = 0.6 m" in axes.get_title().replace("\n", " ")
    view, shown = view_of(archive, "g.temperature", plane=Slice(0, 0.75), materials=[0])
    (mesh,) = flat.draw(view, 6, shown).axes[0].images
    assert set(np.asarray(mesh.get_array()).ravel()) == {9.0}  # between the nodes 1 and 2


@pytest.mark.parametrize("variable", ["speed", "g.temperature", "press_CC"])
def test_a_body_in_space(make, variable):
    view, shown = view_of(make((4, 4, 4)), variable)
    assert view.axes == (0, 1, 2)
    with solid.rendered(view, 6, shown) as plotter:
        ends = plotter.scalar_bar.GetLookupTable().GetTableRange()
        colours = solid.pixels(plotter)
    assert ends == pytest.approx(shown.values)
    assert colours.shape == (800, 1000, 3)
    body = colours[200:600, 200:800].reshape(-1, 3).astype(int)
    assert np.mean(np.ptp(body, axis=1) > 40) > 0.05  # something coloured stands in the middle


def test_a_small_body_fills_the_picture(make):
    _view, shown = view_of(make((24, 24, 24), body=(2, 2, 2)), "speed")
    assert shown.low == (0, 0, 0)
    assert max(shown.high) < 2


def test_a_mirror_image_beside_the_particles(make):
    archive = make((4, 2, 1))
    view, shown = view_of(archive, "velocity:X", mirrored=[0])
    frame = particle_frame(view, 6)
    ours, image = np.split(frame.positions, 2)
    assert image == pytest.approx(ours * [-1, 1, 1])
    assert frame.values == pytest.approx(6 * frame.positions[:, 0])  # the component changes its sign
    assert (shown.low[0], shown.high[0]) == (-2, 2)
    view, _shown = view_of(archive, "speed", mirrored=[0, 1, 0])
    assert particle_frame(view, 6).values == pytest.approx(np.tile(ours[:, 0] * 6, 4))
    with pytest.raises(ArchiveError, match="only they can be mirrored"):
        view_of(archive, "g.temperature", mirrored=[0])
    done = CliRunner().invoke(main, ["plot", str(archive), "--mirror", "x", "-o", str(archive) + ".png"])
    assert done.exit_code == 0


def test_a_fluid_is_shown_by_its_pressure(make, tmp_path):
    stress = Variable("p.stress", "ParticleVariable", "Matrix3")
    archive = Archive(make((4, 2, 1)))
    held = archive.fields(6)
    count = len(next(iter(held.values()))[0])
    for noise, name in ((1e-12, "p.stress:pressure"), (0.1, "p.stress:vonMises")):
        values = -5.0 * np.eye(3) + noise * np.array([[0, 1, 0], [1, 0, 0], [0, 0, 0]])
        folder = tmp_path / name.partition(":")[2]
        with ArchiveWriter.create(folder, archive.grid(6), input_xml="<a/>") as writer:
            writer.write_timestep(1, 1.0, 1.0, held | {stress: {0: np.tile(values, (count, 1, 1))}})
        assert View.choose(Archive(folder)).named.declaration.name == name


def test_numbers_that_differ_by_rounding_are_one_colour(make):
    _view, shown = view_of(make((4, 2, 1)), "volume")
    assert shown.values == pytest.approx((0.99 / 32, 1.01 / 32))


def test_pictures_of_the_command(make, tmp_path):
    archive = make((4, 2, 1))
    out = tmp_path / "x.png"
    arguments = ["plot", str(archive), "--variable", "velocity:X", "-o", str(out)]
    for options, width in (([], 960), (["--width", "500"], 500)):
        done = CliRunner().invoke(main, [*arguments, *options])
        assert (done.exit_code, done.output) == (0, f"{out}\n")
        with Image.open(out) as picture:
            assert picture.size[0] == width
    for wrong in (["--slice", "z"], ["--slice", "z=a"], ["--step", "first"], ["--range", "5", "1"], []):
        arguments = ["plot", str(archive), *wrong, *(["-o", str(out)] if wrong else [])]
        assert CliRunner().invoke(main, arguments).exit_code == 2


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"variable": "strain:XX"}, "there is no variable strain"),
        ({"variable": "p.deformationMeasure:strain"}, "not a number but a Matrix3"),
        ({"materials": [4]}, "not stored for material 4; its materials are: 0"),
        ({"level": 1}, "there is no level 1"),
        ({"step": 3}, "time step 3 is not stored"),
        ({"plane": Slice(2, 9.0)}, "the slice z=9 misses the grid; z reaches from 0 to 0.5"),
        ({"out": "x.xyz"}, r"no format of pictures is known by the suffix '\.xyz'"),
        ({"out": "nowhere/x.png"}, "check the path"),
    ],
)
def test_what_cannot_be_drawn_is_said(make, tmp_path, options, message):
    options = {"out": "x.png", **options}
    options["out"] = tmp_path / options["out"]
    with pytest.raises(ArchiveError, match=message):
        plot(make((4, 2, 1)), **options)


def test_a_movie_as_gif(make, tmp_path):
    done = []
    out = movie(make((4, 2, 1)), tmp_path / "x.gif", "speed", progress=lambda *counts: done.append(counts))
    assert done == [(1, 2), (2, 2)]
    with Image.open(out) as film:
        assert film.n_frames == 2
        first = np.asarray(film.convert("RGB")).astype(int)
        assert first[0, 0].tolist() == [255, 255, 255]
        film.seek(1)
        assert film.info["duration"] == 100
        assert np.abs(np.asarray(film.convert("RGB")).astype(int) - first).max() > 50


def test_the_frames_of_a_movie_share_a_colour_bar(make):
    view = View.choose(Archive(make((4, 2, 1))), "speed")
    assert range_of(view, [2, 6]).values == (2 * 0.125, 6 * 1.875)


def test_a_movie_as_mp4(make, tmp_path):
    archive = make((4, 2, 1))
    try:
        out = movie(archive, tmp_path / "x.mp4")
    except ArchiveError as error:
        pytest.skip(error.message)
    assert out.read_bytes()[4:8] == b"ftyp"


def test_a_missing_encoder_is_said(make, tmp_path, monkeypatch):
    archive = make((4, 2, 1))
    monkeypatch.setenv("PATH", "")
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(ArchiveError, match=r"pip install imageio-ffmpeg, or write a \.gif"):
        movie(archive, tmp_path / "x.mp4")
    with pytest.raises(ArchiveError, match=r"give a name ending in \.gif or \.mp4"):
        movie(
            make((4, 2, 1)) if not (tmp_path / "a.uda").exists() else tmp_path / "a.uda", tmp_path / "x.avi"
        )


def test_histories(make, tmp_path):
    archive = make((4, 2, 1))
    out = plot_histories(archive, ["KineticEnergy", "TotalMomentum:Y"], tmp_path / "x.png")
    with Image.open(out) as picture:
        assert picture.size[0] == 960
    done = CliRunner().invoke(main, ["history", str(archive), "KineticEnerg", "-o", str(out)])
    assert done.exit_code == 1
    assert "did you mean KineticEnergy?" in done.output
    with pytest.raises(ArchiveError, match="has no component W; there are: X, Y, Z"):
        plot_histories(archive, ["TotalMomentum:W"], out)
    assert "KineticEnergy [J]" in plot_histories(archive, [], tmp_path / "all.svg").read_text()


def test_histories_of_two_archives(make, tmp_path):
    archive = make((4, 2, 1))
    other = archive.rename(tmp_path / "b.uda")
    arguments = ["history", str(make((4, 2, 1))), "KineticEnergy", "TotalMomentum", "--with", str(other)]
    done = CliRunner().invoke(main, [*arguments, "-o", str(tmp_path / "x.svg")])
    assert done.exit_code == 0, done.output
    drawn = (tmp_path / "x.svg").read_text()
    for name in ("KineticEnergy (a.uda)", "KineticEnergy (b.uda)", "TotalMomentum:Y (b.uda)"):
        assert f"<!-- {name} -->" in drawn
    assert "<!-- TotalMomentum [kg m/s] -->" in drawn
