"""Particles that wait aside and are put into place at given times (``InsertParticles``).

Each row of the file is a time, a color, a displacement and a velocity: all particles of that color are moved
by the displacement, and given the velocity, at the end of the step in which the time falls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.geometry.read_table import read_table
from solver.particles import Particles

Array = NDArray[Any]

COLUMNS = 8
"""Numbers in a row of the file."""


@dataclass(frozen=True)
class Insertions:
    """When particles of which color are moved where, and how fast they then are.

    Attributes
    ----------
    times : (k,) times, in any order.
    colors : (k,) colors; the particles moved are those of exactly this ``color``.
    displacements : (k, 3) what is added to their positions.
    velocities : (k, 3) their new velocities.
    """

    times: Array
    colors: Array
    displacements: Array
    velocities: Array

    def apply(self, materials: Sequence[Particles], time: float, dt: float) -> int:
        """Move the particles of all materials whose time is in ``time <= t < time + dt``; gives their number.

        To be called at the end of the step from ``time`` to ``time + dt``, when positions and velocities are
        those of its end. Rows of the same step act one after the other. ``p.displacement`` stays: it is the
        deformation's, as in Uintah.
        """
        moved = 0
        for row in np.flatnonzero((time <= self.times) & (self.times < time + dt)):
            for particles in materials:
                chosen = particles.color == self.colors[row]
                particles.position[chosen] += self.displacements[row]
                particles.velocity[chosen] = self.velocities[row]
                moved += int(np.count_nonzero(chosen))
        return moved


def read_insertions(file: Path) -> Insertions:
    """Read a file of rows ``time color dx dy dz vx vy vz``.

    Raises
    ------
    ValueError : a row is not eight numbers, or there is none; names file and line.
    OSError : the file cannot be read.
    """
    table = read_table(file, COLUMNS)
    return Insertions(table[:, 0], table[:, 1], table[:, 2:5], table[:, 5:8])
