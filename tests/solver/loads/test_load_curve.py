from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.loads.curve import LoadCurve, TimePoint


def ramp(*points):
    return LoadCurve(4, tuple(TimePoint(time, load) for time, load in points))


def test_between_points_the_load_is_on_the_straight_line():
    c = ramp((0.0, 1e4), (2.0, 4e5), (20.0, 4e5))
    assert c.at(0.5) == pytest.approx(1e4 + 0.25 * 3.9e5, rel=1e-15)
    assert c.at(2.0) == 4e5
    assert c.at(7.0) == 4e5


def test_outside_the_points_the_load_is_constant():
    c = ramp((1.0, 5.0), (3.0, -7.0))
    assert c.at(0.0) == 5.0
    assert c.at(1e9) == -7.0


def test_many_times_at_once_give_an_array_of_their_shape():
    c = ramp((0.0, 0.0), (1.0, 10.0))
    np.testing.assert_allclose(
        c.at(np.array([[0.1, 0.2], [0.3, 9.0]])), [[1.0, 2.0], [3.0, 10.0]], rtol=1e-15
    )


def test_one_point_is_a_constant():
    c = ramp((3.0, 2.5))
    assert c.at(0.0) == 2.5
    np.testing.assert_array_equal(c.at([1.0, 5.0]), [2.5, 2.5])


@given(
    st.lists(st.floats(0.0, 1e6), min_size=2, max_size=8, unique=True),
    st.lists(st.floats(-1e6, 1e6), min_size=8, max_size=8),
    st.floats(-1e6, 2e6),
)
def test_agrees_with_numpy_interpolation(times, loads, time):
    times = sorted(times)
    c = ramp(*zip(times, loads, strict=False))
    expected = np.interp(time, times, loads[: len(times)])
    assert c.at(time) == pytest.approx(expected, rel=1e-9, abs=1e-6)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (
            [(0.0, 1.0), (2.0, 1.0), (1.0, 3.0)],
            "load curve 4: time 1 of point 3 does not exceed time 2 of point 2",
        ),
        ([(0.0, 1.0), (0.0, 2.0)], "time 0 of point 2 does not exceed time 0 of point 1"),
        ([(-2.0, 1.0), (-1.0, 2.0)], "load curve 4: time -1 of point 2 is negative"),
        ([(0.0, 1.0), (float("nan"), 2.0)], "time nan of point 2"),
        ([], "load curve 4 has no <time_point>"),
    ],
)
def test_points_out_of_order_are_named(points, words):
    with pytest.raises(ValueError, match=words):
        ramp(*points)


def test_material_of_a_curve():
    point = (TimePoint(0.0, 1.0),)
    assert LoadCurve(1, point).acts_on(3)
    assert LoadCurve(1, point, material=3).acts_on(3)
    assert not LoadCurve(1, point, material=0).acts_on(3)
