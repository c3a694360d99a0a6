from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from solver.tensor import Tensor, rotation


def rotation_of(F):
    R = rotation(Tensor(*np.ravel(F)))
    return np.array([[R.xx, R.xy, R.xz], [R.yx, R.yy, R.yz], [R.zx, R.zy, R.zz]])


@given(arrays(float, (3, 3), elements=st.floats(-0.5, 0.5)))
def test_it_is_the_rotation_of_the_polar_decomposition(gradient):
    F = np.eye(3) + gradient
    if np.linalg.det(F) < 0.05:
        return
    left, _, right = np.linalg.svd(F)
    np.testing.assert_allclose(rotation_of(F), left @ right, atol=2e-8)


def test_a_pure_stretch_does_not_turn():
    np.testing.assert_allclose(rotation_of(np.diag([0.4, 1.0, 2.5])), np.eye(3), atol=1e-8)


def test_a_rotation_is_its_own():
    angle = 1.2
    Q = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    assert rotation_of(3.0 * Q) == pytest.approx(Q, abs=1e-15)
