"""Elementary functions of eight numbers, against NumPy's and those of ``math``."""

from __future__ import annotations

import math

import numpy as np
import pytest

from solver import elementary
from solver.jit import kernel
from solver.lanes import Eight, Lanes

LAST_DIGITS = 4.0e-16
"""Relative: two units of the last place."""


@kernel
def compute(x, exponents, exponentials, logarithms, powers):
    for start in range(0, x.shape[0], 8):
        p = Eight(start)
        exponentials[p] = math.exp(exponents[p])
        logarithms[p] = math.log(x[p])
        powers[p] = x[p] ** 0.31


@pytest.fixture
def numbers():
    rng = np.random.default_rng(1)
    near_one = 1.0 + rng.uniform(-1.0e-3, 1.0e-3, 800)
    return np.concatenate([np.exp(rng.uniform(-700.0, 700.0, 8000)), near_one, rng.uniform(0.5, 2.0, 8000)])


def test_they_agree_with_numpy_to_the_last_digits(numbers):
    exponents = np.random.default_rng(2).uniform(-707.0, 708.0, numbers.size)
    exponents[: numbers.size // 2] /= 700.0
    results = np.zeros((3, numbers.size))
    compute(numbers, exponents, *results)
    np.testing.assert_allclose(results[0], np.exp(exponents), rtol=LAST_DIGITS)
    np.testing.assert_allclose(results[1], np.log(numbers), rtol=LAST_DIGITS)
    # the error of the logarithm, times the power of e
    powers = numbers**0.31
    allowed = LAST_DIGITS * (1.0 + np.abs(np.log(powers)))
    assert (np.abs(results[2] / powers - 1.0) < allowed).all()


def test_in_python_they_are_the_same():
    x = np.array([0.1, 0.9999, 1.0, 1.5, 2.0, 3.0, 1.0e-9, 1.0e9])
    exponentials, logarithms, powers = np.zeros((3, 8))
    compute(x, np.log(x), exponentials, logarithms, powers)
    np.testing.assert_allclose(elementary.logarithm(Lanes(*x)).numbers, logarithms, rtol=LAST_DIGITS)
    np.testing.assert_allclose(
        elementary.exponential(Lanes(*np.log(x))).numbers, exponentials, rtol=LAST_DIGITS
    )
    np.testing.assert_allclose(elementary.power(Lanes(*x), 0.31).numbers, powers, rtol=1.0e-15)


@kernel
def at_the_edges(x, y, exponentials, logarithms, powers, roots):
    p = Eight(0)
    exponentials[p] = math.exp(x[p])
    logarithms[p] = math.log(y[p])
    powers[p] = y[p] ** 0.5
    roots[p] = y[p] ** 0.0


def test_what_lies_at_the_edges():
    x = np.array([0.0, -0.0, 1000.0, -1000.0, math.inf, -math.inf, math.nan, 1.0])
    y = np.array([0.0, 1.0, -1.0, math.inf, math.nan, 4.0, 2.5e-308, 1.0e308])
    exponentials, logarithms, powers, ones = np.zeros((4, 8))
    at_the_edges(x, y, exponentials, logarithms, powers, ones)
    np.testing.assert_allclose(
        exponentials, [1.0, 1.0, math.inf, 0.0, math.inf, 0.0, math.nan, math.e], rtol=LAST_DIGITS
    )
    with np.errstate(all="ignore"):
        np.testing.assert_allclose(logarithms, np.log(y), rtol=LAST_DIGITS)
        np.testing.assert_allclose(powers, np.sqrt(y), rtol=1.0e-13)
    np.testing.assert_array_equal(ones, 1.0)


@kernel
def compute_others(x, sines, cosines, tangents, errors):
    for start in range(0, x.shape[0], 8):
        p = Eight(start)
        sines[p] = math.sinh(x[p])
        cosines[p] = math.cosh(x[p])
        tangents[p] = math.tanh(x[p])
        errors[p] = math.erf(x[p])


def test_hyperbolic_and_error_functions():
    rng = np.random.default_rng(3)
    small = rng.choice((-1.0, 1.0), 4000) * 10.0 ** rng.uniform(-12.0, 0.0, 4000)
    x = np.concatenate([rng.uniform(-40.0, 40.0, 4000), rng.uniform(-3.0, 3.0, 4000), small])
    x[:8] = 0.0, -0.0, 1.0, -1.0, 700.0, -700.0, math.inf, math.nan
    results = np.zeros((4, x.size))
    compute_others(x, *results)
    with np.errstate(all="ignore"):
        expected = np.sinh(x), np.cosh(x), np.tanh(x), np.vectorize(math.erf)(x)
    for found, right in zip(results[:3], expected, strict=False):
        np.testing.assert_allclose(found, right, rtol=2.0 * LAST_DIGITS)
    np.testing.assert_allclose(results[3], expected[3], rtol=2.0e-15)  # the rounding of x^2 times x^2
    in_python = elementary.hyperbolic_sine, elementary.hyperbolic_cosine, elementary.hyperbolic_tangent
    for function, found in zip((*in_python, elementary.error_function), results, strict=False):
        np.testing.assert_allclose(function(Lanes(*x[8:16])).numbers, found[8:16], rtol=LAST_DIGITS)


@kernel
def raise_to(x, exponents, powers, by_lanes):
    for k in range(exponents.shape[0]):
        p = Eight(0)
        powers[k][p] = x[p] ** exponents[k]
        by_lanes[k][p] = x[p] ** (exponents[k] + 0.0 * x[p])


def test_negative_numbers_have_whole_powers():
    x = np.array([-0.3, -1.0, -2.5, 0.7, 2.5, -1.0e10, -1.0e-10, 3.0])
    exponents = np.array([4.0, 3.0, 1.0, 0.0, -2.0, -3.0, 0.5, 2.5])
    powers, by_lanes = np.zeros((2, 8, 8))
    raise_to(x, exponents, powers, by_lanes)
    with np.errstate(invalid="ignore"):
        expected = x ** exponents[:, None]
    np.testing.assert_allclose(powers, expected, rtol=1.0e-14)
    np.testing.assert_array_equal(by_lanes, powers)
    assert np.isnan(powers[6:, :3]).all()
