"""The outcome of a run, for notebooks: the archive with its variables by name."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from ups.archive import Archive

Array = NDArray[Any]


class Series(Sequence[Array]):
    """A variable on particles or nodes at every stored time step; each is read when it is asked for.

    Particles are those of all materials that have the variable, in the order of the materials; nodal
    variables are of one material and indexed [x, y, z, component...].

    Attributes
    ----------
    label : Uintah's label.
    material : index of the material, or None for all.
    """

    def __init__(self, archive: Archive, label: str, material: int | None) -> None:
        self.label = label
        self.material = material
        self._archive = archive
        self._steps = [t for t in archive.timesteps if label in archive.labels(t.step)]

    @property
    def times(self) -> Array:
        """Times of the stored steps, shape (len(self),)."""
        return np.array([t.time for t in self._steps])

    @property
    def steps(self) -> Array:
        """Numbers of the stored steps, shape (len(self),)."""
        return np.array([t.step for t in self._steps], dtype=np.int64)

    def __len__(self) -> int:
        return len(self._steps)

    @overload
    def __getitem__(self, index: int) -> Array: ...

    @overload
    def __getitem__(self, index: slice) -> list[Array]: ...

    def __getitem__(self, index: int | slice) -> Array | list[Array]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        step = self._steps[index].step
        if self._archive.variables[self.label].is_particle:
            return self._archive.particles(step, self.label, self.material)
        return self._archive.grid_variable(step, self.label, self.material or 0).values


class Result:
    """What a run left: ``result["p.stress"][-1]`` are the stresses at the last stored time step.

    Attributes
    ----------
    directory : the archive.
    steps : number of the last step.
    time : time at its end.
    wall_time : seconds that the run took.
    stop_reason : why it ended early, or nothing.
    """

    def __init__(
        self, directory: Path, steps: int, time: float, wall_time: float, stop_reason: str = ""
    ) -> None:
        self.directory = directory
        self.steps = steps
        self.time = time
        self.wall_time = wall_time
        self.stop_reason = stop_reason
        self._archive: Archive | None = None

    @property
    def archive(self) -> Archive:
        """The archive, opened when first asked for."""
        if self._archive is None:
            self._archive = Archive(self.directory)
        return self._archive

    def __getitem__(self, label: str) -> Series | Array:
        """A saved variable as a series over the stored time steps, or the history of a sum, a value a step.

        Raises
        ------
        KeyError : nothing of this name was saved; the message lists what was.
        """
        if label in self.archive.variables:
            return Series(self.archive, label, None)
        return self.history(label)[1]

    def series(self, label: str, material: int) -> Series:
        """A saved variable of one material."""
        return Series(self.archive, label, material)

    def history(self, name: str) -> tuple[Array, Array]:
        """Times and values of a sum such as ``KineticEnergy``, or ``KineticEnergy_1`` for that of material 1.

        Raises
        ------
        KeyError : nothing of this name was saved; the message lists what was.
        """
        if name not in self.archive.reductions:
            there = ", ".join([*self.archive.variables, *self.archive.reductions])
            raise KeyError(f"{name} was not saved; there are: {there}")
        found = self.archive.reductions[name]
        return found.times, found.values

    def __repr__(self) -> str:
        return f"Result({str(self.directory)!r}, {self.steps} steps to time {self.time:g})"
