"""Bodies that are deformed as a file says (``UsePrescribedDeformation``), to see what a material answers.

Each row of the file is a time, the nine components of a deformation gradient F (row by row), an angle in
degrees and an axis. Between rows F is interpolated, and the body is turned about the axis of the later row by
the part of its angle that has passed. Rotations add up: with Q_s for the whole turn of row s, in the interval
after row s the total deformation gradient at time t is

    F*(t) = Q(t) Q_s ... Q_1 Q_0 F(t).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.geometry.read_table import read_table
from solver.nodal import NodalFields

Array = NDArray[Any]

COLUMNS = 14
"""Numbers in a row of the file."""

ROUNDING = 1.0e-9
"""Part of an interval of the file within which a time counts as that of a row."""


@dataclass(frozen=True)
class PrescribedDeformation:
    """A history of deformation about the origin of coordinates, where nothing moves.

    Before the first row and after the last, F and the angle go on as in the nearest interval.

    Attributes
    ----------
    times : (k,) times of the rows, increasing, k >= 2.
    deformation_gradients : (k, 3, 3) F at the rows.
    angles : (k,) turn in radians during the interval before each row.
    axes : (k, 3) unit vector that each turn is about, or zero where there is no turn.
    exact : whether each step brings the material exactly to F* at its end (``exactDeformation``), with steps
        that end on the rows. Otherwise the velocity gradient at the start of a step is held through the step.
    """

    times: Array
    deformation_gradients: Array
    angles: Array
    axes: Array
    exact: bool = False

    def deformation_gradient(self, time: float) -> Array:
        """F* at a time, (3, 3), all turns included."""
        s, part, _ = self._interval(time)
        F = (1.0 - part) * self.deformation_gradients[s] + part * self.deformation_gradients[s + 1]
        turn = rotation_about(self.axes[s + 1], part * self.angles[s + 1])
        result: Array = turn @ self._earlier_turns[s] @ F
        return result

    def velocity_gradient(self, time: float) -> Array:
        """The rate of F* times its inverse at a time, (3, 3), in 1/s."""
        s, part, length = self._interval(time)
        low, high = self.deformation_gradients[s], self.deformation_gradients[s + 1]
        axis, angle = self.axes[s + 1], self.angles[s + 1]
        F, rate = (1.0 - part) * low + part * high, (high - low) / length
        Q, earlier = rotation_about(axis, part * angle), self._earlier_turns[s]
        spin = angle / length * _cross_matrix(axis)
        turned = Q @ earlier
        result: Array = spin + turned @ rate @ np.linalg.inv(F) @ turned.T
        return result

    def mean_velocity_gradient(self, time: float, dt: float) -> Array:
        """The velocity gradient (3, 3) that a step must have so that (I + dt L) F*(time) = F*(time + dt)."""
        increment = self.deformation_gradient(time + dt) @ np.linalg.inv(self.deformation_gradient(time))
        result: Array = (increment - np.eye(3)) / dt
        return result

    def impose(self, nodal: NodalFields, nodes: Array, time: float, dt: float) -> None:
        """Set the velocities v* = L x of all materials at the nodes, without acceleration.

        Uintah's exact update leaves out the turns during and before the step; here it includes them. Without
        turns the two agree.

        Parameters
        ----------
        nodal : the nodal fields, whose ``velocity_star`` and ``acceleration`` are set.
        nodes : (N, 3) positions of the nodes.
        time : time at the start of the step.
        dt : the time step.
        """
        L = self.mean_velocity_gradient(time, dt) if self.exact else self.velocity_gradient(time)
        nodal.velocity_star[:] = nodes @ L.T
        nodal.acceleration[:] = 0.0

    def time_step(self, time: float) -> float:
        """The step from a time to the next row, which ``exact`` asks for; inf after the last row."""
        gaps = np.diff(self.times, append=np.inf)
        passed = int(np.searchsorted(self.times, time, side="right"))
        if passed < len(self.times) and self.times[passed] - time <= ROUNDING * gaps[max(passed - 1, 0)]:
            passed += 1
        return float(self.times[passed] - time) if passed < len(self.times) else float("inf")

    def _interval(self, time: float) -> tuple[int, float, float]:
        """The row before a time, the part of the interval that has passed, and the interval's length.

        A row's own time belongs to the interval before it, as in Uintah.
        """
        s = int(np.clip(np.searchsorted(self.times, time) - 1, 0, len(self.times) - 2))
        length = self.times[s + 1] - self.times[s]
        return s, float((time - self.times[s]) / length), float(length)

    @cached_property
    def _earlier_turns(self) -> Array:
        """(k, 3, 3) the products Q_s ... Q_0 of the turns up to each row s."""
        products = np.empty((len(self.times), 3, 3))
        total = np.eye(3)
        for s in range(len(self.times)):
            total = rotation_about(self.axes[s], self.angles[s]) @ total
            products[s] = total
        return products


def rotation_about(axis: Array, angle: float) -> Array:
    """The rotation (3, 3) by an angle in radians about a unit vector, by Rodrigues' formula."""
    if angle == 0.0:
        return np.eye(3)
    along = np.outer(axis, axis)
    result: Array = (np.eye(3) - along) * np.cos(angle) + _cross_matrix(axis) * np.sin(angle) + along
    return result


def _cross_matrix(axis: Array) -> Array:
    """The matrix W with W x = axis x x."""
    a, b, c = axis
    return np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])


def read_prescribed_deformation(file: Path, exact: bool = False) -> PrescribedDeformation:
    """Read a file of rows ``time F11 F12 F13 F21 ... F33 angle axis_x axis_y axis_z``.

    Axes are made unit vectors (Uintah takes them as they are, and with others does not rotate).

    Raises
    ------
    ValueError
        Naming file and line: a row is not 14 numbers, there is only one, times do not increase, F turns
        matter inside out, or a turn has no axis.
    OSError
        The file cannot be read.
    """
    table = read_table(file, COLUMNS)
    times, F = table[:, 0], table[:, 1:10].reshape(-1, 3, 3)
    angles, axes = np.radians(table[:, 10]), table[:, 11:14]
    lengths = np.linalg.norm(axes, axis=1)
    _require(file, np.diff(times, prepend=-np.inf) > 0.0, "the times of the rows must increase")
    _require(file, np.linalg.det(F) > 0.0, "the determinant of F must be positive")
    _require(file, (angles == 0.0) | (lengths > 0.0), "a turn needs an axis other than 0 0 0")
    if len(times) < 2:
        raise ValueError(f"{file}: a prescribed deformation needs at least two rows, a start and an end")
    units = axes / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    return PrescribedDeformation(times, F, angles, units, exact)


def _require(file: Path, holds: Array, rule: str) -> None:
    """Raise ValueError if some rows break a rule (k,), naming the line of the first."""
    if holds.all():
        return
    filled = [(n, line) for n, line in enumerate(file.read_text().splitlines(), 1) if line.strip()]
    number, line = filled[int(np.argmin(holds))]
    raise ValueError(f"{file}:{number}: {rule}, found {line.strip()[:60]!r}")
