"""The averaged hat function against quadrature, along a line and around an axis."""

from __future__ import annotations

import numpy as np
import pytest
import reference
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from shape_cases import GRID, PLANE, SIZES, Rows, sample_deformations, sample_positions

from solver.interpolation.gimp import Gimp, GimpAxisymmetric, averaged_hat
from solver.lanes import every


def one_direction(f, half):
    """Nodes counted from the lower one of the cell, weights and slopes of the averaged hat."""
    s = averaged_hat(every(f), every(half))
    weights, slopes = ([lanes[0] for lanes in part] for part in ((s.w0, s.w1, s.w2), (s.g0, s.g1, s.g2)))
    return np.arange(3) - s.below[0], np.array(weights), np.array(slopes)


@given(st.floats(0.0, 1.0, exclude_max=True), st.floats(0.01, 0.5))
def test_averaged_hat_is_the_mean_of_the_hat_function(f, half):
    for node, weight, slope in zip(*one_direction(f, half), strict=True):
        low, high = f - half - node, f + half - node
        kinks = [k for k in (-1.0, 0.0, 1.0) if low < k < high]
        mean = quad(reference.hat, low, high, points=kinks or None)[0] / (2 * half)
        assert weight == pytest.approx(mean, abs=1e-12)
        rise = (reference.hat(high) - reference.hat(low)) / (2 * half)
        assert slope == pytest.approx(rise, abs=1e-12)


@given(st.floats(0.0, 1.0, exclude_max=True), st.floats(0.01, 0.5))
def test_one_direction_reproduces_lines(f, half):
    nodes, weights, slopes = one_direction(f, half)
    assert weights.min() >= 0.0
    np.testing.assert_allclose(
        [weights.sum(), weights @ nodes, slopes.sum(), slopes @ nodes], [1, f, 0, 1], atol=1e-11
    )


@pytest.mark.parametrize(("f", "count"), [(0.2, 27), (0.25, 8), (0.5, 8), (0.75, 8), (0.8, 27)])
def test_nodes_of_no_weight_are_left_out(f, count):
    position = np.array(GRID.anchor) + (2.0 + f) * np.array(GRID.spacing)
    assert Rows(Gimp(), GRID, position, 0.5 * np.eye(3)).counts[0] == count


def test_domains_do_not_deform():
    positions = sample_positions(GRID, margin=1.5)
    deformed = Rows(Gimp(), GRID, positions, SIZES, sample_deformations()).dense()
    resting = Rows(Gimp(), GRID, positions, SIZES).dense()
    np.testing.assert_array_equal(deformed[0], resting[0])
    np.testing.assert_array_equal(deformed[1], resting[1])


def rings(size, count=150):
    """Positions from near the axis outwards that meet the cells of the plane everywhere."""
    random = np.random.default_rng(8)
    r = np.linspace(0.005, 2.9, count)
    positions = np.stack([r, random.uniform(-0.7, 0.2, count), np.full(count, 0.5)], axis=1)
    return positions, np.broadcast_to(np.diag(size), (count, 3, 3))


def test_rings_two_to_a_cell_are_averaged_over_their_volume():
    positions, size = rings((0.5, 0.5, 1.0))
    S, G = reference.gimp_axisymmetric(PLANE, positions, size)
    got_S, got_G = Rows(GimpAxisymmetric(), PLANE, positions, size, compiled=True).dense()
    np.testing.assert_allclose(got_S, S, atol=1e-13)
    np.testing.assert_allclose(got_G, G, atol=1e-11, rtol=1e-11)


@pytest.mark.parametrize("width", [1.0, 0.5, 1.0 / 3.0, 0.25])
def test_rings_of_any_width_keep_the_sums(width):
    """Uintah's branches fit two particles a cell; with others the sums stay right, single weights do not."""
    positions, size = rings((width, 0.5, 1.0))
    S, G = Rows(GimpAxisymmetric(), PLANE, positions, size).dense()
    np.testing.assert_allclose(S.sum(axis=1), 1.0, rtol=1e-13)
    np.testing.assert_allclose(G[..., :2].sum(axis=1), 0.0, atol=1e-12)
    whole = positions[:, 0] >= 0.5 * width * PLANE.spacing[0]
    np.testing.assert_allclose(G[whole, :, 2].sum(axis=1), 1.0 / positions[whole, 0], rtol=1e-12)


def test_hoop_strain_of_uniform_expansion_is_uniform():
    """With v = r the rates v_r' and v_r / r are both one, also in rings that the axis cuts."""
    positions, size = rings((0.5, 0.5, 1.0))
    _, G = Rows(GimpAxisymmetric(), PLANE, positions, size).dense()
    velocity = PLANE.node_positions()[:, 0]
    np.testing.assert_allclose(G[..., 0] @ velocity, 1.0, rtol=1e-12)
    uncut = positions[:, 0] > 0.5  # nodes beyond the axis, at negative radius, take part before
    np.testing.assert_allclose(G[uncut, :, 2] @ velocity, 1.0, rtol=1e-12)
    near = positions[:, 0] < 0.25 * PLANE.spacing[0]
    np.testing.assert_allclose(G[near, :, 2] @ velocity, 1.0, rtol=1e-12)
