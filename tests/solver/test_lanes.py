"""Rows of eight numbers: as plain values, and the same in kernels."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest

from solver.jit import kernel
from solver.lanes import (
    WIDTH,
    Eight,
    Lanes,
    UpToEight,
    above,
    add_scaled,
    anywhere,
    every,
    everywhere,
    floor,
    lanes_at,
    largest_of,
    like,
    negation,
    new_rows,
    put_lanes,
    sum_of,
    where,
)
from solver.tensor import Tensor, isotropic, tensor_at

A = np.array([0.5, -1.25, 2.0, 3.75, -0.0, 1e30, 7.0, -7.5])
B = np.array([2.0, 4.0, -8.0, 0.25, 1.0, 1e-30, 7.0, 3.0])


def operate(rows, results):
    """One result a row."""
    a, b = lanes_at(rows, 0, 0), lanes_at(rows, 1, 0)
    put_lanes(results, 0, 0, a + b)
    put_lanes(results, 1, 0, a - b)
    put_lanes(results, 2, 0, a * b)
    put_lanes(results, 3, 0, a / b)
    put_lanes(results, 4, 0, 3.0 * a)
    put_lanes(results, 5, 0, 1.0 - a)
    put_lanes(results, 6, 0, a / 4.0)
    put_lanes(results, 7, 0, floor(a))
    put_lanes(results, 8, 0, above(a, b))
    put_lanes(results, 9, 0, above(a, 0.0))
    put_lanes(results, 10, 0, every(2.5))
    put_lanes(results, 11, 0, Lanes(a[7], a[6], a[5], a[4], a[3], a[2], a[1], a[0]))
    put_lanes(results, 12, 8, a)
    put_lanes(results, 13, 0, add_scaled(a, b, 0.5))


EXPECTED = np.array(
    [
        A + B,
        A - B,
        A * B,
        A / B,
        3.0 * A,
        1.0 - A,
        A / 4.0,
        np.floor(A),
        A > B,
        A > 0.0,
        np.full(8, 2.5),
        A[::-1],
    ]
)
compiled = kernel(operate)


def check(run):
    results = new_rows(14, 16)
    run(np.array([A, B]), results)
    np.testing.assert_array_equal(results[:12, :8], EXPECTED)
    np.testing.assert_array_equal(results[12, 8:], A)
    np.testing.assert_array_equal(results[13, :8], A + 0.5 * B)
    assert not results[:12, 8:].any()


def test_lanes_are_added_and_scaled_number_by_number():
    check(operate)


def test_kernels_do_the_same():
    check(compiled)


def compare(rows, results):
    """Choices between two rows, one a row."""
    a, b = lanes_at(rows, 0, 0), lanes_at(rows, 1, 0)
    put_lanes(results, 0, 0, where(a < b, a, b))
    put_lanes(results, 1, 0, where(a <= b, 1.0, b))
    put_lanes(results, 2, 0, where(a > b, a, 0.0))
    put_lanes(results, 3, 0, where(a >= b, 1.0, 2.0))
    put_lanes(results, 4, 0, where(a == 7.0, a, b))
    put_lanes(results, 5, 0, where(a != b, a, 0.0))
    put_lanes(results, 6, 0, where((a > 0.0) & (b > 0.0), a, b))
    put_lanes(results, 7, 0, where((a < 0.0) | (b < 0.0), a, b))
    put_lanes(results, 8, 0, where(negation(a < 0.0), a, b))
    put_lanes(results, 9, 0, like(3.0, a))
    results[10, 0] = sum_of(b)
    results[10, 1] = largest_of(b)
    results[10, 2] = 1.0 if anywhere(a > 1.0e29) else 0.0
    results[10, 3] = 1.0 if anywhere(a > 1.0e31) else 0.0
    results[10, 4] = 1.0 if everywhere(a > -8.0) else 0.0
    results[10, 5] = 1.0 if everywhere(a > 0.0) else 0.0


@pytest.mark.parametrize("run", [compare, kernel(compare)], ids=["plain", "kernel"])
def test_comparisons_choose_number_by_number(run):
    results = new_rows(11, 8)
    run(np.array([A, B]), results)
    expected = [
        np.minimum(A, B),
        np.where(A <= B, 1.0, B),
        np.where(A > B, A, 0.0),
        np.where(A >= B, 1.0, 2.0),
        np.where(A == 7.0, A, B),
        np.where(A != B, A, 0.0),
        np.where((A > 0.0) & (B > 0.0), A, B),
        np.where((A < 0.0) | (B < 0.0), A, B),
        np.where(A >= 0.0, A, B),
        np.full(8, 3.0),
    ]
    np.testing.assert_array_equal(results[:10], expected)
    np.testing.assert_array_equal(results[10], [B.sum(), 7.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0])


class Inner(NamedTuple):
    number: float
    holds: bool


class Outer(NamedTuple):
    tensor: Tensor
    inner: Inner


@kernel
def choose_records(rows, tensors, results):
    """Of records in lanes, and of one in lanes and one of numbers."""
    p = Eight(0)
    a, b = lanes_at(rows, 0, 0), lanes_at(rows, 1, 0)
    t = tensor_at(tensors, p)
    wide = Outer(t, Inner(a, a > 0.0))
    chosen = where(a < b, wide, Outer(t * 2.0, Inner(b, b > 3.0)))
    results[p, 0] = chosen.tensor.yz
    results[p, 1] = chosen.inner.number
    results[p, 2] = where(chosen.inner.holds, 1.0, 0.0)
    chosen = where(a < b, wide, Outer(isotropic(5.0), Inner(7.0, True)))
    results[p, 3] = chosen.tensor.yy
    results[p, 4] = chosen.inner.number
    results[p, 5] = where(chosen.inner.holds, 1.0, 0.0)


def test_records_are_chosen_part_by_part():
    tensors = np.random.default_rng(9).normal(size=(8, 3, 3))
    results = np.zeros((8, 6))
    choose_records(np.array([A, B]), tensors, results)
    less = A < B
    expected = [
        np.where(less, 1.0, 2.0) * tensors[:, 1, 2],
        np.where(less, A, B),
        np.where(less, A > 0.0, B > 3.0),
        np.where(less, tensors[:, 1, 1], 5.0),
        np.where(less, A, 7.0),
        np.where(less, A > 0.0, True),
    ]
    np.testing.assert_array_equal(results, np.transpose(expected))


def test_records_of_plain_lanes_are_chosen_part_by_part():
    a, b = Lanes(*A), Lanes(*B)
    chosen = where(a < b, Inner(a, 1.0), Inner(b, 2.0))
    np.testing.assert_array_equal(chosen.number.numbers, np.minimum(A, B))
    np.testing.assert_array_equal(chosen.holds.numbers, np.where(A < B, 1.0, 2.0))


@kernel
def whole_powers(rows, results):
    a = lanes_at(rows, 0, 0)
    put_lanes(results, 0, 0, a**2)
    put_lanes(results, 1, 0, a**3)
    put_lanes(results, 2, 0, a**4)
    put_lanes(results, 3, 0, 2.5**a)


def test_powers():
    results = new_rows(4, 8)
    whole_powers(np.array([B]), results)
    np.testing.assert_array_equal(results[:3], [B * B, B * B * B, (B * B) * (B * B)])
    np.testing.assert_allclose(results[3], 2.5**B, rtol=2e-15)


def test_what_holds_for_eight_holds_for_one():
    assert (where(True, 1.0, 2.0), where(False, 1.0, 2.0), like(3.0, 1.0)) == (1.0, 2.0, 3.0)
    assert (sum_of(2.5), largest_of(-1.0), floor(-0.5)) == (2.5, -1.0, -1.0)
    assert (anywhere(True), everywhere(False), negation(False)) == (True, False, True)


@kernel
def of_eight(numbers, whole, vectors, tensors, results):
    """What particles 3 to 10 have, through their arrays and back."""
    p = Eight(3)
    results[p, 0] = numbers[p]
    results[p, 1] = vectors[p, 2]
    results[p, 2] = tensors[p, 1, 2]
    results[p, 3] = abs(numbers[p])
    results[p, 4] = max(numbers[p], 0.25)
    results[p, 5] = min(0.25, numbers[p])
    results[p, 6] = math.sqrt(abs(numbers[p]))
    results[p, 7] = whole[p] + 1
    numbers[p] -= 1.0
    numbers[p] *= 2.0
    whole[p] = where(numbers[p] > 0.0, 5, whole[p])
    vectors[p, 1] = 4.0
    tensors[p, 2, 0] = numbers[p]


def test_eight_particles_index_arrays():
    rng = np.random.default_rng(3)
    numbers, vectors, tensors = rng.normal(size=14), rng.normal(size=(14, 3)), rng.normal(size=(14, 3, 3))
    whole, results = np.arange(14, dtype=np.int32), np.zeros((14, 8))
    before = [array.copy() for array in (numbers, whole, vectors, tensors)]
    of_eight(numbers, whole, vectors, tensors, results)
    x, n, v, t = before
    columns = [x, v[:, 2], t[:, 1, 2], abs(x), np.maximum(x, 0.25), np.minimum(x, 0.25), abs(x) ** 0.5, n + 1]
    inside = np.zeros(14, bool)
    inside[3:11] = True
    np.testing.assert_array_equal(results, np.where(inside[:, None], np.transpose(columns), 0.0))
    new = (x - 1.0) * 2.0
    np.testing.assert_array_equal(numbers, np.where(inside, new, x))
    np.testing.assert_array_equal(whole, np.where(inside & (new > 0.0), 5, n))
    v[inside, 1], t[inside, 2, 0] = 4.0, new[inside]
    np.testing.assert_array_equal(vectors, v)
    np.testing.assert_array_equal(tensors, t)


@kernel
def of_up_to_eight(numbers, vectors, first, results):
    p = UpToEight(first, numbers.shape[0] - 1)
    put_lanes(results, 0, 0, numbers[p])
    put_lanes(results, 1, 0, vectors[p, 1])
    put_lanes(results, 2, 0, 4.0)


def test_beyond_the_last_particle_the_last_is_repeated():
    rng = np.random.default_rng(6)
    numbers, vectors, results = rng.normal(size=13), rng.normal(size=(13, 3)), new_rows(3, 8)
    for first in (0, 5, 8, 12):
        of_up_to_eight(numbers, vectors, first, results)
        chosen = np.minimum(np.arange(first, first + 8), 12)
        np.testing.assert_array_equal(results, [numbers[chosen], vectors[chosen, 1], np.full(8, 4.0)])


def fused(rows, results):
    put_lanes(results, 0, 0, add_scaled(lanes_at(rows, 0, 0), lanes_at(rows, 1, 0), 1.0 + 2.0**-30))


def test_a_sum_and_a_product_are_rounded_once_in_kernels():
    """(1 + e)^2 - 1 with e = 2^-30 is 2 e + e^2; rounding the product loses e^2."""
    e = 2.0**-30
    results = new_rows(1, 8)
    kernel(fused)(np.array([np.full(8, -1.0), np.full(8, 1.0 + e)]), results)
    np.testing.assert_array_equal(results, 2.0 * e + e * e)


def test_rows_begin_where_cache_lines_do():
    for count in range(1, 6):
        rows = new_rows(count, 2 * WIDTH)
        assert rows.shape == (count, 16)
        assert rows.ctypes.data % 64 == 0
        assert rows.flags.c_contiguous
        assert not rows.any()
