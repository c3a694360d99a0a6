"""Bodies inside a mesh of triangles, and inside an outline in the plane."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from solver.geometry.line_segment import LineSegment
from solver.geometry.tri import Tri

CORNERS = np.array(list(np.ndindex(2, 2, 2)), float)


def sphere_points(count):
    """Points spread evenly over the unit sphere, by the golden angle."""
    k = np.arange(count)
    z = 1.0 - (2.0 * k + 1.0) / count
    angle = k * math.pi * (3.0 - math.sqrt(5.0))
    return np.stack([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z], axis=1)


def write(folder, points, triangles):
    np.savetxt(folder / "body.pts", points, fmt="%.17g")
    np.savetxt(folder / "body.tri", triangles, fmt="%d")
    return Tri("body").load(lambda name: folder / name)


def test_a_cube_is_the_box_of_its_corners(tmp_path):
    piece = write(tmp_path, CORNERS, ConvexHull(CORNERS).simplices)
    points = np.random.default_rng(5).uniform(-0.3, 1.3, (4000, 3))
    assert np.array_equal(piece.inside(points), np.all((points > 0.0) & (points < 1.0), axis=1))


def test_lines_through_edges_and_corners_of_the_mesh_count_once(tmp_path):
    piece = write(tmp_path, CORNERS, ConvexHull(CORNERS).simplices)
    # The diagonals of the faces are edges of the mesh, and these lattice points lie behind them.
    axis = np.array([0.125, 0.25, 0.5, 0.75, 0.875])
    assert piece.on_lattice(axis, axis, axis).all()
    assert not piece.on_lattice(axis + 1.0, axis, axis).any()


def test_a_fine_ball_has_the_volume_of_its_hull(tmp_path):
    points = sphere_points(400)
    hull = ConvexHull(points)
    piece = write(tmp_path, points, hull.simplices)
    axis = -1.05 + (np.arange(30) + 0.5) * 2.1 / 30
    found = piece.on_lattice(axis, axis, axis)
    assert found.sum() * (2.1 / 30) ** 3 == pytest.approx(hull.volume, rel=5e-3)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    lattice = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    assert np.array_equal(piece.inside(lattice), found.ravel())
    signed = (lattice @ hull.equations[:, :3].T + hull.equations[:, 3]).max(axis=1)
    assert np.array_equal(found.ravel(), signed < 0.0)


def test_a_hollow_body_is_not_filled(tmp_path):
    outer = ConvexHull(CORNERS).simplices
    piece = write(tmp_path, np.vstack([CORNERS, 0.25 + 0.5 * CORNERS]), np.vstack([outer, outer + 8]))
    assert list(piece.inside(np.array([[0.1, 0.45, 0.6], [0.5, 0.45, 0.6]]))) == [True, False]


def test_bounding_box(tmp_path):
    piece = write(tmp_path, CORNERS * [1.0, 2.0, 3.0], ConvexHull(CORNERS).simplices)
    assert piece.bounding_box() == ((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))


@pytest.mark.parametrize(
    ("points", "triangles", "says"),
    [
        (None, "0 1 2\n", "cannot find the file 'body.pts' with the points"),
        ("0 0 0\n1 0 0\n0 1 0\n", None, "cannot find the file 'body.tri' with the triangles"),
        ("0 0 0\n1 0\n0 1 0\n", "0 1 2\n", r"body.pts:2: expected 3 numbers, found '1 0'"),
        ("0 0 0\n1 0 zero\n0 1 0\n", "0 1 2\n", r"body.pts:2: expected 3 numbers"),
        ("0 0 0\n1 0 0\n0 1 0\n", "0 1 2\n0 1.5 2\n", r"body.tri:2: expected 3 whole numbers"),
        ("0 0 0\n1 0 0\n0 1 0\n", "0 1 2\n1 2 3\n", r"triangle 2 \(1 2 3\) names a point that is not there"),
        ("0 0 0\n1 0 0\n0 1 0\n", "-1 1 2\n", r"triangle 1 \(-1 1 2\)"),
        ("", "0 1 2\n", "body.pts: no line of 3 numbers"),
    ],
)
def test_wrong_mesh_files(tmp_path, points, triangles, says):
    for suffix, text in (("pts", points), ("tri", triangles)):
        if text is not None:
            (tmp_path / f"body.{suffix}").write_text(text)
    with pytest.raises(ValueError, match=says):
        Tri("body").load(lambda name: tmp_path / name)


def test_a_mesh_that_is_not_text(tmp_path):
    (tmp_path / "body.pts").write_bytes(b"\xff\xfe\x00\x01" * 10)
    with pytest.raises(ValueError, match=r"body.pts: not a text file"):
        Tri("body").load(lambda name: tmp_path / name)


def test_a_mesh_that_was_not_read():
    with pytest.raises(ValueError, match="has not been read"):
        Tri("body").bounding_box()


def test_the_inside_of_an_outline(tmp_path):
    star = [
        (math.cos(a) * r, math.sin(a) * r)
        for a, r in zip(np.arange(10) * math.pi / 5, [1.0, 0.4] * 5, strict=True)
    ]
    np.savetxt(tmp_path / "star.pts", star, fmt="%.17g")
    piece = LineSegment("star.pts").load(lambda name: tmp_path / name)
    axis = -1.0 + (np.arange(80) + 0.5) / 40
    area = 0.5 * abs(sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairwise([*star, star[0]])))
    assert piece.on_lattice(axis, axis, np.array([7.0])).sum() / 1600 == pytest.approx(area, rel=0.01)
    assert list(piece.inside(np.array([[0.9, 0.0, 0.0], [-0.9, 0.0, 0.0]]))) == [True, False]


def test_an_outline_of_two_corners(tmp_path):
    (tmp_path / "line.pts").write_text("0 0\n1 1\n")
    with pytest.raises(ValueError, match="at least 3 corners, and this has 2"):
        LineSegment("line.pts").load(lambda name: tmp_path / name)
