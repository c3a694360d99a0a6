"""The picture of a run while it goes on: ``ups run --live``.

Another process draws it from the archive, which can be read while it is written, so that the run is neither
held up nor changed: a window that follows where there is a display, else a picture file, replaced as a whole.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from ups.archive import Archive, ArchiveError
from ups.run import Observer, Run

if TYPE_CHECKING:
    from ups.deck import Deck

_SECONDS_TO_FINISH = 60.0
"""How long the end of a run waits for the last picture."""


_LONGEST_PAUSE = 10.0
"""Seconds after a picture before the next."""


class Live(Observer):
    """Has a variable drawn at each output.

    Parameters
    ----------
    variable
        Label, perhaps with a measure; None for what is usually looked at first.
    window
        Whether to open a window; else it is a picture beside the archive, of its name with ``.png`` behind.
    stream
        Where to say what is shown, the standard error by default; None says nothing but troubles.
    """

    def __init__(self, variable: str | None, *, window: bool, stream: TextIO | None = None) -> None:
        self._variable = variable
        self._window = window
        self._stream = stream
        self._artist: subprocess.Popen[bytes] | None = None
        self._contents = Path()
        self._written = 0

    def begin(self, run: Run) -> None:
        """Start the process that draws."""
        if run.directory is None:
            return
        self._contents = run.directory / "index.xml"
        how = "window" if self._window else "file"
        command = [sys.executable, "-P", "-m", __name__, how, str(run.directory), self._variable or ""]
        self._artist = subprocess.Popen(
            command,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            start_new_session=True,  # Ctrl-C is for the run, and a window stays when the run has ended
        )
        assert self._artist.stdin is not None  # as a pipe was asked for
        os.set_blocking(self._artist.stdin.fileno(), False)
        if self._stream is not None and not self._window:
            print(f"live picture: {picture_of(run.directory)}", file=self._stream, flush=True)
        self._tell()

    def after_step(self, run: Run) -> None:
        """Tell the process of a new time step in the archive."""
        if self._artist is not None:
            self._tell()

    def end(self, run: Run) -> None:
        """Let the process finish the last picture; a window stays."""
        if self._artist is None:
            return
        assert self._artist.stdin is not None
        with contextlib.suppress(OSError):
            self._artist.stdin.close()
        if self._window:
            return
        try:
            self._artist.wait(_SECONDS_TO_FINISH)
        except subprocess.TimeoutExpired:
            self._artist.kill()
            print(f"the last live picture took more than {_SECONDS_TO_FINISH:g} s", file=sys.stderr)

    def _tell(self) -> None:
        """Write a line where the table of contents has changed since."""
        try:
            written = self._contents.stat().st_mtime_ns
        except OSError:
            return
        if written == self._written or self._artist is None or self._artist.stdin is None:
            return
        self._written = written
        try:
            os.write(self._artist.stdin.fileno(), b"\n")
        except BlockingIOError:
            pass  # it has not read the lines before, and will see this step, too
        except OSError:
            self._artist = None  # it has ended, and said why


def picture_of(directory: Path) -> Path:
    """Where the live picture of an archive is: beside it."""
    return directory.with_name(f"{directory.name}.png")


def check_variable(deck: Deck, variable: str | None) -> None:
    """Make sure that a deck saves a variable in a form that can be drawn.

    Raises
    ------
    ArchiveError
        Where it does not; the advice lists what it saves.
    """
    from ups.archive.measures import find
    from ups.diagnostics import Diagnostics
    from ups.output import plan_output

    plan = plan_output(deck.require(), deck.reader.place, Diagnostics())
    saved = {quantity.variable.name: quantity.variable for quantity in plan.fields}
    if not saved:
        raise ArchiveError(deck.path, "the deck saves no variable that a live picture could show")
    try:
        if variable:
            find(variable, saved)
    except LookupError as problem:
        advice = f"the deck saves: {', '.join(saved)}"
        raise ArchiveError(deck.path, f"--live: {problem}", advice=advice) from None


def draw_at_each(lines: Iterable[object], directory: Path, variable: str | None) -> None:
    """Draw the last time step whenever a line comes and there is a new one, and once more after the last.

    Raises
    ------
    ArchiveError
        Where the variable cannot be drawn, or the picture cannot be written.
    """
    from ups.pictures.plot import plot

    drawn = None
    out = picture_of(directory)
    partial_file = out.with_name(f".{out.stem}.partial.png")
    for _line in lines:
        steps = Archive(directory).timesteps
        if not steps or steps[-1].step == drawn:
            continue
        drawn, began = steps[-1].step, time.monotonic()
        plot(directory, partial_file, variable, step=drawn)
        partial_file.replace(out)
        time.sleep(min(time.monotonic() - began, _LONGEST_PAUSE))  # half of a core is enough for pictures


def open_window(lines: Iterable[object], directory: Path, variable: str | None) -> None:
    """Open a window at the first time step; it then follows the archive by itself."""
    from ups.pictures import window
    from ups.pictures.viewer import Viewer

    for _line in lines:
        if Archive(directory).timesteps:
            make = partial(Viewer, directory, variable=variable)
            window.show(make, title=directory.name, frames_per_second=5.0)
            return


def _main(how: str, directory: str, variable: str) -> None:
    with contextlib.suppress(AttributeError, OSError):  # Windows has none
        os.nice(10)  # the run comes first
    draw = {"file": draw_at_each, "window": open_window}[how]
    try:
        draw(sys.stdin, Path(directory), variable or None)
    except ArchiveError as problem:
        sys.exit(f"no live picture: {problem}")
    except Exception as problem:  # of the graphics, which must not look like one of the run
        sys.exit(f"no live picture: {type(problem).__name__}: {problem}")


if __name__ == "__main__":
    _main(*sys.argv[1:])
