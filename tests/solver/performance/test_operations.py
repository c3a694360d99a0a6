"""The count of operations, against functions whose operations can be counted by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from solver.performance.operations import Counted, counted, operations_of
from solver.tensor import Tensor, determinant, matmul, tensor_at


def test_sums_products_and_powers_are_one_each() -> None:
    assert operations_of(lambda a, b: a * b + 2.0 - b / a, 3.0, 4.0) == 4
    assert operations_of(lambda a: 2.0 / a + a**2, 3.0) == 3
    assert operations_of(lambda a: -abs(a) < 2.0, 3.0) == 0


def test_operations_after_a_function_of_math_count() -> None:
    assert operations_of(lambda a, b: a * math.exp(b) + math.sqrt(a), 3.0, 4.0) == 2


@pytest.mark.parametrize(
    ("function", "operations"), [(matmul, 9 * 5), (lambda a, b: a + b, 9), (lambda a, b: a * 2.0, 9)]
)
def test_operations_of_tensors(function, operations: int) -> None:
    """Nine numbers of three products and two sums; nine sums; nine products."""
    rows = np.arange(18.0).reshape(2, 3, 3)
    assert operations_of(lambda r: function(tensor_at(r, 0), tensor_at(r, 1)), rows) == operations


def test_values_are_those_of_plain_numbers_and_arrays_are_copies() -> None:
    rows = np.random.default_rng(1).normal(size=(1, 3, 3))
    twin = counted(rows)
    assert float(determinant(tensor_at(twin, 0))) == determinant(tensor_at(rows, 0))
    twin[0, 0, 0] = Counted(7.0)
    assert rows[0, 0, 0] != 7.0


def test_records_keep_their_class_and_integers_stay() -> None:
    class Pair(tuple):
        __slots__ = ()

    assert counted((1, True, "a", None)) == (1, True, "a", None)
    assert isinstance(counted((1.0, 2))[0], Counted)
    assert isinstance(counted(np.arange(3)), np.ndarray)
    assert isinstance(Counted(2.0) * Tensor(*[1.0] * 9), Tensor)
