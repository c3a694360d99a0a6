"""Measuring the steps of one deck: phases and the machine's limits in turn, medians of both."""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from solver.performance.machine import Calibration, Machine
from solver.performance.phases import Phase, PhaseClock
from solver.performance.report import Report, make_report
from solver.performance.work import Work, work_of_step
from ups.deck import Deck
from ups.run import Observer, Run
from ups.session import run_deck

WARM_UP = 2
"""Steps that are not measured: kernels are loaded, and caches and pages met for the first time."""

STEPS_BETWEEN_CALIBRATIONS = 4


def timer_for(threads: int) -> Callable[[], float]:
    """Seconds of this process where one thread works, so that other programs do not count; of the wall else."""
    return time.process_time if threads == 1 else time.perf_counter


class Sampler(Observer):
    """Notes the seconds of each phase of each step, and measures the machine between steps.

    Attributes
    ----------
    samples : seconds by phase, a step each.
    machines : the measurements of the machine.
    work : of the last step.
    particles : moved in it.
    """

    def __init__(self, threads: int) -> None:
        self._timer = timer_for(threads)
        self._calibration = Calibration(threads, self._timer)
        self.samples: list[dict[Phase, float]] = []
        self.machines: list[Machine] = []
        self.work: dict[Phase, Work] = {}
        self.particles = 0

    def begin(self, run: Run) -> None:
        """Give the simulation a clock."""
        self._clock = PhaseClock(self._timer)
        run.simulation.clock = self._clock

    def after_step(self, run: Run) -> None:
        """Take a sample."""
        self._clock(Phase.OUTSIDE)
        if run.steps_done > WARM_UP:
            self.samples.append(self._clock.seconds)
            if len(self.samples) % STEPS_BETWEEN_CALIBRATIONS == 1:
                self.machines.append(self._calibration.measure(3))
        self._clock.restart()

    def end(self, run: Run) -> None:
        """Count the work of a step."""
        self.particles = sum(len(body.particles) for body in run.simulation.bodies)
        self.work = work_of_step(run.simulation)


def measure(deck: Deck, *, steps: int, threads: int) -> Report:
    """Run some steps of a deck and report the medians of their phases, and those of the machine's limits.

    Raises
    ------
    ups.diagnostics.DeckError
        where the deck cannot be run.
    """
    sampler = Sampler(threads)
    with tempfile.TemporaryDirectory() as folder:
        run_deck(
            deck,
            output=Path(folder) / "benchmark.uda",
            max_steps=WARM_UP + steps,
            threads=threads,
            observers=[sampler],
        )
    taken = len(sampler.samples)
    return make_report(
        {phase: statistics.median(s[phase] for s in sampler.samples) * taken for phase in Phase},
        sampler.work,
        Machine(*map(statistics.median, zip(*sampler.machines, strict=True))),
        particles=sampler.particles,
        particle_steps=sampler.particles * taken,
        steps=taken,
        threads=threads,
    )
