"""The table of phases: time, bytes, operations, and what share of the machine's limits that is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from solver.performance.machine import Machine
from solver.performance.phases import Phase
from solver.performance.work import Work

COLUMNS = (
    f"{'phase':18s}{'ns':>9s}{'share':>7s}{'bytes':>8s}{'GB/s':>7s}{'of memory':>11s}{'FLOP':>8s}{'GFLOP/s':>9s}"
    f"{'of peak':>9s}{'x roofline':>12s}"
)


@dataclass(frozen=True)
class PhaseReport:
    """A phase, per particle and step.

    Attributes
    ----------
    seconds : measured.
    bytes, operations : by the model of ``solver.performance.work``; None where it says nothing.
    bandwidth_share, flops_share : of the machine's limits.
    over_roofline : measured time over the longer of the times for bytes and for operations at the machine's limits.
    """

    phase: Phase
    seconds: float
    bytes: float | None = None
    operations: float | None = None
    bandwidth_share: float | None = None
    flops_share: float | None = None
    over_roofline: float | None = None


@dataclass(frozen=True)
class Report:
    """Where the time of a run's steps went.

    Attributes
    ----------
    particle_steps : particles moved, summed over the steps that were measured.
    steps : how many.
    seconds : in all.
    threads : shared the work.
    machine : its limits, measured with as many threads.
    phases : those that took any time.
    """

    particle_steps: int
    steps: int
    seconds: float
    threads: int
    machine: Machine
    phases: tuple[PhaseReport, ...]

    @property
    def rate(self) -> float:
        """Particle-steps a second."""
        return self.particle_steps / self.seconds

    def phase(self, phase: Phase) -> PhaseReport:
        """A phase; KeyError where it took no time."""
        return {row.phase: row for row in self.phases}[phase]

    def table(self) -> str:
        """The report for reading, one line a phase, numbers a particle and step."""
        total = self.seconds / self.particle_steps
        lines = [COLUMNS, *(_line(row, total) for row in self.phases)]
        lines.append(f"{'sum':18s}{1e9 * total:9.1f}")
        lines.append(
            f"{self.rate:.3g} particle-steps/s: {self.particle_steps / self.steps:.0f} particles, "
            f"{self.steps} steps, {self.threads} thread{'s' * (self.threads > 1)}"
        )
        lines.append(
            f"this machine: {1e-9 * self.machine.bandwidth:.3g} GB/s (triad), "
            f"{1e-9 * self.machine.flops:.3g} GFLOP/s (multiply-add)"
        )
        return "\n".join(lines)


def make_report(
    seconds: Mapping[Phase, float],
    work: Mapping[Phase, Work],
    machine: Machine,
    *,
    particles: int,
    particle_steps: int,
    steps: int,
    threads: int,
) -> Report:
    """Put measured seconds and the work of one step of ``particles`` together."""
    rows = []
    for phase in Phase:
        if not seconds[phase]:
            continue
        each = seconds[phase] / particle_steps
        if phase in work and particles:
            rows.append(_row(phase, each, work[phase], particles, machine))
        else:
            rows.append(PhaseReport(phase, each))
    return Report(particle_steps, steps, sum(seconds.values()), threads, machine, tuple(rows))


def _row(phase: Phase, seconds: float, work: Work, particles: int, machine: Machine) -> PhaseReport:
    moved = work.bytes / particles
    ideal = moved / machine.bandwidth
    if work.operations is None:
        return PhaseReport(phase, seconds, moved, None, ideal / seconds, None, seconds / ideal)
    operations = work.operations / particles
    computing = operations / machine.flops
    return PhaseReport(
        phase,
        seconds,
        moved,
        operations,
        ideal / seconds,
        computing / seconds,
        seconds / max(ideal, computing),
    )


def _line(row: PhaseReport, total: float) -> str:
    line = f"{row.phase:18s}{1e9 * row.seconds:9.1f}{row.seconds / total:7.0%}"
    line += _cells(row.bytes, row.seconds, row.bandwidth_share, 8, 7, 11)
    line += _cells(row.operations, row.seconds, row.flops_share, 8, 9, 9)
    return line + (f"{row.over_roofline:12.1f}" if row.over_roofline is not None else f"{'-':>12s}")


def _cells(count: float | None, seconds: float, share: float | None, *widths: int) -> str:
    """A count, it in billions a second, and the share of the limit."""
    if count is None or share is None:
        return "".join(f"{'-':>{width}s}" for width in widths)
    return f"{count:{widths[0]}.0f}{1e-9 * count / seconds:{widths[1]}.1f}{share:{widths[2]}.0%}"
