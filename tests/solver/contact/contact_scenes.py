"""Small scenes for contact laws."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.contact.law import ContactScene
from solver.grid import Grid, Patch
from solver.interpolation.linear import Linear
from solver.nodal import EMPTY_MASS, new_nodal_fields
from solver.particles import Particles, new_arrays

CELLS = (4, 3, 2)


class NoSymmetry:
    """Boundary conditions without a face of symmetry."""

    def apply_symmetry(self, vectors: Any, material: int, touched: Any = None) -> None:
        """Change nothing."""


def make_grid(cells: Any = CELLS, spacing: Any = (0.5, 0.25, 1.0), periodic: Any = (0, 0, 0)) -> Grid:
    return Grid((-1.0, 0.5, 0.0), spacing, cells, (1, 1, 1), periodic, (Patch(0, (0, 0, 0), cells),))


def block(grid: Grid, low: Any, high: Any, spacing: float = 0.5, stress: float = 0.0) -> Particles:
    """Particles of density 1 in equal boxes that fill low .. high, measured from the anchor."""
    axes = [np.arange(a + spacing / 2, b, spacing) for a, b in zip(low, high, strict=True)]
    position = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3) + grid.anchor
    particles = new_arrays(Particles, len(position))
    particles.position[:] = position
    particles.volume[:] = particles.mass[:] = spacing**3
    particles.size[:] = spacing / np.array(grid.spacing) * np.eye(3)
    particles.stress[:] = stress * np.eye(3)
    particles.surface[:] = 1.0
    return particles


def random_scene(materials: int = 3, grid: Grid | None = None, seed: int = 1, **changes: Any) -> ContactScene:
    """Random nodal fields on a small grid, with some nodes that hold one material or none."""
    grid = grid or make_grid()
    random = np.random.default_rng(seed)
    nodal = new_nodal_fields(grid, materials)
    nodal.mass[:] = random.uniform(0.1, 2.0, nodal.mass.shape)
    nodal.mass[random.uniform(size=nodal.mass.shape) < 0.4] = EMPTY_MASS
    nodal.volume[:] = nodal.mass * 0.1
    for vectors in (nodal.velocity, nodal.velocity_star, nodal.internal_force):
        vectors[:] = random.normal(size=vectors.shape)
    inside = (grid.node_positions() >= np.array(grid.anchor) - 1e-9).all(axis=1)
    inside &= (grid.node_positions() <= np.array(grid.upper) + 1e-9).all(axis=1)
    given = {
        "grid": grid,
        "nodal": nodal,
        "particles": [new_arrays(Particles, 0) for _ in range(materials)],
        "rigid": [False] * materials,
        "possible_alpha": [True] * materials,
        "axisymmetric": False,
        "colinear_normals": True,
        "xpic2": False,
        "interpolation": Linear(),
        "node_to_cell_weight": np.full(grid.number_of_nodes, 0.125),
        "boundary_conditions": NoSymmetry(),
        "owned_nodes": inside,
        "dt": 1.0e-3,
        "time": 0.0,
    }
    return ContactScene(**(given | changes))


def place(s: ContactScene, velocities: Any) -> ContactScene:
    """Give the nodes the mass and volume of the particles by hat functions, and uniform velocities."""
    for m, particles in enumerate(s.particles):
        distance = np.abs(s.node_positions[:, None] - particles.position[None])
        weights = np.maximum(0.0, 1.0 - distance / s.grid.spacing).prod(axis=2)
        s.nodal.mass[m] = EMPTY_MASS + weights @ particles.mass
        s.nodal.volume[m] = EMPTY_MASS + weights @ particles.volume
        s.nodal.velocity[m] = velocities[m]
    s.nodal.velocity_star[:] = s.nodal.velocity
    return s
