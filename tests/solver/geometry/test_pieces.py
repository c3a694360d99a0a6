"""Simple pieces: volumes from closed forms, what belongs to the surface, and wrong parameters."""

import math

import numpy as np
import pytest

from solver.declare import FAMILIES, fields
from solver.geometry.box import Box
from solver.geometry.cone import Cone
from solver.geometry.cylinder import Cylinder
from solver.geometry.ellipsoid import Ellipsoid
from solver.geometry.null import Null
from solver.geometry.parallelepiped import Parallelepiped
from solver.geometry.sphere import Sphere
from solver.geometry.torus import Torus

SKEWED = ((0.2, -0.4, 0.25), (0.2, 0.1, 0.0), (-0.05, 0.1, 0.2))
PIECES = {
    "box": (Box((-0.3, 0.1, 0.2), (0.4, 0.5, 0.8)), 0.7 * 0.4 * 0.6),
    "sphere": (Sphere((0.1, -0.2, 0.3), 0.6), 4.0 / 3.0 * math.pi * 0.6**3),
    "cylinder": (Cylinder((-0.5, -0.4, -0.3), (0.3, 0.4, 0.6), 0.3), math.pi * 0.09 * math.sqrt(2.09)),
    "cone": (
        Cone((0.2, 0.1, 0.7), (-0.1, 0.0, -0.6), 0.5, 0.2),
        math.pi / 3.0 * math.sqrt(0.09 + 0.01 + 1.69) * (0.25 + 0.1 + 0.04),
    ),
    "ellipsoid": (Ellipsoid((0.1, 0.0, 0.0), rx=0.8, ry=0.5, rz=0.3), 4.0 / 3.0 * math.pi * 0.12),
    "turned ellipsoid": (
        Ellipsoid((0.0, 0.0, 0.0), *SKEWED),
        4.0 / 3.0 * math.pi * math.prod(math.hypot(*v) for v in SKEWED),
    ),
    "torus x": (Torus((0.0, 0.0, 0.0), 0.6, 0.25, "x", 0.4), 2.0 * math.pi**2 * 0.6 * 0.0625),
    "torus y": (Torus((0.0, 0.0, 0.0), 0.6, 0.25, "y", -0.7), 2.0 * math.pi**2 * 0.6 * 0.0625),
    "torus z": (Torus((0.0, 0.0, 0.0), 0.6, 0.25, "z", 1.3), 2.0 * math.pi**2 * 0.6 * 0.0625),
    "parallelepiped": (
        Parallelepiped((-0.5, -0.5, -0.5), (0.1, -0.5, -0.4), (-0.4, 0.3, -0.5), (-0.5, -0.2, 0.4)),
        abs(np.linalg.det([[0.6, 0.0, 0.1], [0.1, 0.8, 0.0], [0.0, 0.3, 0.9]])),
    ),
    "null": (Null(), 0.0),
}


def counted_volume(piece, n):
    """The mean over eight lattices that are shifted against each other, of which none is special."""
    h = 2.4 / n
    axis = -1.2 + np.arange(n) * h
    shifts = h * np.modf(np.outer(np.arange(8), [0.819173, 0.671044, 0.549700]))[0]
    return np.mean([piece.on_lattice(axis + x, axis + y, axis + z).sum() for x, y, z in shifts]) * h**3


@pytest.mark.parametrize("name", PIECES)
def test_volume_of_lattice_points_approaches_the_closed_form(name):
    piece, exact = PIECES[name]
    for n, error in ((20, 0.04), (80, 0.01)):
        assert counted_volume(piece, n) == pytest.approx(exact, rel=error)


@pytest.mark.parametrize("name", PIECES)
def test_the_bounding_box_holds_the_piece_and_the_lattice_agrees_with_points(name):
    piece, _ = PIECES[name]
    axis = np.linspace(-0.97, 0.96, 32)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    inside = piece.inside(points)
    assert np.array_equal(piece.on_lattice(axis, axis, axis).ravel(), inside)
    lower, upper = piece.bounding_box()
    assert np.all(points[inside] >= lower)
    assert np.all(points[inside] <= upper)


