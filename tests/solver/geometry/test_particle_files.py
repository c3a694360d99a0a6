"""Bodies listed particle by particle in files."""

import numpy as np
import pytest

from solver.geometry.file import File

SPACING = (0.5, 0.25, 0.2)


def write_text(path, rows, head=""):
    path.write_text(head + "".join(" ".join(f"{v:.17g}" for v in row) + "\n" for row in rows))


def load(folder, **given):
    return File("body", **given).load(lambda name: folder / name)


@pytest.fixture
def rows():
    return np.random.default_rng(2).uniform(0.1, 0.9, (7, 7))


def test_columns_follow_the_variables(tmp_path, rows):
    write_text(tmp_path / "body", rows)
    made = load(tmp_path, var=("p.temperature", "p.velocity"), per_patch=False).particles(SPACING, False)
    assert np.array_equal(made["position"], rows[:, :3])
    assert np.array_equal(made["temperature"], rows[:, 3])
    assert np.array_equal(made["velocity"], rows[:, 4:])
    assert made.keys() == {"position", "temperature", "velocity", "surface"}


@pytest.mark.parametrize(("form", "kind"), [("lsb", "<f8"), ("msb", ">f8")])
def test_binary_files(tmp_path, rows, form, kind):
    rows.astype(kind).tofile(tmp_path / "body")
    piece = load(tmp_path, var=("p.color", "p.externalforce"), format=form, per_patch=False)
    assert np.array_equal(piece.particles(SPACING, False)["external_force"], rows[:, 4:])


def test_files_for_each_patch_come_after_the_box(tmp_path, rows):
    box = "0 0 0 1 1 1\n"
    write_text(tmp_path / "body.0", rows[:4, :3], box)
    write_text(tmp_path / "body.1", [], box)
    write_text(tmp_path / "body.2", rows[4:, :3], box)
    assert np.array_equal(load(tmp_path).particles(SPACING, False)["position"], rows[:, :3])


def test_the_file_itself_where_there_are_none_for_patches(tmp_path, rows):
    write_text(tmp_path / "body", rows[:, :3])
    piece = load(tmp_path)
    lower, upper = piece.bounding_box()
    assert lower == tuple(rows[:, :3].min(axis=0))
    assert upper == tuple(rows[:, :3].max(axis=0))
    assert list(piece.inside(np.array([rows[0, :3], [2.0, 0.0, 0.0]]))) == [True, False]


def test_particle_vectors_make_size_and_volume(tmp_path):
    write_text(tmp_path / "body", [(0.5, 0.5, 0.5, 0.1, 0, 0, 0, 0.2, 0.1, 0, 0, 0.3)])
    piece = load(tmp_path, var=("p.rvec1", "p.rvec2", "p.rvec3"))
    made = piece.particles(SPACING, False)
    assert made["size"][0] == pytest.approx(np.array([[0.2, 0, 0], [0, 0.8, 0], [0, 0.5, 1.5]]))
    assert made["volume"] == pytest.approx(0.1 * 0.2 * 0.3)
    assert piece.particles(SPACING, True)["volume"] == pytest.approx(0.1 * 0.2 * 0.3 / 6.0)


def test_left_handed_vectors_are_put_right(tmp_path):
    write_text(tmp_path / "body", [(0.5, 0.5, 0.5, 0.1, 0, 0, 0, 0, 0.3, 0, 0.2, 0)])
    made = load(tmp_path, var=("p.rvec1", "p.rvec2", "p.rvec3")).particles(SPACING, False)
    assert made["size"][0] == pytest.approx(np.diag([0.2, 0.8, 1.5]))
    assert made["volume"] == pytest.approx(0.006)


def test_a_volume_makes_a_cube(tmp_path):
    write_text(tmp_path / "body", [(0.5, 0.5, 0.5, 0.001)])
    made = load(tmp_path, var=("p.volume",)).particles(SPACING, False)
    assert made["size"][0] == pytest.approx(np.diag([0.1 / 0.5, 0.1 / 0.25, 0.1 / 0.2]))
    assert made["volume"] == pytest.approx(0.001)


def test_wrong_files(tmp_path):
    with pytest.raises(ValueError, match="cannot find the file 'body' with the particles"):
        load(tmp_path)
    (tmp_path / "body").write_text("0 0 0 1\n0 0 1\n")
    with pytest.raises(ValueError, match="body:2: expected 4 numbers, found '0 0 1'"):
        load(tmp_path, var=("p.volume",))
    np.zeros(7).tofile(tmp_path / "body")
    with pytest.raises(ValueError, match="not a whole number of rows of 3 doubles"):
        load(tmp_path, format="lsb")
    with pytest.raises(ValueError, match=r"var is 'p.colour'; it must be one of"):
        File("body", ("p.colour",))
    with pytest.raises(ValueError, match="format is 'csv'"):
        File("body", format="csv")
    with pytest.raises(ValueError, match="has not been read"):
        File("body").bounding_box()
