"""What a person sees of a run: a first line, progress, and a last line; and what Ctrl-C does."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING, Any, TextIO

from ups.run import Observer, Run

if TYPE_CHECKING:
    from rich.progress import Progress as Bar
    from rich.progress import TaskID

SECONDS_BETWEEN_LINES = 5.0
SECONDS_BETWEEN_UPDATES = 0.1


class Progress(Observer):
    """Says what is run, how far it is, and how it ended: with a bar on a terminal, else with a line at times.

    Parameters
    ----------
    stream : where to; the standard output by default.
    """

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stdout
        self._bar: Bar | None = None
        self._task: TaskID | None = None
        self._shown = 0.0
        self._start: tuple[float, int, float] = (0.0, 0, 0.0)

    def begin(self, run: Run) -> None:
        """Print what is run."""
        self._say(describe(run))
        self._start = (run.wall_time, run.simulation.step_number, done_share(run))
        self._shown = time.monotonic()

    def after_step(self, run: Run) -> None:
        """Show progress, if enough time has passed."""
        if run.steps_done == 1:
            # The first step may have compiled kernels: speed is measured from its end.
            self._start = (run.wall_time, run.simulation.step_number, done_share(run))
        now = time.monotonic()
        on_terminal = self._stream.isatty()
        if now - self._shown < (SECONDS_BETWEEN_UPDATES if on_terminal else SECONDS_BETWEEN_LINES):
            return
        self._shown = now
        if on_terminal:
            self._update_bar(run)
        else:
            self._say(f"  {done_share(run):4.0%}  {self._figures(run)}")

    def end(self, run: Run) -> None:
        """Print what was done and where it is."""
        if self._bar is not None:
            self._bar.stop()
        self._say(summary(run))

    def _say(self, line: str) -> None:
        print(line, file=self._stream, flush=True)

    def _figures(self, run: Run) -> str:
        """Step, time, dt, steps/s and time to go."""
        simulation = run.simulation
        wall, step, share = self._start
        seconds, steps = run.wall_time - wall, simulation.step_number - step
        left = "?"
        gained = done_share(run) - share
        if gained > 0.0:
            left = clock(seconds * (1.0 - done_share(run)) / gained)
        rate = steps / seconds if seconds > 0.0 else 0.0
        return (
            f"step {simulation.step_number}  time {simulation.time:.4g}  dt {run.dt:.3g}  "
            f"{rate:.3g} steps/s  {left} to go"
        )

    def _update_bar(self, run: Run) -> None:
        if self._bar is None:
            from rich.console import Console
            from rich.progress import BarColumn, TextColumn
            from rich.progress import Progress as RichProgress

            columns = BarColumn(bar_width=24), TextColumn("{task.percentage:>3.0f}%  {task.description}")
            self._bar = RichProgress(*columns, console=Console(file=self._stream), transient=True)
            self._task = self._bar.add_task("", total=1.0)
            self._bar.start()
        assert self._task is not None
        self._bar.update(self._task, completed=done_share(run), description=self._figures(run))


def done_share(run: Run) -> float:
    """The part of the whole run that is done, 0 to 1, by time or by number of steps, whichever is further."""
    control, simulation = run.control, run.simulation
    span = control.maxTime - control.initTime
    share = (simulation.time - control.initTime) / span if span > 0.0 else 1.0
    if control.max_Timesteps:
        share = max(share, simulation.step_number / control.max_Timesteps)
    return min(max(share, 0.0), 1.0)


def describe(run: Run) -> str:
    """One line that says what is run."""
    simulation, control = run.simulation, run.control
    count = len(simulation.bodies)
    what = f"{count} material{'s' * (count > 1)} ({', '.join(run.materials)})"
    cells = " x ".join(str(n) for n in simulation.grid.cells)
    patches = len(simulation.grid.patches)
    ranks = simulation.exchange.communicator.size
    on_ranks = f" on {ranks} ranks" if ranks > 1 else ""
    steps = _steps_foreseen(run)
    ahead = f"about {steps} steps" if steps > 1 else "1 step"
    start = f"going on from step {simulation.step_number}" if simulation.step_number else "first"
    return (
        f"{run.title or 'run'}: {what}, {run.particles} particles, "
        f"{cells} cells, {patches} patch{'es' * (patches > 1)}{on_ranks}; {start} dt {run.next_dt:.4g}, {ahead} "
        f"to time {control.maxTime:g}"
    )


def _steps_foreseen(run: Run) -> int:
    """Steps to come, by the stable step, which delt_init may hold back at first."""
    simulation, control = run.simulation, run.control
    stable = run.stable_dt or run.next_dt / control.timestep_multiplier  # not known yet after a restart
    return control.foreseen_steps(stable, simulation.time, simulation.step_number)


def summary(run: Run) -> str:
    """One line that says what was done; the time of a step without the first, which may have compiled kernels."""
    steps, seconds, reached = run.steps_done, run.wall_time, run.simulation.time
    how = "failed" if run.failed else run.stop_reason or "done"
    later = 1e3 * (seconds - run.first_seconds) / max(1, steps - 1)
    each = f", {later:.3g} ms/step after the first" if steps > 1 else ""
    return (
        f"{how}: {steps} step{'s' * (steps != 1)} to time {reached:.6g} in {clock(seconds)}{each}; "
        f"archive {run.directory}"
    )


def clock(seconds: float) -> str:
    """A duration as a person says it."""
    if seconds < 60.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s"


class Interrupts(Observer):
    """On the first SIGINT or SIGTERM the step is finished and a checkpoint written; a second ends at once.

    Attributes
    ----------
    received : the signal's number, 0 for none.
    """

    def __init__(self, stream: TextIO | None = None) -> None:
        self.received = 0
        self._stream = stream or sys.stderr
        self._before: dict[int, Any] = {}

    def begin(self, run: Run) -> None:
        """Watch for signals."""

        def handle(number: int, frame: FrameType | None) -> None:
            self.received = number
            run.stop("interrupted")
            self._release()
            if run.simulation.exchange.communicator.rank == 0:
                print("finishing the step, then writing a checkpoint ...", file=self._stream, flush=True)

        for number in (signal.SIGINT, signal.SIGTERM):
            self._before[number] = signal.signal(number, handle)

    def end(self, run: Run) -> None:
        """Watch no longer."""
        self._release()

    def _release(self) -> None:
        while self._before:
            signal.signal(*self._before.popitem())


@contextmanager
def compilation_notice(stream: TextIO | None = None) -> Iterator[None]:
    """Say so while kernels are compiled, as happens when a deck uses models that were never run together."""
    import solver.jit  # noqa: F401 - first, as it imports numba without what only compiling needs

    # isort: split
    from numba.core.event import Event, Listener, install_listener

    class Notice(Listener):
        depth = kernels = 0
        started = shown = 0.0

        def on_start(self, event: Event) -> None:
            self.depth += 1
            if self.depth > 1:
                return
            now = time.monotonic()
            if not self.kernels:
                self.started = self.shown = now
                print(
                    "compiling kernels (first run of these models on this machine) ...", file=out, flush=True
                )
            self.kernels += 1
            if now - self.shown > SECONDS_BETWEEN_LINES:
                self.shown = now
                name = event.data["dispatcher"].__name__
                print(f"  {self.kernels} kernels, now {name}", file=out, flush=True)

        def on_end(self, event: Event) -> None:
            self.depth -= 1

    out = stream or sys.stdout
    notice = Notice()
    with install_listener("numba:compile", notice):
        yield
    if notice.kernels:
        print(f"compiled {notice.kernels} kernels, kept for the next run", file=out, flush=True)
