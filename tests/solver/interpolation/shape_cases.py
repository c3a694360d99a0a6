"""Shape functions of particles as dense matrices, and particles that try them."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.grid import Grid, Patch
from solver.interpolation.shape import MOST_NODES, particle_domain, shape_functions
from solver.jit import kernel
from solver.tensor import tensor_at

GRID = Grid(
    (-1.0, 2.0, 0.5), (0.5, 0.25, 1.0), (6, 7, 5), (1, 1, 1), (0, 0, 0), (Patch(0, (0, 0, 0), (6, 7, 5)),)
)
"""Cells of unequal sides, away from the origin."""

PLANE = Grid(
    (0.0, -1.0, 0.0), (0.5, 0.25, 1.0), (7, 6, 1), (1, 1, 0), (0, 0, 0), (Patch(0, (0, 0, 0), (7, 6, 1)),)
)
"""Radius and axis, one cell around."""


def fill_rows(
    interpolator: Any, grid: Any, positions: Any, size: Any, F: Any, counts: Any, nodes: Any, S: Any, G: Any
) -> None:
    """The entries of every particle, one row each."""
    for p in range(positions.shape[0]):
        domain = particle_domain(interpolator, tensor_at(F, p), tensor_at(size, p))
        counts[p] = shape_functions(
            interpolator,
            grid,
            positions[p, 0],
            positions[p, 1],
            positions[p, 2],
            domain,
            nodes[p],
            S[p],
            G[p],
        )


fill_rows_compiled = kernel(fill_rows)


class Rows:
    """Entries of particles: counts (n,), nodes and weights (n, MOST_NODES), gradients (n, MOST_NODES, 3)."""

    def __init__(
        self, interpolator: Any, grid: Grid, positions: Any, size: Any, F: Any = None, compiled: bool = False
    ) -> None:
        positions = np.atleast_2d(np.asarray(positions, dtype=float))
        n = len(positions)
        size = np.ascontiguousarray(np.broadcast_to(size, (n, 3, 3)))
        F = np.ascontiguousarray(np.broadcast_to(np.eye(3) if F is None else F, (n, 3, 3)))
        self.grid = grid
        self.counts = np.zeros(n, np.int64)
        self.nodes = np.zeros((n, MOST_NODES), np.int64)
        self.weights = np.zeros((n, MOST_NODES))
        self.gradients = np.zeros((n, MOST_NODES, 3))
        run = fill_rows_compiled if compiled else fill_rows
        run(
            interpolator,
            grid.index,
            positions,
            size,
            F,
            self.counts,
            self.nodes,
            self.weights,
            self.gradients,
        )

    def used(self, p: int) -> tuple[Any, Any, Any]:
        """Nodes, weights and gradients of one particle, as many as count."""
        n = self.counts[p]
        return self.nodes[p, :n], self.weights[p, :n], self.gradients[p, :n]

    def dense(self) -> tuple[Any, Any]:
        """S (particles, nodes) and G (particles, nodes, 3)."""
        S = np.zeros((len(self.counts), self.grid.number_of_nodes))
        G = np.zeros((*S.shape, 3))
        for p in range(len(self.counts)):
            nodes, weights, gradients = self.used(p)
            np.add.at(S[p], nodes, weights)
            np.add.at(G[p], nodes, gradients)
        return S, G


def sample_positions(grid: Grid, count: int = 25, seed: int = 0, margin: float = 0.0) -> Any:
    """Random positions in the grid, ``margin`` cells away from its boundary."""
    random = np.random.default_rng(seed)
    low = np.array(grid.anchor) + margin * np.array(grid.spacing)
    high = np.array(grid.upper) - margin * np.array(grid.spacing)
    return random.uniform(low, high, (count, 3))


def on_faces(grid: Grid) -> Any:
    """Positions exactly on nodes, edges, faces, in the middles of cells, and where gimp touches its nodes."""
    steps = np.array([0.0, 0.25, 0.5, 0.75])
    q = np.stack(np.meshgrid(2.0 + steps, 2.0 + steps, 2.0 + steps, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.array(grid.anchor) + q * np.array(grid.spacing)


def sample_deformations(count: int = 25, seed: int = 1, strength: float = 0.3) -> Any:
    """Deformation gradients with stretch, shear and rotation."""
    return np.eye(3) + strength * np.random.default_rng(seed).uniform(-1.0, 1.0, (count, 3, 3))


SIZES = np.diag([0.5, 0.25, 1.0 / 3.0])
"""Two, four and three particles in the directions of a cell."""
