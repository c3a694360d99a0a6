"""Spectral decomposition against numpy's, with repeated values."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.jit import kernel
from solver.lanes import WIDTH, Eight
from solver.spectral import compose, spectrum
from solver.tensor import Tensor, put_tensor, tensor_at


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


@kernel
def spectra_of_eight(tensors, values, axes):
    for start in range(0, tensors.shape[0], WIDTH):
        p = Eight(start)
        found = spectrum(tensor_at(tensors, p))
        values[p, 0], values[p, 1], values[p, 2] = found.first, found.second, found.third
        put_tensor(axes, p, found.axes)


def test_eight_tensors_at_once():
    """Each keeps the frame that it has alone, however many turns the others take."""
    rng = np.random.default_rng(4)
    tensors = rng.normal(size=(400, 3, 3)) * 10.0 ** rng.uniform(-9.0, 9.0, (400, 1, 1))
    tensors += tensors.transpose(0, 2, 1)
    tensors[::3] *= np.eye(3)
    tensors[1::7] = np.eye(3)
    tensors[2::7] = 0.0
    values, axes = np.empty((400, 3)), np.empty((400, 3, 3))
    spectra_of_eight(tensors, values, axes)
    size = np.maximum(np.abs(tensors).max(axis=(1, 2)), 1e-300)[:, None]
    np.testing.assert_allclose(values / size, np.linalg.eigvalsh(tensors)[:, ::-1] / size, atol=1e-14)
    np.testing.assert_allclose(np.linalg.det(axes), 1.0, rtol=1e-14)
    composed = (axes * values[:, None, :]) @ axes.transpose(0, 2, 1)
    np.testing.assert_allclose(composed / size[..., None], tensors / size[..., None], atol=1e-14)
    for p in range(0, 400, 11):
        alone, frame = np.empty((WIDTH, 3)), np.empty((WIDTH, 3, 3))
        spectra_of_eight(np.broadcast_to(tensors[p], (WIDTH, 3, 3)).copy(), alone, frame)
        np.testing.assert_array_equal(alone, np.broadcast_to(values[p], (WIDTH, 3)))
        np.testing.assert_array_equal(frame, np.broadcast_to(axes[p], (WIDTH, 3, 3)))
