"""The loop over time steps, and the observers that write, watch and report it.

The loop knows of no observer in particular: output, histories, checkpoints, progress and the handling of
Ctrl-C each see the same calls and may ask the run to stop.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from solver.time_control import TimeControl

if TYPE_CHECKING:
    from solver.simulation import Simulation


class Observer:
    """Something that watches a run; each method is a moment of it and does nothing by default."""

    def begin(self, run: Run) -> None:
        """Before the first step."""

    def before_step(self, run: Run, dt: float) -> None:
        """Before a step of ``dt``; called again when the step has to be repeated with a smaller one."""

    def after_step(self, run: Run) -> None:
        """After each step; ``run.is_last`` says whether another follows."""

    def end(self, run: Run) -> None:
        """After the last step, also where the run was stopped or failed."""

    def end_of_step(self) -> float:
        """The time on which a step should end where the deck says ``clamp_time_to_output``; inf for none."""
        return math.inf


@dataclass
class Run:
    """A simulation on its way through time.

    Attributes
    ----------
    simulation : what moves.
    control : the deck's limits of time and time step.
    observers : in the order in which they are called.
    dt : size of the last step, 0 before the first.
    stable_dt : stable step that the solver found last.
    next_dt : size of the next step; found from the stable step where it is 0 at the start.
    is_last : whether the run ends with the step that is being made or was made last.
    stop_reason : why somebody asked the run to end after the present step, or nothing.
    failed : whether an exception ended it.
    title : title of the deck.
    materials : what the materials are, each in a word or two.
    directory : the archive that is written.
    particles : how many there are at the start, on all ranks.
    first_seconds : wall time at the end of the first step, in which kernels may have been compiled or loaded.
    """

    simulation: Simulation
    control: TimeControl
    observers: Sequence[Observer] = ()
    dt: float = 0.0
    next_dt: float = 0.0
    stable_dt: float = 0.0
    is_last: bool = False
    stop_reason: str = ""
    failed: bool = False
    title: str = ""
    materials: Sequence[str] = ()
    directory: Path | None = None
    particles: int = 0
    first_seconds: float = 0.0
    first_step: int = field(init=False)
    _started: float = field(default_factory=time.perf_counter)
    _asked_to_stop: str = ""
    _agreed_time: float = 0.0

    def __post_init__(self) -> None:
        self.first_step = self.simulation.step_number
        self._ranks = self.simulation.exchange.communicator

    @property
    def wall_time(self) -> float:
        """Seconds since the run was made; of several ranks, those on which they agreed after the last step."""
        return time.perf_counter() - self._started if self._ranks.size == 1 else self._agreed_time

    @property
    def steps_done(self) -> int:
        """Steps made by this run, those before a restart not counted."""
        return self.simulation.step_number - self.first_step

    def stop(self, reason: str) -> None:
        """Ask the run to end after the present step, or after the next where other ranks have to hear of it."""
        self._asked_to_stop = self._asked_to_stop or reason
        if self._ranks.size == 1:
            self.stop_reason = self._asked_to_stop

    def _agree(self) -> None:
        """Let all ranks know the time, and whether one of them was asked to stop: they all do the same then."""
        if self._ranks.size == 1:
            return
        own = [time.perf_counter() - self._started, bool(self._asked_to_stop)]
        self._agreed_time, asked = self._ranks.largest(np.array(own)).tolist()
        if asked and not self.stop_reason:
            reasons = self._ranks.allgather(self._asked_to_stop)
            self.stop_reason = next(reason for reason in reasons if reason)

    def go(self) -> None:
        """Make steps until the deck or somebody else says that it is enough.

        Raises
        ------
        solver.simulation.DivergedError
            when a value is no longer a finite number.
        StepError
            when the time step is no positive number, or would have to be less than the deck allows.
        ups.archive.ArchiveError
            when an observer cannot write.
        """
        self._agree()
        if self.next_dt == 0.0:
            self._find_next_dt(self.simulation.initial_time_step())
        self.is_last = not self._goes_on(self.simulation.time, self.simulation.step_number, self.wall_time)
        try:
            for observer in self.observers:
                observer.begin(self)
            while not self.is_last and not self.stop_reason:
                self._step()
        except BaseException:
            self.failed = True
            raise
        finally:
            for observer in self.observers:
                observer.end(self)

    def _step(self) -> None:
        dt, stable = self._advance(self.next_dt)
        self.dt = dt
        self._find_next_dt(stable)
        for observer in self.observers:
            observer.after_step(self)
        self._agree()
        if self.steps_done == 1:
            self.first_seconds = self.wall_time

    def _advance(self, dt: float) -> tuple[float, float]:
        """Make a step, of a tenth of dt as often as nodes are too fast; its size, and the stable next."""
        from solver.simulation import NodesTooFastError

        while True:
            if not 0.0 < dt < math.inf:
                raise StepError(f"step {self.simulation.step_number + 1}: the time step is {dt:g}")
            self.is_last = self._ends_with(dt)
            for observer in self.observers:
                observer.before_step(self, dt)
            try:
                return dt, self.simulation.advance(dt)
            except NodesTooFastError as problem:
                dt *= 0.1
                if dt < self.control.delt_min:
                    raise StepError(f"{problem}, and a tenth of it is less than <delt_min>") from None

    def _find_next_dt(self, stable: float) -> None:
        end = min((observer.end_of_step() for observer in self.observers), default=math.inf)
        self.stable_dt = stable
        self.next_dt = self.control.limit(stable, self.simulation.time, self.dt, end)

    def _ends_with(self, dt: float) -> bool:
        """Whether no step follows the coming one, which may cost half more than the mean in seconds."""
        cost = 1.5 * self.wall_time / self.steps_done if self.steps_done else 0.0
        simulation = self.simulation
        return not self._goes_on(simulation.time + dt, simulation.step_number + 1, self.wall_time + cost)

    def _goes_on(self, time: float, step: int, wall_time: float) -> bool:
        return self.control.goes_on(time, step, wall_time)


class StepError(RuntimeError):
    """There is no time step to go on with: it is not a positive number, or less than ``<delt_min>``."""
