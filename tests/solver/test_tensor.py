"""Tensor algebra against NumPy and SciPy, as plain Python and inside a compiled kernel."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.linalg import polar
from scipy.spatial.transform import Rotation

from solver.jit import kernel
from solver.lanes import Eight
from solver.tensor import (
    Tensor,
    cofactor,
    determinant,
    deviator,
    double_dot,
    inverse,
    isotropic,
    norm,
    principal_values,
    put_tensor,
    rotation,
    symmetric,
    tensor_at,
    trace,
)

numbers = st.floats(-1.0e3, 1.0e3)
matrices = arrays(np.float64, (3, 3), elements=numbers)
angles = st.tuples(*[st.floats(-3.0, 3.0)] * 3)


def tensor(matrix):
    return Tensor(*np.asarray(matrix, dtype=float).ravel().tolist())


def array(a):
    return np.array([[a.xx, a.xy, a.xz], [a.yx, a.yy, a.yz], [a.zx, a.zy, a.zz]])


def turned(values, vector):
    """The symmetric matrix with the given principal values in a rotated frame."""
    Q = Rotation.from_rotvec(vector).as_matrix()
    return Q @ np.diag(values) @ Q.T


RESULTS = 13


@kernel
def algebra(pairs, s, results):
    """Every operation on each pair (n, 2, 3, 3) of tensors; numbers come back times the identity."""
    for p in range(pairs.shape[0]):
        a, b = tensor_at(pairs[p], 0), tensor_at(pairs[p], 1)
        put_tensor(results[p], 0, a + b)
        put_tensor(results[p], 1, a - b)
        put_tensor(results[p], 2, -a)
        put_tensor(results[p], 3, s * a + b * s)
        put_tensor(results[p], 4, a / s)
        put_tensor(results[p], 5, a @ b)
        put_tensor(results[p], 6, a.T)
        put_tensor(results[p], 7, deviator(a))
        put_tensor(results[p], 8, symmetric(a))
        put_tensor(results[p], 9, cofactor(a))
        put_tensor(results[p], 10, isotropic(trace(a)))
        put_tensor(results[p], 11, isotropic(double_dot(a, b)))
        put_tensor(results[p], 12, isotropic(determinant(a)))


def expected_algebra(a, b, s):
    eye = np.eye(3)
    rows = [np.roll(a, -1, axis=0), np.roll(a, -2, axis=0)]
    return [
        a + b,
        a - b,
        -a,
        s * a + s * b,
        a / s,
        a @ b,
        a.T,
        a - np.trace(a) / 3 * eye,
        (a + a.T) / 2,
        np.cross(rows[0], rows[1]),  # each row the cross product of the two that follow it
        np.trace(a) * eye,
        np.sum(a * b) * eye,
        np.linalg.det(a) * eye,
    ]


def assert_algebra(pairs, s, results):
    for (a, b), result in zip(pairs, results, strict=True):
        size = 1.0 + abs(a).max() + abs(b).max()
        for got, expected in zip(result, expected_algebra(a, b, s), strict=True):
            np.testing.assert_allclose(got, expected, rtol=1e-12, atol=1e-13 * size**3)


@given(matrices, matrices, st.floats(0.1, 10.0))
def test_operators_agree_with_numpy(a, b, s):
    results = np.empty((1, RESULTS, 3, 3))
    algebra.py_func(np.array([[a, b]]), s, results)
    assert_algebra([(a, b)], s, results)


def test_operators_agree_with_numpy_in_a_kernel():
    pairs = np.random.default_rng(1).normal(size=(20, 2, 3, 3)) * 10.0
    results = np.empty((20, RESULTS, 3, 3))
    algebra(pairs, 1.7, results)
    assert_algebra(pairs, 1.7, results)


def test_tensor_shows_its_components():
    assert repr(tensor(np.arange(9.0).reshape(3, 3))) == (
        "Tensor([[0.0, 1.0, 2.0], [3.0, 4.0, 5.0], [6.0, 7.0, 8.0]])"
    )


@kernel
def decompositions(tensors, results, values):
    """Inverse, rotation, and principal values of the symmetric part, of each tensor."""
    for p in range(tensors.shape[0]):
        a = tensor_at(tensors, p)
        put_tensor(results[p], 0, inverse(a))
        put_tensor(results[p], 1, rotation(a))
        v = principal_values(symmetric(a))
        values[p, 0], values[p, 1], values[p, 2] = v.first, v.second, v.third
        values[p, 3] = norm(a)


def stretched(stretch, vector):
    """A deformation gradient with det F > 0: principal stretches and then a rotation."""
    return Rotation.from_rotvec(vector).as_matrix() @ turned(stretch, np.array([0.3, -0.5, 0.8]))


ITERATION = 2e-8
"""The iteration for R ends where the square of its error no longer counts beside one: half the digits."""


def sample_deformations():
    random = np.random.default_rng(2)
    return np.array(
        [stretched(np.exp(random.uniform(-2, 2, 3)), random.uniform(-3, 3, 3)) for _ in range(30)]
        + [np.eye(3), 1e-3 * np.eye(3), stretched([50.0, 1.0, 0.02], (0, 0, 3.1))]
    )


@pytest.mark.parametrize("run", [decompositions, decompositions.py_func], ids=["kernel", "python"])
def test_decompositions_agree_with_numpy_and_scipy(run):
    F = sample_deformations()
    results, values = np.empty((len(F), 2, 3, 3)), np.empty((len(F), 4))
    run(F, results, values)
    np.testing.assert_allclose(results[:, 0], np.linalg.inv(F), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(results[:, 1], [polar(f)[0] for f in F], atol=ITERATION)
    eigenvalues = np.linalg.eigvalsh((F + F.transpose(0, 2, 1)) / 2)[:, ::-1]
    size = np.linalg.norm(F, axis=(1, 2))[:, None]
    np.testing.assert_allclose(values[:, :3] / size, eigenvalues / size, atol=3e-15)
    np.testing.assert_allclose(values[:, 3:], size, rtol=1e-14)


@given(st.tuples(*[st.floats(0.05, 20.0)] * 3), angles)
def test_rotation_is_that_of_the_polar_decomposition(stretch, vector):
    F = stretched(stretch, vector)
    R = array(rotation(tensor(F)))
    np.testing.assert_allclose(R, polar(F)[0], atol=ITERATION)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=3 * ITERATION)
    U = R.T @ F
    np.testing.assert_allclose(U, U.T, atol=3 * ITERATION * max(stretch))


@given(st.tuples(*[st.floats(-1.0, 1.0)] * 3), angles, st.sampled_from([1e-6, 1.0, 1e12]))
def test_principal_values_are_the_eigenvalues(values, vector, unit):
    s = unit * turned(values, vector)
    found = np.array(principal_values(tensor((s + s.T) / 2)))
    assert found[0] >= found[1] - 1e-15 * unit >= found[2] - 2e-15 * unit
    np.testing.assert_allclose(found, np.linalg.eigvalsh(s)[::-1], atol=5e-15 * unit)


@kernel
def values_of_eight(tensors, values):
    for start in range(0, tensors.shape[0], 8):
        p = Eight(start)
        v = principal_values(tensor_at(tensors, p))
        values[p, 0], values[p, 1], values[p, 2] = v.first, v.second, v.third


@kernel
def values_of_one(tensors, values):
    for p in range(tensors.shape[0]):
        v = principal_values(tensor_at(tensors, p))
        values[p, 0], values[p, 1], values[p, 2] = v.first, v.second, v.third


@pytest.mark.parametrize("run", [values_of_eight, values_of_one], ids=["eight", "one"])
def test_principal_values_keep_their_digits_where_they_meet(run):
    random = np.random.default_rng(8)
    values = np.sort(random.uniform(-1.0, 1.0, (4000, 3)))
    values[:800, 1] = values[:800, 0]
    values[800:1600, 1] = values[800:1600, 2]
    values[1600:2400, 1] = values[1600:2400, 0] * (1.0 + 10.0 ** random.uniform(-16.0, -1.0, 800))
    values[2400:2408] = values[2400:2408, :1]
    values[2408] = 0.0
    tensors = np.array([turned(v, random.uniform(-3.0, 3.0, 3)) for v in values])
    tensors[::5] = values[::5, :, None] * np.eye(3)
    tensors = 0.5 * (tensors + tensors.transpose(0, 2, 1))
    found = np.empty((4000, 3))
    run(tensors, found)
    np.testing.assert_allclose(found, np.linalg.eigvalsh(tensors)[:, ::-1], rtol=0.0, atol=4e-15)


@pytest.mark.parametrize(
    "values",
    [
        (0.0, 0.0, 0.0),
        (7.0, 7.0, 7.0),
        (2.0, 2.0, -1.0),
        (2.0, -1.0, -1.0),
        (1.0, 0.0, 0.0),
        (0.0, 0.0, -4.0),
    ],
)
@pytest.mark.parametrize("vector", [(0.0, 0.0, 0.0), (0.4, -1.0, 0.7)])
def test_repeated_principal_values(values, vector):
    found = principal_values(tensor(turned(values, vector)))
    np.testing.assert_allclose(found, values, atol=8e-15)


@pytest.mark.parametrize("size", [1e-200, 1e-120, 1e-60, 1e60, 1e90])
def test_principal_values_of_tiny_and_huge_tensors_are_as_large_as_the_tensor(size):
    values = np.array([3.0, 1.0, -2.0]) * size
    found = principal_values(tensor(turned(values, (0.2, 1.1, -0.4))))
    np.testing.assert_allclose(np.array(found) / size, values / size, atol=4.0)
