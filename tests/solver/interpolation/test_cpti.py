"""Tetrahedral domains."""

from __future__ import annotations

import numpy as np
import pytest
from shape_cases import GRID, Rows, sample_deformations, sample_positions

from solver.interpolation.cpti import Cpti
from solver.interpolation.shape import particle_domain
from solver.tensor import Tensor

EDGES = np.array([[0.5, 0.1, 0.0], [0.0, 0.4, 0.1], [0.05, 0.0, 0.6]])
"""Columns are the edges from one corner, in cells."""


def corners(position, F=None):
    """The corners of the tetrahedron whose centroid is the particle."""
    edges = (np.eye(3) if F is None else F) @ EDGES * np.array(GRID.spacing)[:, None]
    first = position - edges.sum(axis=1) / 4
    return np.array([first, *(first + edges.T)])


def test_fields_take_the_mean_of_their_values_at_the_corners():
    F = sample_deformations(10, seed=2)
    positions = sample_positions(GRID, 10, margin=1.5)
    S, _ = Rows(Cpti(), GRID, positions, EDGES, F).dense()
    x, y, z = GRID.node_positions().T
    field = 2.0 * x * y * z - x * y + 3.0 * z * x  # linear along each direction, so the grid holds it exactly
    for p, position in enumerate(positions):
        cx, cy, cz = corners(position, F[p]).T
        assert S[p] @ field == pytest.approx((2 * cx * cy * cz - cx * cy + 3 * cz * cx).mean())


def test_gradient_is_that_of_the_linear_function_through_the_corners():
    positions = sample_positions(GRID, 10, margin=1.5)
    _, G = Rows(Cpti(), GRID, positions, EDGES).dense()
    x, y, z = GRID.node_positions().T
    field = x * y + z * z  # any nodal field: the corners see what the grid makes of it
    for p, position in enumerate(positions):
        points = corners(position)
        at_corners = Rows(Cpti(), GRID, points, 1e-9 * np.eye(3)).dense()[0] @ field
        coefficients = np.linalg.solve(np.column_stack([np.ones(4), points]), at_corners)
        np.testing.assert_allclose(field @ G[p], coefficients[1:], atol=1e-7)


def test_corners_are_drawn_in_to_the_critical_length():
    r = particle_domain(
        Cpti(0.2), Tensor(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), Tensor(*EDGES.ravel())
    )
    edges = np.array([[r.xx, r.xy, r.xz], [r.yx, r.yy, r.yz], [r.zx, r.zy, r.zz]])
    first = -EDGES.sum(axis=1) / 4
    whole = np.array([first, *(first + EDGES.T)])
    cut = whole * np.minimum(1.0, 0.2 / np.linalg.norm(whole, axis=1))[:, None]
    np.testing.assert_allclose(edges, (cut[1:] - cut[0]).T, atol=1e-15)
