from __future__ import annotations

import math

import numpy as np
import pytest

from solver.grid import Grid, Patch
from solver.nodal import new_nodal_fields
from solver.prescribed_motion import read_prescribed_deformation, rotation_about

IDENTITY = "1 0 0 0 1 0 0 0 1"
STRETCHED = "1.5 0.2 0 0 0.9 0 0.1 0 1.1"
TURNED = f"""0   {IDENTITY}   0  0 0 1
1.0 {STRETCHED}  90 0 0 1

3.0 1 0 0 0 2 0 0 0 1  60 0 2 0
"""


@pytest.fixture
def table(tmp_path):
    def write(text, exact=False):
        file = tmp_path / "time_defgrad_rotation"
        file.write_text(text)
        return read_prescribed_deformation(file, exact)

    return write


def turn(axis, degrees):
    """A rotation by cosines and sines of the coordinate axes, unlike Rodrigues' formula."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    if axis == "z":
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def matrix(text):
    return np.array([float(word) for word in text.split()]).reshape(3, 3)


def test_between_rows_f_is_interpolated_and_turns_are_composed(table):
    history = table(TURNED)
    half = 0.5 * (np.eye(3) + matrix(STRETCHED))
    np.testing.assert_allclose(history.deformation_gradient(0.5), turn("z", 45.0) @ half, atol=1e-15)
    np.testing.assert_allclose(
        history.deformation_gradient(1.0), turn("z", 90.0) @ matrix(STRETCHED), atol=1e-15
    )
    later = 0.25 * np.diag([1.0, 2.0, 1.0]) + 0.75 * matrix(STRETCHED)
    np.testing.assert_allclose(
        history.deformation_gradient(1.5), turn("y", 15.0) @ turn("z", 90.0) @ later, atol=1e-15
    )


def test_the_first_rows_turn_comes_before_everything(table):
    history = table(f"0 {IDENTITY} 30 0 0 1\n1 {IDENTITY} 0 0 0 0\n")
    np.testing.assert_allclose(history.deformation_gradient(0.0), turn("z", 30.0), atol=1e-15)


@pytest.mark.parametrize("time", [0.3, 0.999, 1.7, 2.4, 5.0])
def test_the_velocity_gradient_is_the_rate_of_f_times_its_inverse(table, time):
    history, h = table(TURNED), 1e-5
    F = history.deformation_gradient
    slope = (F(time + h) - F(time - h)) / (2.0 * h)
    np.testing.assert_allclose(history.velocity_gradient(time), slope @ np.linalg.inv(F(time)), atol=1e-8)


def test_rotation_about_any_axis_is_a_rotation_that_leaves_the_axis():
    axis = np.array([1.0, -2.0, 2.0]) / 3.0
    R = rotation_about(axis, 0.7)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(R @ axis, axis, atol=1e-15)
    assert np.trace(R) == pytest.approx(1.0 + 2.0 * math.cos(0.7))
    assert np.linalg.det(R) == pytest.approx(1.0)


def nodes_and_fields():
    grid = Grid(
        (-0.5, 0.0, 0.0), (0.5, 0.5, 0.5), (2, 2, 2), (1, 1, 1), (0, 0, 0), (Patch(0, (0, 0, 0), (2, 2, 2)),)
    )
    nodal = new_nodal_fields(grid, 2)
    nodal.acceleration[:] = 5.0
    return grid.node_positions(), nodal


def gradient_of(nodes, velocity):
    """The matrix L of a velocity field v = L x, by least squares, and whether the field is one."""
    L, *_ = np.linalg.lstsq(nodes, velocity, rcond=None)
    np.testing.assert_allclose(nodes @ L, velocity, atol=1e-12)
    return L.T


@pytest.mark.parametrize(("time", "dt"), [(0.0, 1.0), (1.0, 2.0), (0.2, 0.3), (0.9, 0.4)])
def test_an_exact_step_brings_f_to_the_table(table, time, dt):
    # F <- (I + dt L) F is the step's own update of deformation gradients.
    history = table(TURNED, exact=True)
    nodes, nodal = nodes_and_fields()
    history.impose(nodal, nodes, time, dt)
    for velocity in nodal.velocity_star:
        L = gradient_of(nodes, velocity)
        F = (np.eye(3) + dt * L) @ history.deformation_gradient(time)
        np.testing.assert_allclose(F, history.deformation_gradient(time + dt), atol=1e-12)
    np.testing.assert_array_equal(nodal.acceleration, 0.0)


def test_an_exact_step_without_turns_is_uintahs(table):
    # v = (F_next F_now^-1 - I) x / dt with F at the rows.
    history = table(
        f"0 {IDENTITY} 0 0 0 1\n0.5 {STRETCHED} 0 0 0 1\n1 2 0 0 0 1 0 0 0 1 0 0 0 1\n", exact=True
    )
    nodes, nodal = nodes_and_fields()
    history.impose(nodal, nodes, 0.5, 0.5)
    expected = (np.diag([2.0, 1.0, 1.0]) @ np.linalg.inv(matrix(STRETCHED)) - np.eye(3)) / 0.5
    np.testing.assert_allclose(gradient_of(nodes, nodal.velocity_star[0]), expected, atol=1e-12)


def test_an_ordinary_step_holds_the_velocity_gradient_of_its_start(table):
    history = table(TURNED)
    nodes, nodal = nodes_and_fields()
    history.impose(nodal, nodes, 0.4, 0.1)
    L = gradient_of(nodes, nodal.velocity_star[1])
    np.testing.assert_allclose(L, history.velocity_gradient(0.4), atol=1e-12)


def test_steps_end_on_the_rows(table):
    history = table(TURNED, exact=True)
    assert history.time_step(0.0) == 1.0
    assert history.time_step(1.0) == 2.0
    assert history.time_step(0.25) == 0.75
    assert history.time_step(1.0 - 1e-12) == pytest.approx(2.0)
    assert history.time_step(3.0) == math.inf


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (f"0 {IDENTITY} 0 0 0 1\n1 {IDENTITY} 0 0 0\n", r":2: expected 14 numbers"),
        (f"0 {IDENTITY} 0 0 0 1\n\n1 {IDENTITY} zero 0 0 1\n", r":3: expected 14 numbers"),
        (f"1 {IDENTITY} 0 0 0 1\n\n1 {IDENTITY} 0 0 0 1\n", r":3: the times of the rows must increase"),
        (
            f"0 {IDENTITY} 0 0 0 1\n1 -1 0 0 0 1 0 0 0 1 0 0 0 1\n",
            r":2: the determinant of F must be positive",
        ),
        (f"0 {IDENTITY} 0 0 0 1\n1 {IDENTITY} 5 0 0 0\n", r":2: a turn needs an axis"),
        (f"0 {IDENTITY} 0 0 0 1\n", r": .* at least two rows"),
        ("", r": no line of 14 numbers"),
    ],
)
def test_wrong_files_are_named_with_their_line(table, text, words):
    with pytest.raises(ValueError, match="time_defgrad_rotation" + words):
        table(text)
