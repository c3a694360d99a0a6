"""Linear shape functions around an axis; those in space are compared in test_shape_functions."""

from __future__ import annotations

import numpy as np
import reference
from shape_cases import GRID, PLANE, SIZES, Rows, on_faces, sample_positions

from solver.interpolation.linear import Linear, LinearAxisymmetric


def ring_positions():
    positions = sample_positions(PLANE, seed=4)
    positions[:, 2] = 0.5
    return positions


def test_a_particle_on_a_node_belongs_to_that_node_alone():
    positions = on_faces(GRID)[:1]
    S, G = Rows(Linear(), GRID, positions, SIZES).dense()
    node = GRID.flat(2, 2, 2)
    assert S[0, node] == 1.0
    assert S[0].sum() == 1.0
    np.testing.assert_allclose(
        G[0, node], -1.0 / np.array(GRID.spacing)
    )  # of the cell above, as floor chooses


def test_rings_agree_with_the_equations():
    positions = ring_positions()
    S, G = reference.linear_axisymmetric(PLANE, positions)
    got_S, got_G = Rows(LinearAxisymmetric(), PLANE, positions, np.eye(3), compiled=True).dense()
    np.testing.assert_allclose(got_S, S, atol=1e-14)
    np.testing.assert_allclose(got_G, G, rtol=1e-11, atol=1e-12)


def test_rings_keep_the_sums_and_reproduce_lines():
    positions = ring_positions()
    S, G = Rows(LinearAxisymmetric(), PLANE, positions, np.eye(3)).dense()
    nodes = PLANE.node_positions()
    np.testing.assert_allclose(S.sum(axis=1), 1.0)
    np.testing.assert_allclose(S @ nodes, positions, atol=1e-13)
    np.testing.assert_allclose(G[..., :2].sum(axis=1), 0.0, atol=1e-12)
    np.testing.assert_allclose(G[..., 2].sum(axis=1), 1.0 / positions[:, 0])
    np.testing.assert_allclose(
        np.einsum("ni,pnj->pij", nodes[:, :2], G[..., :2]), np.tile(np.eye(2), (25, 1, 1)), atol=1e-12
    )


def test_uniform_expansion_has_the_same_hoop_strain_up_to_the_axis():
    positions = np.array([[1e-12, -0.5, 0.5], [1e-3, -0.5, 0.5], [0.7, -0.5, 0.5]])
    _, G = Rows(LinearAxisymmetric(), PLANE, positions, np.eye(3)).dense()
    velocity = 3.0 * PLANE.node_positions()[:, 0]
    np.testing.assert_allclose(G[..., 2] @ velocity, 3.0)
    np.testing.assert_allclose(G[..., 0] @ velocity, 3.0)
