"""The phases of a time step, and a clock that a simulation tells when one begins."""

from __future__ import annotations

import time
from collections.abc import Callable
from enum import StrEnum


class Phase(StrEnum):
    """What a simulation is at."""

    OUTSIDE = "output"
    """Between two steps: archives, histories, checkpoints, progress, and the choice of the next step."""
    SORT = "sort"
    """Particles brought into the order of their cells, where they have mixed."""
    LOADS = "loads"
    """External loads on particles, and particles inserted."""
    TO_GRID = "particles to grid"
    GRID = "grid"
    """Everything at nodes but contact: normalisation, acceleration, conditions on faces, heat."""
    CONTACT = "contact"
    EXCHANGE = "exchange"
    """Waiting for nodes and particles of other ranks, where there are any."""
    TO_PARTICLES = "grid to particles"
    STRESS = "stress"
    SETTLE = "settle"
    """Particles that left, failed or are too light are sorted out; periodic ones wrap."""


Clock = Callable[[Phase], None]
"""Called with the phase that begins; the one before ends."""


def no_clock(phase: Phase) -> None:
    """Nobody wants to know."""


class PhaseClock:
    """Adds up the seconds of each phase.

    Parameters
    ----------
    timer : seconds from some moment; ``time.process_time`` does not count what other programs do meanwhile, but
        counts every thread.

    Attributes
    ----------
    seconds : phase -> seconds since the last :meth:`restart`.
    """

    def __init__(self, timer: Callable[[], float] = time.perf_counter) -> None:
        self.seconds = dict.fromkeys(Phase, 0.0)
        self._timer = timer
        self._phase = Phase.OUTSIDE
        self._since = timer()

    def __call__(self, phase: Phase) -> None:
        """A phase begins."""
        now = self._timer()
        self.seconds[self._phase] += now - self._since
        self._phase, self._since = phase, now

    def restart(self) -> None:
        """Forget the seconds until now."""
        self(self._phase)
        self.seconds = dict.fromkeys(Phase, 0.0)
