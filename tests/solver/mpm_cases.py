"""Grids, bodies and simulations for tests, built without a deck."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.body import Body
from solver.boundary_conditions import BoundaryConditions, Condition, Region
from solver.flags import Flags
from solver.grid import Grid, Patch
from solver.interpolation.gimp import Gimp
from solver.interpolation.linear import Linear, LinearAxisymmetric
from solver.materials.constitutive import Material, NoState
from solver.materials.failure import new_failure
from solver.materials.hypo_elastic import HypoElastic
from solver.particles import Particles, new_arrays
from solver.simulation import Simulation

MATERIAL = Material(
    density=2.0,
    specific_heat=4.0,
    specific_heat_constant_pressure=4.0,
    thermal_conductivity=0.0,
    room_temperature=294.0,
    melt_temperature=1.0e9,
    thermal_expansion=0.0,
)


def make_grid(
    cells: tuple[int, int, int],
    spacing: tuple[float, float, float] = (1.0, 1.0, 1.0),
    anchor: tuple[float, float, float] = (0.0, 0.0, 0.0),
    extra: tuple[int, int, int] = (1, 1, 1),
    periodic: tuple[int, int, int] = (0, 0, 0),
    patches: tuple[int, int, int] = (1, 1, 1),
) -> Grid:
    """A box of cells cut evenly into patches."""
    blocks = []
    for block in np.ndindex(*patches):
        low, high = (
            tuple(n * (b + end) // count for n, b, count in zip(cells, block, patches, strict=True))
            for end in (0, 1)
        )
        blocks.append(Patch(len(blocks), low, high))
    return Grid(anchor, spacing, cells, extra, periodic, tuple(blocks))


def fill(
    low: tuple[float, ...], high: tuple[float, ...], spacing: tuple[float, ...], per_cell: tuple[int, ...]
) -> Any:
    """Positions (n, 3) of particles that fill a box evenly, ``per_cell`` in each direction of a cell."""
    axes = []
    for a, b, h, n in zip(low, high, spacing, per_cell, strict=True):
        count = round((b - a) / h * n)
        axes.append(a + (np.arange(count) + 0.5) * h / n)
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def make_particles(
    grid: Grid, positions: Any, per_cell: tuple[int, int, int] = (2, 2, 2), density: float = MATERIAL.density
) -> Particles:
    """Particles at rest and at room temperature that each fill their share of a cell."""
    particles = new_arrays(Particles, len(positions))
    particles.position[:] = positions
    particles.size[:] = np.diag(1.0 / np.array(per_cell))
    particles.volume[:] = grid.cell_volume / np.prod(per_cell)
    particles.mass[:] = density * particles.volume
    particles.temperature[:] = MATERIAL.room_temperature
    particles.previous_temperature[:] = MATERIAL.room_temperature
    particles.id[:] = np.arange(len(positions))
    return particles


def make_body(
    particles: Particles, index: int = 0, material: Material = MATERIAL, model: Any = None, **options: Any
) -> Body:
    """A body, hypoelastic with E = 1 and no lateral contraction unless said."""
    return Body(
        index,
        f"body {index}",
        material,
        elastic(1.0, 0.0) if model is None else model,
        NoState(),
        particles,
        **{"failure": new_failure(None, None, len(particles)), **options},
    )


def elastic(youngs_modulus: float, poissons_ratio: float) -> HypoElastic:
    """Hypoelasticity from Young's modulus and Poisson's ratio."""
    E, nu = youngs_modulus, poissons_ratio
    return HypoElastic(G=E / (2.0 * (1.0 + nu)), K=E / (3.0 * (1.0 - 2.0 * nu)))


def make_simulation(
    grid: Grid,
    bodies: list[Body],
    interpolator: Any = None,
    regions: Any = (),
    gravity: Any = (0.0, 0.0, 0.0),
    flags: Any = None,
    **options: Any,
) -> Simulation:
    """A simulation with gimp unless said; ``flags`` is a dict of options of the method."""
    interpolator = Gimp() if interpolator is None else interpolator  # records without fields are false
    extra_nodes = not isinstance(interpolator, (Linear, LinearAxisymmetric))
    conditions = BoundaryConditions(regions, grid, len(bodies), extra_nodes)
    return Simulation(grid, bodies, interpolator, Flags(**(flags or {})), gravity, conditions, **options)


def whole_side(
    face: str, label: str, kind: str, value: float | tuple[float, float, float] = 0.0, material: int = -1
) -> Region:
    """One condition on a whole face."""
    vector = value if isinstance(value, tuple) else (value, value, value)
    return Region(face, (Condition(label, kind, material, vector),))


def advance(simulation: Simulation, dt: float, steps: int) -> None:
    """Make equal steps."""
    for _ in range(steps):
        simulation.advance(dt)
