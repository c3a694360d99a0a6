"""Eight numbers that are computed with at once: rows of nodal arrays, or one number of each of eight particles.

A :class:`Lanes` is a value like :class:`solver.tensor.Tensor`; in kernels it lives in one vector register, or two
where the processor has shorter ones (``solver.jit`` tells numba how). Nodal arrays that kernels read and write so
have rows of a multiple of eight.

What is written for the numbers of one particle holds for those of eight as it stands, if nothing branches on them:
``array[p]`` takes a particle or :class:`Eight` of them, comparisons give a truth or eight, a mask, and
:func:`where`, :func:`anywhere` and their like take both. Masks are combined with ``&`` and ``|``.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from solver.dispatch import inline

WIDTH = 8
"""Numbers in a row."""


class Lanes:
    """Eight numbers. ``a + b``, ``a - b``, ``a * b``, ``a / b`` and ``a[k]`` work; one of the two may be a number."""

    __slots__ = ("numbers",)

    def __init__(
        self, a: float, b: float, c: float, d: float, e: float, f: float, g: float, h: float
    ) -> None:
        self.numbers = np.array((a, b, c, d, e, f, g, h), dtype=np.float64)

    def __add__(self, other: Lanes | float) -> Lanes:
        return Lanes(*(self.numbers + _numbers(other)))

    def __sub__(self, other: Lanes | float) -> Lanes:
        return Lanes(*(self.numbers - _numbers(other)))

    def __rsub__(self, other: float) -> Lanes:
        return Lanes(*(other - self.numbers))

    def __mul__(self, other: Lanes | float) -> Lanes:
        return Lanes(*(self.numbers * _numbers(other)))

    def __truediv__(self, other: Lanes | float) -> Lanes:
        return Lanes(*(self.numbers / _numbers(other)))

    def __rtruediv__(self, other: float) -> Lanes:
        return Lanes(*(other / self.numbers))

    def __neg__(self) -> Lanes:
        return Lanes(*-self.numbers)

    def __abs__(self) -> Lanes:
        return Lanes(*np.abs(self.numbers))

    __radd__ = __add__
    __rmul__ = __mul__

    def __lt__(self, other: Lanes | float) -> Any:
        return self.numbers < _numbers(other)

    def __le__(self, other: Lanes | float) -> Any:
        return self.numbers <= _numbers(other)

    def __gt__(self, other: Lanes | float) -> Any:
        return self.numbers > _numbers(other)

    def __ge__(self, other: Lanes | float) -> Any:
        return self.numbers >= _numbers(other)

    def __eq__(self, other: object) -> Any:
        return self.numbers == _numbers(other)

    def __ne__(self, other: object) -> Any:
        return self.numbers != _numbers(other)

    __hash__ = None  # type: ignore[assignment]  # comparisons give masks

    def __getitem__(self, k: int) -> float:
        return float(self.numbers[k])


@inline
def every(number: float) -> Lanes:
    """The same number in all lanes."""
    return Lanes(number, number, number, number, number, number, number, number)


def _numbers(value: Any) -> Any:
    return value.numbers if isinstance(value, Lanes) else value


class Eight:
    """Eight particles next to each other, as an index of their arrays in kernels."""

    __slots__ = ("first",)

    def __init__(self, first: int) -> None:
        self.first = first


class UpToEight:
    """Up to eight particles next to each other, to read from in kernels: beyond the last, the last is repeated."""

    __slots__ = ("first", "last")

    def __init__(self, first: int, last: int) -> None:
        self.first, self.last = first, last


def floor(a: Any) -> Any:
    """The largest whole number not above each."""
    return Lanes(*np.floor(a.numbers)) if isinstance(a, Lanes) else float(math.floor(a))


def where(condition: Any, a: Any, b: Any) -> Any:
    """``a`` where the condition holds, else ``b``: numbers, truths, tensors or records of them. Both are computed."""
    if not isinstance(condition, np.ndarray):
        return a if condition else b
    if isinstance(a, tuple):
        return type(a)(*(where(condition, x, y) for x, y in zip(a, b, strict=True)))
    return Lanes(*np.where(condition, _numbers(a), _numbers(b)))


def like(value: Any, pattern: Any) -> Any:
    """A number or truth, in as many lanes as another value has."""
    return every(value) if isinstance(pattern, Lanes) else value


def anywhere(condition: Any) -> bool:
    """Whether a condition holds for a particle, or for any of eight."""
    return bool(np.any(condition))


def everywhere(condition: Any) -> bool:
    """Whether a condition holds for a particle, or for all of eight."""
    return bool(np.all(condition))


def negation(condition: Any) -> Any:
    """The opposite of a truth or mask."""
    return np.logical_not(condition)


def sum_of(a: Any) -> float:
    """The sum of eight numbers; a single one is its own."""
    return float(np.sum(_numbers(a)))


def largest_of(a: Any) -> float:
    """The largest of eight numbers; a single one is its own."""
    return float(np.max(_numbers(a)))


def above(a: Lanes | float, b: Lanes | float) -> Lanes:
    """1 where ``a`` is greater than ``b``, else 0: a factor that leaves out without a branch."""
    return Lanes(*(_numbers(a) > _numbers(b)))


def add_scaled(total: Lanes, part: Lanes, factor: float) -> Lanes:
    """The sum ``total + part * factor``, in kernels rounded once: the compiler has no choice where to fuse."""
    return total + part * factor


def lanes_at(rows: Any, row: Any, start: int) -> Lanes:
    """Eight numbers of a C-contiguous array (n, m), from ``rows[row, start]`` on; nothing is checked."""
    return Lanes(*rows[row, start : start + WIDTH].tolist())


def put_lanes(rows: Any, row: Any, start: int, lanes: Lanes | float) -> None:
    """Store eight numbers, or one eight times, from ``rows[row, start]`` on in a C-contiguous array (n, m).

    Nothing is checked.
    """
    rows[row, start : start + WIDTH] = _numbers(lanes)


def new_rows(count: int, width: int) -> Any:
    """Zeros (count, width) that begin where a cache line does, so that no row of a multiple of 8 straddles two."""
    line = 64 // np.dtype(np.float64).itemsize
    room = np.zeros(count * width + line)
    skip = -room.ctypes.data // room.itemsize % line
    return room[skip : skip + count * width].reshape(count, width)
