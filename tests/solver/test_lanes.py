"""Rows of eight numbers: as plain values, and the same in kernels."""

from __future__ import annotations

import numpy as np

from solver.jit import kernel
from solver.lanes import WIDTH, Lanes, above, add_scaled, every, floor, lanes_at, new_rows, put_lanes

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
