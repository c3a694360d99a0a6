"""Cylinders with particles in rings."""

import math

import numpy as np
import pytest

from solver.geometry.smoothcyl import SmoothCylinder

SPACING = (0.1, 0.1, 0.1)
DIRECTIONS = [
    (0.0, 0.0, 2.0),
    (0.0, 0.0, -2.0),
    (2.0, 0.0, 0.0),
    (0.0, -2.0, 0.0),
    (1.2, 0.0, 1.6),
    (1.0, -1.5, 0.8),
]


def hollow(top=(0.0, 0.0, 2.0), scheme="constant_particle_volumes", **given):
    return SmoothCylinder(scheme, (0.0, 0.0, 0.0), top, 0.5, 4, 10, 24, inner_radius=0.3, **given)


@pytest.mark.parametrize("top", DIRECTIONS)
@pytest.mark.parametrize("scheme", ["pie_slices", "constant_particle_volumes"])
def test_particles_fill_the_cylinder_exactly_whatever_its_direction(top, scheme):
    piece = hollow(top, scheme)
    made = piece.particles(SPACING, False)
    length = math.hypot(*top)
    assert made["volume"].sum() == pytest.approx(math.pi * (0.25 - 0.09) * length)
    assert piece.inside(made["position"]).all()
    assert made["position"].mean(axis=0) == pytest.approx(0.5 * np.array(top), abs=1e-12)
    along = made["position"] @ np.array(top) / length
    assert np.unique(along.round(9)) == pytest.approx((np.arange(10) + 0.5) * length / 10)


@pytest.mark.parametrize("top", DIRECTIONS)
def test_particle_vectors_span_the_particle(top):
    """Their determinant is the length of the arc, times the width of the ring, times the layer."""
    made = hollow(top).particles(SPACING, False)
    determinants = np.linalg.det(made["size"]) * math.prod(SPACING)
    assert determinants == pytest.approx(made["volume"])


def test_vectors_lie_along_the_arc_the_radius_and_the_axis():
    made = hollow((1.2, 0.0, 1.6)).particles(SPACING, False)
    vectors = made["size"] * 0.1
    axis = np.array([0.6, 0.0, 0.8])
    radial = made["position"] - np.outer(made["position"] @ axis, axis)
    assert np.cross(vectors[:, :, 2], axis) == pytest.approx(np.zeros_like(radial), abs=1e-12)
    assert np.cross(vectors[:, :, 1], radial) == pytest.approx(np.zeros_like(radial), abs=1e-12)
    assert np.einsum("ni,ni->n", vectors[:, :, 0], radial) == pytest.approx(np.zeros(len(radial)), abs=1e-12)


def test_a_sector_goes_from_its_start_to_its_end():
    made = hollow(arc_start_angle=30.0, arc_angle=120.0).particles(SPACING, False)
    angle = np.degrees(np.arctan2(made["position"][:, 1], made["position"][:, 0]))
    assert angle.min() > 30.0
    assert angle.max() < 120.0
    assert made["volume"].sum() == pytest.approx(math.pi / 4 * (0.25 - 0.09) * 2.0)


def test_slices_get_wider_where_particles_would_be_too_small():
    piece = SmoothCylinder("pie_slices", (0.0, 0.0, 0.0), (0.0, 0.0, 0.1), 0.5, 20, 1, 200)
    volume = piece.particles(SPACING, False)["volume"]
    assert volume.sum() == pytest.approx(math.pi * 0.25 * 0.1)
    # Only the innermost ring is so small that even one particle of it is less than a twentieth of a cell.
    assert volume[volume >= 0.05e-3].sum() > 0.99 * volume.sum()


def test_end_caps_are_solid():
    piece = hollow(endcap_thickness=0.4)
    made = piece.particles(SPACING, False)
    assert made["volume"].sum() == pytest.approx(math.pi * ((0.25 - 0.09) * 2.0 + 2 * 0.25 * 0.4))
    assert piece.inside(made["position"]).all()
    assert list(piece.inside(np.array([[0.0, 0.0, -0.2], [0.0, 0.0, 1.0], [0.0, 0.0, 2.5]]))) == [
        True,
        False,
        False,
    ]
    heights = np.unique(made["position"][:, 2].round(9))
    assert heights == pytest.approx(np.arange(-0.3, 2.4, 0.2))


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"inner_radius": 0.5}, "inner_radius is 0.5; it must be less than outer_radius"),
        ({"outer_radius": 0.0}, "outer_radius is 0"),
        ({"top": (0.0, 0.0, 0.0)}, "the same point"),
        ({"num_radial": 0}, "num_radial is 0; it must be at least 1"),
        ({"num_axial": -1}, "num_axial is -1"),
        ({"discretization_scheme": "pie_slices"}, "needs num_angular"),
        ({"discretization_scheme": "pie"}, "it must be one of pie_slices, constant_particle_volumes"),
        ({"arc_angle": 400.0}, "arc_angle is 400; it must be at most 360"),
        ({"arc_start_angle": 90.0, "arc_angle": 80.0}, "must be greater than arc_start_angle"),
        ({"endcap_thickness": -0.1}, "endcap_thickness is -0.1"),
    ],
)
def test_parameters_that_make_no_cylinder(given, says):
    good = {
        "discretization_scheme": "constant_particle_volumes",
        "bottom": (0.0, 0.0, 0.0),
        "top": (0.0, 0.0, 1.0),
        "outer_radius": 0.5,
        "num_radial": 2,
        "num_axial": 2,
    }
    with pytest.raises(ValueError, match=says):
        SmoothCylinder(**(good | given))
