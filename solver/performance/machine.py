"""What the machine can do at best: bytes a second of its memory, operations a second of its cores."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from solver.jit import kernel
from solver.lanes import WIDTH, every, lanes_at, put_lanes
from solver.team import Team

LENGTH = 4_000_000
"""Numbers in each of the three arrays of the triad, 96 MB in all: more than caches hold."""

ROUNDS = 4_000_000
"""Repetitions of the multiplications and additions."""

CHAINS = 12
"""Multiply-add chains side by side, more than the processor needs to be always busy."""


class Machine(NamedTuple):
    """The measured limits."""

    bandwidth: float
    """Bytes a second of a STREAM triad, counted as STREAM does: two numbers read and one written."""
    flops: float
    """Operations a second of fused multiplications and additions in vector registers, two each."""


@kernel
def triad(a: Any, b: Any, c: Any, s: float, first: int, last: int) -> None:
    """McCalpin's triad, a = b + s c."""
    # Parts of the arrays, so that indices begin at 0: others might be negative, and such loops are not vectorized.
    x, y, z = a[first:last], b[first:last], c[first:last]
    for i in range(x.shape[0]):
        x[i] = y[i] + s * z[i]


@kernel
def multiply_add(rows: Any, row: int, rounds: int) -> None:
    """Let x <- x s + t in :data:`CHAINS` independent vectors; begins with and leaves numbers in a row of ``rows``."""
    x = lanes_at(rows, row, 0)
    s, t = every(0.999), every(0.001)
    x0, x1, x2, x3, x4, x5 = x, x + 0.1, x + 0.2, x + 0.3, x + 0.4, x + 0.5
    x6, x7, x8, x9, x10, x11 = x + 0.6, x + 0.7, x + 0.8, x + 0.9, x + 1.0, x + 1.1
    for _ in range(rounds):
        x0, x1, x2, x3 = x0 * s + t, x1 * s + t, x2 * s + t, x3 * s + t
        x4, x5, x6, x7 = x4 * s + t, x5 * s + t, x6 * s + t, x7 * s + t
        x8, x9, x10, x11 = x8 * s + t, x9 * s + t, x10 * s + t, x11 * s + t
    put_lanes(rows, row, 0, x0 + x1 + x2 + x3 + x4 + x5 + x6 + x7 + x8 + x9 + x10 + x11)


class Calibration:
    """The two kernels with their arrays, to be measured as often as wanted.

    Parameters
    ----------
    threads : how many share the work, as many as in what is compared with it.
    timer : as of ``PhaseClock``.
    """

    def __init__(self, threads: int = 1, timer: Callable[[], float] = time.perf_counter) -> None:
        self._threads = threads
        self._team = Team(threads)
        self._timer = timer
        self._a, self._b, self._c = (np.full(LENGTH, value) for value in (0.0, 1.0, 2.0))
        self._rows = np.ones((8 * threads, WIDTH))  # a row in 8 is used: threads write to lines of their own
        triad(self._a, self._b, self._c, 3.0, 0, 1)
        multiply_add(self._rows, 0, 1)

    def measure(self, repetitions: int = 5) -> Machine:
        """The medians of some repetitions, the two kernels in turn."""
        bandwidths, flops = [], []
        for _ in range(repetitions):
            seconds = self._seconds(
                LENGTH, lambda first, last: triad(self._a, self._b, self._c, 3.0, first, last)
            )
            bandwidths.append(3 * 8 * LENGTH / seconds)
            seconds = self._seconds(
                self._threads, lambda first, last: multiply_add(self._rows, 8 * first, ROUNDS)
            )
            flops.append(2 * CHAINS * WIDTH * ROUNDS * self._threads / seconds)
        return Machine(statistics.median(bandwidths), statistics.median(flops))

    def _seconds(self, count: int, work: Callable[[int, int], Any]) -> float:
        start = self._timer()
        self._team.share(count, self._threads, work)
        return self._timer() - start
