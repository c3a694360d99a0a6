"""Nodes that periodic directions repeat, where one rank holds the whole grid."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.grid import Grid

Array = NDArray[Any]


def periodic_images(grid: Grid) -> tuple[Array, Array]:
    """Pairs (owner, image) of nodes that are one and the same, direction by direction."""
    owners, images = [], []
    index = grid.index
    axes = [np.arange(index.first[a], index.first[a] + index.nodes[a]) for a in range(3)]
    for axis in range(3):
        if not grid.periodic[axis]:
            continue
        n = grid.cells[axis]
        for image in (-1, n, n + 1):
            if image < index.first[axis] or image >= index.first[axis] + index.nodes[axis]:
                continue
            there, here = list(axes), list(axes)
            there[axis], here[axis] = np.array([image]), np.array([image % n])
            images.append(grid.flat(*np.meshgrid(*there, indexing="ij")).ravel())
            owners.append(grid.flat(*np.meshgrid(*here, indexing="ij")).ravel())
    empty = np.zeros(0, dtype=np.int64)
    return np.concatenate([empty, *owners]), np.concatenate([empty, *images])
