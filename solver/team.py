"""Threads that share the loops of a step. What they compute does not depend on how many they are."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.grid import Grid, NodeBlock

LEAST_PARTICLES = 4096
"""Fewer particles a thread are done sooner than it takes to wake the thread."""


def available_cores() -> int:
    """The cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Team:
    """A number of threads; kernels release Python's lock, so that they run side by side."""

    def __init__(self, threads: int = 1) -> None:
        if threads < 1:
            raise ValueError(f"{threads} threads; at least 1 is needed")
        self.threads = threads
        self._pool: Any = None

    def size_for(self, particles: int) -> int:
        """How many threads are worth waking for that many particles."""
        return max(1, min(self.threads, particles // LEAST_PARTICLES))

    def run(self, tasks: Sequence[Callable[[], Any]]) -> None:
        """Do all tasks, the first in the calling thread; what a task raises is raised here, once all have ended."""
        if len(tasks) > 1 and self._pool is None:
            from concurrent.futures import ThreadPoolExecutor

            self._pool = ThreadPoolExecutor(self.threads - 1)
        others = [self._pool.submit(task) for task in tasks[1:]]
        try:
            tasks[0]()
        finally:
            problems = [other.exception() for other in others]
        for problem in filter(None, problems):
            raise problem

    def share(self, count: int, members: int, task: Callable[[int, int], Any]) -> None:
        """Call ``task(first, last)`` for even parts of ``range(count)``, one for each of ``members`` threads."""
        if members == 1:
            task(0, count)
            return
        ends = [count * m // members for m in range(members + 1)]
        self.run([_part(task, first, last) for first, last in itertools.pairwise(ends)])


def _part(task: Callable[[int, int], Any], first: int, last: int) -> Callable[[], Any]:
    return lambda: task(first, last)


def node_blocks(grid: Grid, position: NDArray[Any], members: int) -> list[NodeBlock]:
    """Slabs of nodes with about as many of the particles at ``position`` (n, 3) each.

    They lie across y or z, where the particles extend farther: rows along x stay whole.
    """
    if members == 1:
        return [grid.all_nodes]
    index = grid.index
    extent = np.ptp(position[:, 1:], axis=0) / np.array(index.spacing[1:])
    axis = 1 + int(np.nan_to_num(extent).argmax())
    between = np.quantile(position[:, axis], np.arange(1, members) / members)
    cuts = np.floor((between - index.anchor[axis]) / index.spacing[axis]) + 1 - index.first[axis]
    ends = [0, *np.clip(np.nan_to_num(cuts), 0, index.nodes[axis]).astype(int).tolist(), index.nodes[axis]]
    blocks = []
    for first, last in itertools.pairwise(ends):
        low, high = [0, 0, 0], list(index.nodes)
        low[axis], high[axis] = first, last
        blocks.append(NodeBlock((low[0], low[1], low[2]), (high[0], high[1], high[2]), False))
    return blocks