@pytest.mark.parametrize(
    ("piece", "on_surface", "belongs"),
    [
        (Box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)), [(0, 0, 0), (1, 2, 3), (1, 0, 1.5)], True),
        (Sphere((1.0, 0.0, 0.0), 2.0), [(3, 0, 0), (1, 0, -2)], True),
        (Cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 2.0), 1.0), [(1, 0, 1), (0, 0, 0), (0, 1, 2)], True),
        (Cone((0.0, 0.0, 0.0), (0.0, 0.0, 2.0), 1.0, 0.0), [(1, 0, 0), (0.5, 0, 1), (0, 0, 2)], True),
        (Ellipsoid((0.0, 0.0, 0.0), rx=1.0, ry=2.0, rz=4.0), [(1, 0, 0), (0, -2, 0), (0, 0, 4)], True),
        (Torus((0.0, 0.0, 0.0), 2.0, 1.0, "z"), [(3, 0, 0), (0, 1, 0), (2, 0, 1)], False),
        (
            Parallelepiped((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.0)),
            [(0, 1, 1), (1, 0, 1), (1, 1, 0)],
            False,
        ),
        (
            Parallelepiped((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.0)),
            [(2, 1, 1), (1, 2, 1), (1, 1, 2), (2, 2, 2)],
            True,
        ),
    ],
)
def test_whether_the_surface_belongs_to_the_piece(piece, on_surface, belongs):
    assert list(piece.inside(np.array(on_surface, float))) == [belongs] * len(on_surface)


def test_a_cone_that_points_down_has_a_bounding_box():
    lower, upper = Cone((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 0.2, 0.1).bounding_box()
    assert lower == (-0.2, -0.2, -0.1)
    assert upper == (0.2, 0.2, 1.2)


def test_the_box_of_a_cylinder_is_tight():
    lower, upper = Cylinder((0.0, 0.0, 0.0), (3.0, 0.0, 4.0), 1.0).bounding_box()
    assert lower == pytest.approx((-0.8, -1.0, -0.6))
    assert upper == pytest.approx((3.8, 1.0, 4.6))


ORIGIN, ONE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Box(ONE, (2.0, 1.0, 2.0)), "max is 1 in y; it must be greater than min"),
        (lambda: Box(ONE, (float("nan"), 2.0, 2.0)), "max is nan in x"),
        (lambda: Sphere(ORIGIN, 0.0), "radius is 0; it must be greater than 0"),
        (lambda: Sphere(ORIGIN, float("nan")), "radius is nan"),
        (lambda: Cylinder(ORIGIN, ORIGIN, 1.0), "the same point"),
        (lambda: Cylinder(ORIGIN, ONE, -1.0), "radius is -1"),
        (lambda: Cone(ORIGIN, ORIGIN, 1.0, 1.0), "the same point"),
        (lambda: Cone(ORIGIN, ONE), "both 0"),
        (lambda: Cone(ORIGIN, ONE, 1.0, -0.5), "top_radius is -0.5; it must be at least 0"),
        (lambda: Ellipsoid(ORIGIN, rx=1.0, ry=1.0), "all longer than 0"),
        (
            lambda: Ellipsoid(ORIGIN, ONE, (1.0, -1.0, 0.0), (0.0, 1.0, 1.0)),
            "v1 and v3 are not at right angles",
        ),
        (lambda: Torus(ORIGIN, 1.0, 0.0, "x"), "minor_radius is 0"),
        (lambda: Torus(ORIGIN, 1.0, 0.1, "w"), "axis is 'w'; it must be one of x, y, z"),
        (
            lambda: Parallelepiped(ORIGIN, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1.0, 0.0)),
            "lie in a plane",
        ),
    ],
)
def test_parameters_that_make_no_shape(make, says):
    with pytest.raises(ValueError, match=says):
        make()


def test_pieces_are_declared_under_the_tags_of_decks():
    models = FAMILIES["geometry"].models
    assert set(models) == {
        *("box", "cylinder", "sphere", "cone", "ellipsoid", "torus", "parallelepiped", "smoothcyl"),
        *("tri", "line_segment", "file", "null", "union", "intersection", "difference"),
    }
    for cls in models.values():
        label = next(info for info in fields(cls) if info.name == "label")
        assert label.parameter.attribute
        assert not label.required
