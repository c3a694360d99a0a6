"""Deforming parallelepipeds: where they equal gimp, how they deform, how long domains are cut."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from shape_cases import GRID, PLANE, SIZES, Rows, sample_deformations, sample_positions

from solver.interpolation.cpdi import Cpdi, CpdiAxisymmetric
from solver.interpolation.gimp import Gimp
from solver.interpolation.shape import particle_domain
from solver.tensor import Tensor


def domain(interpolator, F, size):
    r = particle_domain(interpolator, Tensor(*np.ravel(F).tolist()), Tensor(*np.ravel(size).tolist()))
    return np.array([[r.xx, r.xy, r.xz], [r.yx, r.yy, r.yz], [r.zx, r.zy, r.zz]])


def test_undeformed_box_inside_a_cell_equals_gimp():
    """The mean over corners is that over the box as long as the hat functions are straight over it."""
    random = np.random.default_rng(3)
    inside = random.uniform(0.26, 0.74, (20, 3)) + random.integers(1, 4, (20, 3))
    positions = np.array(GRID.anchor) + inside * np.array(GRID.spacing)
    boxes, corners = (Rows(i, GRID, positions, 0.5 * np.eye(3)).dense() for i in (Gimp(), Cpdi()))
    np.testing.assert_allclose(corners[0], boxes[0], atol=1e-14)
    np.testing.assert_allclose(corners[1], boxes[1], atol=1e-13)


def test_box_across_a_face_has_the_gradient_of_gimp_across_it_but_not_its_weight():
    """Both gradients are the difference of S between the two ends; the weight of cpdi is a two-point rule."""
    positions = np.array(GRID.anchor) + np.array([[2.1, 2.5, 2.5]]) * np.array(GRID.spacing)
    boxes, corners = (Rows(i, GRID, positions, 0.5 * np.eye(3)).dense() for i in (Gimp(), Cpdi()))
    np.testing.assert_allclose(corners[1][..., 0], boxes[1][..., 0], atol=1e-13)
    node = GRID.flat(2, 2, 2)
    assert corners[0][0, node] == pytest.approx(0.25 * 0.75)  # ends at 1.85 and 2.35
    # integral of 1 - |q| over [-.15, .35] over its length
    assert boxes[0][0, node] == pytest.approx(0.25 * (1.0 - (0.15**2 + 0.35**2) / 2 / 0.5))


def test_a_rotation_of_a_quarter_turn_swaps_the_sides_of_the_box():
    quarter = Rotation.from_euler("z", 90, degrees=True).as_matrix()
    positions = sample_positions(GRID, margin=1.5)
    turned = Rows(Cpdi(), GRID, positions, np.diag([0.5, 0.25, 1.0]), quarter).dense()
    swapped = Rows(Cpdi(), GRID, positions, np.diag([0.25, 0.5, 1.0])).dense()
    np.testing.assert_allclose(turned[0], swapped[0], atol=1e-13)
    np.testing.assert_allclose(turned[1], swapped[1], atol=1e-12)


def test_domain_follows_the_deformation_gradient():
    for F in sample_deformations(5):
        np.testing.assert_allclose(domain(Cpdi(), F, SIZES), F @ SIZES, atol=1e-15)
        np.testing.assert_allclose(domain(CpdiAxisymmetric(), F, SIZES), F @ SIZES, atol=1e-15)


def test_long_half_diagonals_are_cut_to_the_critical_length():
    r = domain(Cpdi(0.4), np.diag([3.0, 1.0, 1.0]), 0.5 * np.eye(3))
    signs = np.array([[1, 1, 1, 1], [1, 1, -1, -1], [1, -1, 1, -1]])
    np.testing.assert_allclose(np.linalg.norm(0.5 * r @ signs, axis=0), 0.4)
    assert r[0, 0] / r[1, 1] == pytest.approx(3.0)


def test_a_box_with_some_long_half_diagonals_is_fitted_to_the_cut_ones():
    """Four half diagonals over-determine three edges, which are their least-squares fit."""
    F = np.array([[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    signs = np.array([[1, 1, -1, -1], [1, -1, 1, -1], [1, 1, 1, 1]])
    diagonals = 0.5 * F @ signs
    lengths = np.linalg.norm(diagonals, axis=0)
    assert (lengths > 1.0).any()
    assert (lengths < 1.0).any()
    cut = diagonals * np.minimum(1.0, 1.0 / lengths)
    fitted = np.linalg.lstsq(0.5 * signs.T, cut.T, rcond=None)[0].T
    np.testing.assert_allclose(domain(Cpdi(1.0), F, np.eye(3)), fitted, atol=1e-14)


def test_sums_hold_for_cut_domains_and_for_corners_beyond_the_grid():
    positions = np.concatenate(
        [sample_positions(GRID, 10, margin=1.5), sample_positions(GRID, 10, margin=0.1)]
    )
    stretch = np.diag([6.0, 1.0, 0.5])
    for interpolator in (Cpdi(0.5), Cpdi()):
        S, G = Rows(interpolator, GRID, positions, SIZES, stretch).dense()
        np.testing.assert_allclose(S.sum(axis=1), 1.0)
        np.testing.assert_allclose(G.sum(axis=1), 0.0, atol=1e-12)


def rings(count=30):
    positions = sample_positions(PLANE, count, seed=5, margin=0.4)
    positions[:, 2] = 0.5
    F = np.zeros((count, 3, 3))
    F[:, :2, :2] = sample_deformations(count, seed=6)[:, :2, :2]
    F[:, 2, 2] = np.linspace(0.7, 1.4, count)
    return positions, F


def test_rings_keep_the_sums_and_the_hoop_column():
    positions, F = rings()
    S, G = Rows(CpdiAxisymmetric(), PLANE, positions, np.diag([0.5, 0.5, 1.0]), F, compiled=True).dense()
    np.testing.assert_allclose(S.sum(axis=1), 1.0)
    np.testing.assert_allclose(G[..., :2].sum(axis=1), 0.0, atol=1e-12)
    np.testing.assert_allclose(G[..., 2], S / positions[:, :1], rtol=1e-13)
    np.testing.assert_allclose(S @ PLANE.node_positions(), positions, atol=1e-13)


def test_gradients_of_rings_lack_the_hoop_stretch():
    """As documented: the section's area holds the hoop stretch, so gradients are 1/F33 of the true ones."""
    positions, F = rings()
    _, G = Rows(CpdiAxisymmetric(), PLANE, positions, np.diag([0.5, 0.5, 1.0]), F).dense()
    gradient = np.einsum("ni,pnj->pij", PLANE.node_positions()[:, :2], G[..., :2])
    np.testing.assert_allclose(
        gradient * F[:, 2, 2][:, None, None], np.tile(np.eye(2), (30, 1, 1)), atol=1e-12
    )
