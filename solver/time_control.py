"""How long the run goes on and how large each step may be: the deck's ``<Time>`` section."""

import math
from dataclasses import dataclass
from typing import Annotated

from solver.declare import Parameter


@dataclass(frozen=True)
class TimeControl:
    """Limits of time and time step, applied in Uintah's order."""

    maxTime: Annotated[float, Parameter("time at which the run ends", unit="s", ge=0.0)]
    delt_min: Annotated[float, Parameter("smallest time step", unit="s", ge=0.0)]
    delt_max: Annotated[float, Parameter("largest time step", unit="s", gt=0.0)]
    timestep_multiplier: Annotated[float, Parameter("factor on the stable time step", gt=0.0)]
    initTime: Annotated[float, Parameter("time at the start", unit="s")] = 0.0
    max_Timesteps: Annotated[
        int,
        Parameter(
            "number of steps after which the run ends, 0 for no limit", ge=0, old_tags=("max_iterations",)
        ),
    ] = 0
    delt_init: Annotated[float, Parameter("largest first time step", unit="s", gt=0.0)] = math.inf
    initial_delt_range: Annotated[
        float, Parameter("time until which delt_init limits the step", unit="s", ge=0.0)
    ] = 0.0
    max_delt_increase: Annotated[
        float, Parameter("largest growth of the step from one to the next, as a fraction", ge=0.0)
    ] = math.inf
    override_restart_delt: Annotated[
        float, Parameter("first time step after a restart", unit="s", ge=0.0)
    ] = 0.0
    clamp_time_to_output: Annotated[bool, Parameter("end steps on the times of output")] = False
    end_at_max_time_exactly: Annotated[bool, Parameter("end the last step at maxTime")] = False
    max_wall_time: Annotated[float, Parameter("seconds of computing after which the run ends", ge=0.0)] = 0.0

    def limit(self, stable: float, time: float, previous: float, next_output: float) -> float:
        """The next time step.

        Parameters
        ----------
        stable : stable step that the solver found.
        time : time at the start of the step.
        previous : the step before, 0 at the start.
        next_output : time of the next output or checkpoint (inf for none).
        """
        dt = stable * self.timestep_multiplier
        if previous > 0.0 and self.max_delt_increase > 0.0:
            dt = min(dt, (1.0 + self.max_delt_increase) * previous)
        dt = max(dt, self.delt_min)
        dt = min(dt, self.delt_max)
        if time <= self.initial_delt_range:
            dt = min(dt, self.delt_init)
        if self.clamp_time_to_output and time + dt > next_output > time:
            dt = next_output - time
        if self.end_at_max_time_exactly and time + dt > self.maxTime:
            dt = self.maxTime - time
        return dt

    def goes_on(self, time: float, step: int, wall_time: float) -> bool:
        """Whether another step is to be done."""
        if self.max_Timesteps > 0 and step >= self.max_Timesteps:
            return False
        if self.max_wall_time > 0.0 and wall_time >= self.max_wall_time:
            return False
        return time < self.maxTime

    def usual_step(self, stable: float) -> float:
        """The step after the first ones, where ``stable`` is the stable step."""
        return min(max(stable * self.timestep_multiplier, self.delt_min), self.delt_max)

    def foreseen_steps(self, stable: float, time: float, done: int = 0) -> int:
        """A guess at the number of steps from a time on, after ``done`` steps, if the stable step stays."""
        guess = max(math.ceil((self.maxTime - time) / self.usual_step(stable)), 0)
        return min(guess, max(self.max_Timesteps - done, 0)) if self.max_Timesteps else guess
