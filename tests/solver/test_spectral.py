"""Spectral decomposition against numpy's, with repeated values."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.spectral import compose, spectrum
from solver.tensor import Tensor


def as_array(a):
    return np.array([[a.xx, a.xy, a.xz], [a.yx, a.yy, a.yz], [a.zx, a.zy, a.zz]])


def check(a):
    found = spectrum(Tensor(*a.ravel().tolist()))
    values = np.array([found.first, found.second, found.third])
    size = max(np.abs(a).max(), 1e-300)
    np.testing.assert_allclose(values / size, np.linalg.eigvalsh(a)[::-1] / size, atol=1e-14)
    axes = as_array(found.axes)
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-14)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    np.testing.assert_allclose(as_array(compose(*found)) / size, a / size, atol=1e-14)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(-1e9, 1e9), min_size=6, max_size=6))
def test_any_symmetric_tensor(parts):
    xx, yy, zz, xy, xz, yz = parts
    check(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))


@pytest.mark.parametrize(
    "values", [(0, 0, 0), (2, 2, 2), (3, 1, 1), (3, 3, 1), (-1, 5, 2), (1, 1 + 1e-12, -1)]
)
def test_repeated_values_in_a_turned_frame(values):
    Q = np.linalg.qr(np.array([[1.0, 2, 3], [0.3, -1, 1], [2, 0.1, -1]]))[0]
    check(np.diag(np.array(values, float)))
    a = Q @ np.diag(values) @ Q.T
    check((a + a.T) / 2)
