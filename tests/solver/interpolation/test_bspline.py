"""Quadratic splines: smooth where linear functions have kinks, and exact for parabolas."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline as SplineOfScipy
from shape_cases import GRID, SIZES, Rows, sample_positions

from solver.interpolation.bspline import BSpline


@pytest.mark.parametrize("f", [0.0, 0.5])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_weights_and_gradients_are_continuous_across_cells_and_their_middles(f, axis):
    cells = np.array([2.3, 3.2, 2.6])
    cells[axis] = 2.0 + f
    shift = 1e-10 * np.eye(3)[axis]
    positions = np.array(GRID.anchor) + np.array([cells - shift, cells + shift]) * np.array(GRID.spacing)
    S, G = Rows(BSpline(), GRID, positions, SIZES).dense()
    np.testing.assert_allclose(S[0], S[1], atol=1e-9)
    np.testing.assert_allclose(G[0], G[1], atol=1e-8)


def test_agrees_with_the_spline_of_scipy():
    basis = SplineOfScipy.basis_element([-1.5, -0.5, 0.5, 1.5], extrapolate=False)
    positions = sample_positions(GRID, margin=1.5)
    S, _ = Rows(BSpline(), GRID, positions, SIZES).dense()
    q = (positions[:, None, :] - GRID.node_positions()[None]) / np.array(GRID.spacing)
    np.testing.assert_allclose(S, np.nan_to_num(basis(q)).prod(axis=2), atol=1e-14)


def test_square_of_the_position_comes_out_a_quarter_cell_too_large():
    """The spline of nodal values x^2 is x^2 + h^2 / 4 everywhere: curvature is reproduced, and exactly."""
    positions = sample_positions(GRID, margin=1.5)
    S, G = Rows(BSpline(), GRID, positions, SIZES).dense()
    squares = GRID.node_positions() ** 2
    np.testing.assert_allclose(S @ squares, positions**2 + np.array(GRID.spacing) ** 2 / 4, atol=1e-12)
    np.testing.assert_allclose(np.einsum("ni,pni->pi", squares, G), 2 * positions, atol=1e-11)


def test_particle_size_does_not_matter():
    positions = sample_positions(GRID, margin=1.5)
    small, large = (Rows(BSpline(), GRID, positions, s * np.eye(3)).dense() for s in (0.1, 1.0))
    np.testing.assert_array_equal(small[0], large[0])
    np.testing.assert_array_equal(small[1], large[1])
