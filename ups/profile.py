"""Where the time of a run goes: what ``ups run --profile`` prints."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, TextIO

from ups.run import Observer, Run

if TYPE_CHECKING:
    from solver.performance.phases import PhaseClock
    from solver.performance.report import Report


class Profile(Observer):
    """Measures the phases of the steps, and makes a report of them when the run ends.

    The first step, in which kernels are compiled or loaded, is left out where others follow.

    Parameters
    ----------
    stream : where the table of the report is printed; nowhere by default.
    timer : seconds from some moment (see ``solver.performance.phases.PhaseClock``).

    Attributes
    ----------
    report : a ``solver.performance.report.Report``; None before the run has ended, or if it made no step.
    """

    def __init__(self, stream: TextIO | None = None, timer: Callable[[], float] = time.perf_counter) -> None:
        self.report: Report | None = None
        self._stream = stream
        self._timer = timer
        self._clock: PhaseClock | None = None
        self._steps = self._particle_steps = 0

    def begin(self, run: Run) -> None:
        """Give the simulation the clock."""
        from solver.performance.phases import PhaseClock

        self._clock = PhaseClock(self._timer)
        run.simulation.clock = self._clock

    def after_step(self, run: Run) -> None:
        """Count the particles of the step."""
        assert self._clock is not None
        if run.steps_done == 1 and not run.is_last:
            self._clock.restart()
            return
        self._steps += 1
        self._particle_steps += _particles(run)

    def end(self, run: Run) -> None:
        """Stop the clock, measure what the machine can do, and make the report."""
        if self._clock is None or not self._particle_steps:
            return
        from solver.performance.machine import Calibration
        from solver.performance.phases import Phase, no_clock
        from solver.performance.report import make_report
        from solver.performance.work import work_of_step

        self._clock(Phase.OUTSIDE)
        run.simulation.clock = no_clock
        particles = _particles(run)
        threads = run.simulation.team.size_for(particles)
        self.report = make_report(
            self._clock.seconds,
            work_of_step(run.simulation),
            Calibration(threads, self._timer).measure(),
            particles=particles,
            particle_steps=self._particle_steps,
            steps=self._steps,
            threads=threads,
        )
        if self._stream is not None:
            print(self.report.table(), file=self._stream, flush=True)


def _particles(run: Run) -> int:
    return sum(len(body.particles) for body in run.simulation.bodies)
