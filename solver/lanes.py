"""Rows of eight numbers that are added and scaled at once, for the transfers between particles and grid.

A :class:`Lanes` is a value like :class:`solver.tensor.Tensor`; in kernels it lives in one vector register, or two
where the processor has shorter ones (``solver.jit`` tells numba how). Nodal arrays that kernels read and write so
have rows of a multiple of eight.
"""

from __future__ import annotations

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

    __radd__ = __add__
    __rmul__ = __mul__

    def __getitem__(self, k: int) -> float:
        return float(self.numbers[k])


@inline
def every(number: float) -> Lanes:
    """The same number in all lanes."""
    return Lanes(number, number, number, number, number, number, number, number)


def _numbers(value: Lanes | float) -> Any:
    return value.numbers if isinstance(value, Lanes) else value


def floor(a: Lanes) -> Lanes:
    """The largest whole number not above each."""
    return Lanes(*np.floor(a.numbers))


def above(a: Lanes | float, b: Lanes | float) -> Lanes:
    """1 where ``a`` is greater than ``b``, else 0: a factor that leaves out without a branch."""
    return Lanes(*(_numbers(a) > _numbers(b)))


def add_scaled(total: Lanes, part: Lanes, factor: float) -> Lanes:
    """The sum ``total + part * factor``, in kernels rounded once: the compiler has no choice where to fuse."""
    return total + part * factor


def lanes_at(rows: Any, row: Any, start: int) -> Lanes:
    """Eight numbers of a C-contiguous array (n, m), from ``rows[row, start]`` on; nothing is checked."""
    return Lanes(*rows[row, start : start + WIDTH].tolist())


def put_lanes(rows: Any, row: Any, start: int, lanes: Lanes) -> None:
    """Store eight numbers in a C-contiguous array (n, m), from ``rows[row, start]`` on; nothing is checked."""
    rows[row, start : start + WIDTH] = lanes.numbers


def new_rows(count: int, width: int) -> Any:
    """Zeros (count, width) that begin where a cache line does, so that no row of a multiple of 8 straddles two."""
    line = 64 // np.dtype(np.float64).itemsize
    room = np.zeros(count * width + line)
    skip = -room.ctypes.data // room.itemsize % line
    return room[skip : skip + count * width].reshape(count, width)
