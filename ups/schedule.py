"""When something is to be written, by Uintah's rules."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ups.deck import Checkpoint, DataArchiver


@dataclass
class Schedule:
    """Times, steps or seconds of computing at which something is due.

    Attributes
    ----------
    interval, next_time : simulation time between, and of the next; an interval of 0 does not count.
    step_interval, next_step : the same in steps.
    wall_interval, next_wall : the same in seconds of computing.
    at_last : whether the last step is due whatever its time.
    """

    interval: float = 0.0
    step_interval: int = 0
    wall_interval: float = 0.0
    next_time: float = 0.0
    next_step: int = 1
    next_wall: float = 0.0
    at_last: bool = False

    @classmethod
    def of_output(cls, section: DataArchiver) -> Schedule:
        """Output: the first step (or the state at the start), then whenever an interval has passed."""
        return cls(
            interval=section.outputInterval or 0.0,
            step_interval=section.outputTimestepInterval or 0,
            next_step=0 if section.outputInitTimestep else 1,
            at_last=section.outputLastTimestep,
        )

    @classmethod
    def of_checkpoints(cls, section: Checkpoint | None) -> Schedule:
        """Checkpoints: whenever an interval has passed, the first one after a whole interval."""
        section = section or Checkpoint()
        return cls(
            interval=section.interval,
            step_interval=section.timestepInterval,
            wall_interval=section.walltimeIntervalHours * 3600.0 or section.walltimeInterval,
            next_time=section.interval,
            next_step=section.timestepInterval + 1,
            next_wall=section.walltimeStartHours * 3600.0 or section.walltimeStart,
            at_last=section.lastTimestep,
        )

    @property
    def is_active(self) -> bool:
        """Whether anything is ever due."""
        return self.interval > 0.0 or self.step_interval > 0 or self.wall_interval > 0.0

    def due(self, time: float, step: int, wall_time: float, last: bool) -> bool:
        """Whether the step of that number, which ends at ``time``, is due."""
        return (
            (self.interval > 0.0 and time >= self.next_time)
            or (self.step_interval > 0 and step >= self.next_step)
            or (self.wall_interval > 0.0 and wall_time >= self.next_wall)
            or (self.at_last and last)
        )

    def done(self, time: float, step: int, wall_time: float) -> None:
        """Find what is due next, after something was written; intervals that passed unused are skipped."""
        if self.interval > 0.0 and time >= self.next_time:
            passed = math.floor((time - self.next_time) / self.interval)
            self.next_time += passed * self.interval + self.interval
        if self.step_interval > 0 and step >= self.next_step:
            passed = (step - self.next_step) // self.step_interval
            self.next_step += (passed + 1) * self.step_interval
        if self.wall_interval > 0.0 and wall_time >= self.next_wall:
            passed = math.floor((wall_time - self.next_wall) / self.wall_interval)
            self.next_wall += (passed + 1) * self.wall_interval

    def end_of_step(self) -> float:
        """The time on which a step should end if ``clamp_time_to_output`` asks for that; inf for none."""
        return self.next_time if self.interval > 0.0 and self.next_time > 0.0 else math.inf
