"""Which nodes of a periodic grid are the same point."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.contact.law import Array
from solver.grid import Grid


class Representatives(NamedTuple):
    """For each of the N stored nodes, the one that sums over particles go to."""

    node: Array
    """(N,) index of the node of the domain that this one is an image of, or its own."""
    shift: Array
    """(N, 3) from this node to that one: what a particle's position moves by when the particle does."""


@lru_cache(maxsize=4)
def representatives(grid: Grid) -> Representatives:
    """Images in periodic directions stand for nodes 0 .. cells - 1, other nodes for themselves.

    Where a rank holds a part of the grid, every node stands for itself, since its copies are added up later.
    """
    first, nodes, cells = grid.index.first, grid.index.nodes, grid.cells
    indices = [first[axis] + np.arange(nodes[axis]) for axis in range(3)]
    wrapped = [indices[axis] % cells[axis] if grid.periodic[axis] else indices[axis] for axis in range(3)]
    k, j, i = np.meshgrid(wrapped[2], wrapped[1], wrapped[0], indexing="ij")
    own = np.arange(grid.number_of_nodes)
    node = own if grid.window is not None else np.asarray(grid.flat(i, j, k)).ravel()
    shift = np.zeros((node.size, 3))
    for axis in range(3):
        steps = np.meshgrid(*(wrapped[a] - indices[a] for a in (2, 1, 0)), indexing="ij")[2 - axis]
        shift[:, axis] = steps.ravel() * grid.spacing[axis]
    return Representatives(node, shift)
