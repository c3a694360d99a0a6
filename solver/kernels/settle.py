"""The loops over particles before the first step and at the end of each."""

from __future__ import annotations

import math
from typing import Any

from solver.grid import GridIndex
from solver.jit import kernel
from solver.kernels.chunks import CHUNK
from solver.materials.constitutive import DELETE
from solver.particles import Particles


@kernel
def settle(
    particles: Particles,
    grid: GridIndex,
    cells: tuple[int, int, int],
    periodic: tuple[int, int, int],
    owned: Any,
    least_mass: float,
    kept: Any,
    first: int,
    last: int,
    sums: Any,
) -> None:
    """Wrap periodic positions and mark in ``kept`` the particles that stay.

    A particle goes when it left every patch (``owned`` marks their cells, x fastest), failed for good, became too
    light or colder than absolute zero. Does the chunks ``first`` to ``last`` of particles, and stores how many of
    each do not stay at the beginning of its row of ``sums``.
    """
    for chunk in range(first, last):
        lost = 0
        for p in range(chunk * CHUNK, min((chunk + 1) * CHUNK, particles.mass.shape[0])):
            cell, stride, inside = 0, 1, True
            for c in range(3):
                q = (particles.position[p, c] - grid.anchor[c]) / grid.spacing[c]
                if periodic[c] and (q < 0.0 or q >= cells[c]):
                    wraps = math.floor(q / cells[c])
                    particles.position[p, c] -= wraps * cells[c] * grid.spacing[c]
                    q = (particles.position[p, c] - grid.anchor[c]) / grid.spacing[c]
                    if not 0.0 <= q < cells[c]:  # a rounding error beyond a face
                        particles.position[p, c] = grid.anchor[c]
                        q = 0.0
                i = math.floor(q)
                if i < 0 or i >= cells[c]:
                    inside = False
                cell += i * stride
                stride *= cells[c]
            good = (
                inside
                and owned[cell]
                and particles.localized[p] != DELETE
                and particles.mass[p] > least_mass
                and particles.temperature[p] >= 0.0
            )
            kept[p] = good
            if not good:
                lost += 1
        sums[chunk, 0] = lost


@kernel
def initial_wave_speed(velocity: Any, sound_speed: Any) -> tuple[float, float, float]:
    """Per direction the largest of sound speed plus particle speed at the start."""
    wx = wy = wz = 1.0e-12
    for p in range(sound_speed.shape[0]):
        wx = max(wx, sound_speed[p] + abs(velocity[p, 0]))
        wy = max(wy, sound_speed[p] + abs(velocity[p, 1]))
        wz = max(wz, sound_speed[p] + abs(velocity[p, 2]))
    return wx, wy, wz
