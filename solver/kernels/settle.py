"""The loops over particles before the first step and at the end of each."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.dispatch import inline
from solver.grid import GridIndex
from solver.jit import kernel
from solver.kernels.chunks import CHUNK
from solver.lanes import WIDTH, Eight, everywhere
from solver.materials.constitutive import DELETE
from solver.particles import Particles


class Space(NamedTuple):
    """Where particles may be."""

    grid: GridIndex
    cells: tuple[int, int, int]
    periodic: tuple[int, int, int]
    owned: Any
    """Marks the cells of patches, x fastest."""
    all_owned: bool
    """Whether these are all cells."""
    least_mass: float
    """A particle that is no heavier goes."""


@kernel
def settle(particles: Particles, space: Space, kept: Any, first: int, last: int, sums: Any) -> None:
    """Wrap periodic positions and mark in ``kept`` the particles that stay.

    A particle goes when it left every patch, failed for good, became too light or colder than absolute zero. Does
    the chunks ``first`` to ``last`` of particles, and stores how many of each do not stay at the beginning of its
    row of ``sums``.
    """
    for chunk in range(first, last):
        lost, end = 0, min((chunk + 1) * CHUNK, particles.mass.shape[0])
        for start in range(chunk * CHUNK, end, WIDTH):
            if space.all_owned and start + WIDTH <= end and all_inside(particles, space, start):
                kept[start : start + WIDTH] = True
                continue
            for p in range(start, min(start + WIDTH, end)):
                kept[p] = stays(particles, space, p)
                lost += not kept[p]
        sums[chunk, 0] = lost


@inline
def all_inside(particles: Particles, space: Space, start: int) -> bool:
    """Whether eight particles are sound and inside the grid, as nearly all are."""
    p: Any = Eight(start)
    sound = is_sound(particles, space, p)
    inside = is_inside(particles, space, p, 0) & is_inside(particles, space, p, 1)
    return everywhere(sound & inside & is_inside(particles, space, p, 2))


@inline
def is_inside(particles: Particles, space: Space, p: int, axis: int) -> bool:
    """Whether a particle lies between the faces across an axis."""
    q = (particles.position[p, axis] - space.grid.anchor[axis]) / space.grid.spacing[axis]
    return (q >= 0.0) & (q < 1.0 * space.cells[axis])


@inline
def is_sound(particles: Particles, space: Space, p: int) -> bool:
    """Whether a particle may stay wherever it is inside."""
    there = (particles.localized[p] != DELETE) & (particles.mass[p] > space.least_mass)
    return there & (particles.temperature[p] >= 0.0)


@inline
def stays(particles: Particles, space: Space, p: int) -> bool:
    """Wrap the position of a particle; whether it stays."""
    grid, cells, position = space.grid, space.cells, particles.position
    cell, stride = 0, 1
    for c in range(3):
        q = (position[p, c] - grid.anchor[c]) / grid.spacing[c]
        if space.periodic[c] and (q < 0.0 or q >= cells[c]):
            wraps = math.floor(q / cells[c])
            position[p, c] -= wraps * cells[c] * grid.spacing[c]
            q = (position[p, c] - grid.anchor[c]) / grid.spacing[c]
            if not 0.0 <= q < cells[c]:  # a rounding error beyond a face
                position[p, c] = grid.anchor[c]
                q = 0.0
        if not 0.0 <= q < cells[c]:
            return False
        cell += math.floor(q) * stride
        stride *= cells[c]
    return space.owned[cell] and is_sound(particles, space, p)


@kernel
def initial_wave_speed(velocity: Any, sound_speed: Any) -> tuple[float, float, float]:
    """Per direction the largest of sound speed plus particle speed at the start."""
    wx = wy = wz = 1.0e-12
    for p in range(sound_speed.shape[0]):
        wx = max(wx, sound_speed[p] + abs(velocity[p, 0]))
        wy = max(wy, sound_speed[p] + abs(velocity[p, 1]))
        wz = max(wz, sound_speed[p] + abs(velocity[p, 2]))
    return wx, wy, wz
