"""Unions, intersections and differences behave as sets do."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.geometry.box import Box
from solver.geometry.difference import Difference
from solver.geometry.intersection import Intersection
from solver.geometry.null import Null
from solver.geometry.sphere import Sphere
from solver.geometry.union import Union

AXIS = np.linspace(-1.0, 1.0, 13)
POINTS = np.stack([g.ravel() for g in np.meshgrid(AXIS, AXIS, AXIS, indexing="ij")], axis=1)

coordinate = st.floats(-1.0, 1.0)
point = st.tuples(coordinate, coordinate, coordinate)
spheres = st.builds(Sphere, point, st.floats(0.05, 0.8))
boxes = st.builds(
    lambda corner, sides: Box(corner, tuple(c + s for c, s in zip(corner, sides, strict=True))),
    point,
    st.tuples(*[st.floats(0.05, 1.0)] * 3),
)
pieces = st.recursive(
    spheres | boxes | st.just(Null()),
    lambda inner: st.one_of(
        st.builds(lambda a, b: Union((a, b)), inner, inner),
        st.builds(lambda a, b: Intersection((a, b)), inner, inner),
        st.builds(lambda a, b: Difference((a, b)), inner, inner),
    ),
    max_leaves=4,
)


def members(piece):
    return piece.inside(POINTS)


@given(pieces, pieces, pieces)
def test_set_algebra(a, b, c):
    ma, mb, mc = members(a), members(b), members(c)
    assert np.array_equal(members(Union((a, b, c))), ma | mb | mc)
    assert np.array_equal(members(Intersection((a, b, c))), ma & mb & mc)
    assert np.array_equal(members(Difference((a, b))), ma & ~mb)
    # De Morgan within c.
    outside_both = members(Difference((c, Union((a, b)))))
    assert np.array_equal(outside_both, members(Intersection((Difference((c, a)), Difference((c, b))))))


@given(pieces)
def test_lattice_and_points_agree_and_the_box_holds_the_piece(piece):
    inside = members(piece)
    on_lattice = piece.on_lattice(AXIS, AXIS, AXIS).transpose(2, 1, 0).ravel()
    assert np.array_equal(on_lattice, inside)
    lower, upper = piece.bounding_box()
    assert np.all((POINTS[inside] >= lower) & (POINTS[inside] <= upper))


def test_what_does_not_overlap_intersects_in_a_box_of_no_size():
    apart = Intersection((Sphere((-1.0, 0.0, 0.0), 0.5), Sphere((1.0, 0.0, 0.0), 0.5)))
    lower, upper = apart.bounding_box()
    assert lower[0] == upper[0]
    assert not members(apart).any()


@pytest.mark.parametrize("count", [0, 1, 3])
def test_a_difference_needs_two_pieces(count):
    with pytest.raises(ValueError, match=f"exactly two pieces in it, and has {count}"):
        Difference((Null(),) * count)


@pytest.mark.parametrize("kind", [Union, Intersection])
def test_nothing_to_combine(kind):
    with pytest.raises(ValueError, match="needs at least one piece"):
        kind(())
