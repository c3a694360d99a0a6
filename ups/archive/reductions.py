"""Histories of reduction variables: text files of one line a step, such as ``KineticEnergy.dat``."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ups.archive import checksums
from ups.archive.errors import ArchiveError
from ups.archive.variables import GLOBAL_MATERIAL, Variable


@dataclass(frozen=True)
class ReductionFormat:
    """Which steps get a line, and what the line says before the value.

    Attributes
    ----------
    frequency, on_timestep
        A step gets a line where ``step % frequency == on_timestep``; with a frequency of one, all do.
    step_column
        Whether the number of the step is written, right-aligned in ten columns.
    time_column
        Whether the time at the end of the step is written.
    """

    frequency: int = 1
    on_timestep: int = 0
    step_column: bool = False
    time_column: bool = True

    def due(self, step: int, last: bool) -> bool:
        """Whether a step gets a line; the last step of a run always does."""
        return last or self.frequency <= 1 or step % self.frequency == self.on_timestep

    def prefix(self, step: int, time: float) -> str:
        """Return what a line says before the value."""
        return (f"{step:10d}\t" if self.step_column else "") + (f"{time:.17g}\t" if self.time_column else "")


def filename(name: str, material: int) -> str:
    """Name of the file that holds the history of a variable of a material."""
    return f"{name}.dat" if material == GLOBAL_MATERIAL else f"{name}_{material}.dat"


def value_text(variable: Variable, value: object) -> str:
    """Write a value as Uintah prints it: 17 digits; a vector with blanks around, a matrix without."""
    if isinstance(value, float) and variable.element == "double":  # most of them, and one a step
        return f"{value:.17g}"
    element = variable.element_type
    components = variable.shaped(np.asarray(value), ()).ravel().tolist()
    text = " ".join([f"{c:.17g}" if element.dtype.kind == "f" else str(int(c)) for c in components])
    return f" {text} " if element.shape == (3,) else text


class ReductionFile:
    """A history that grows by a line at a time.

    Lines are kept in memory until `flush`; where the disk is full then, the file keeps its whole
    lines and no part of another.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._pending: list[str] = []
        try:
            self._checksum = checksums.crc32(path.read_bytes() if path.exists() else b"")
            self._file = path.open("ab", buffering=0)
            self._size = self._file.seek(0, os.SEEK_END)
        except OSError as error:
            raise ArchiveError.from_os_error(path, "open the history", error) from error

    @property
    def covered(self) -> tuple[int, int]:
        """Checksum and length of what is on the disk."""
        return self._checksum, self._size

    def append(self, line: str) -> None:
        """Add a line, given without its end."""
        self._pending.append(line + "\n")

    def flush(self) -> None:
        """Write what is pending.

        Raises
        ------
        ArchiveError
            Where it cannot be written; the lines then stay pending.
        """
        if not self._pending:
            return
        raw = "".join(self._pending).encode()
        try:
            rest = memoryview(raw)
            while rest:
                rest = rest[self._file.write(rest) :]
        except OSError as error:
            os.ftruncate(self._file.fileno(), self._size)
            raise ArchiveError.from_os_error(self.path, "write the history", error) from error
        self._size += len(raw)
        self._checksum = checksums.crc32(raw, self._checksum)
        self._pending.clear()

    def close(self) -> None:
        """Write what is pending and close the file."""
        try:
            self.flush()
        finally:
            self._file.close()


def covered_by(path: Path) -> tuple[int, int]:
    """Checksum and length of a history as it is.

    Raises
    ------
    ArchiveError
        Where it cannot be read.
    """
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise ArchiveError.from_os_error(path, "read the history", error) from error
    return checksums.crc32(raw), len(raw)


def cut_history(path: Path, format_: ReductionFormat, step: int, time: float) -> None:
    """Remove the lines of a history that are later than a step, and an unfinished last line.

    Where the lines carry neither step nor time, only an unfinished line is removed.

    Raises
    ------
    ArchiveError
        Where the file cannot be read or changed, or a line is not as `format_` says.
    """
    kept = 0
    try:
        lines = path.read_bytes().splitlines(keepends=True)
    except OSError as error:
        raise ArchiveError.from_os_error(path, "read the history", error) from error
    for number, line in enumerate(lines, 1):
        if not line.endswith(b"\n") or _later(path, number, line, format_, step, time):
            break
        kept += len(line)
    try:
        os.truncate(path, kept)
    except OSError as error:
        raise ArchiveError.from_os_error(path, "shorten the history", error) from error


def _later(path: Path, number: int, line: bytes, format_: ReductionFormat, step: int, time: float) -> bool:
    try:
        if format_.step_column:
            return int(line.split(b"\t")[0]) > step
        return format_.time_column and float(line.split(b"\t")[0]) > time
    except ValueError:
        raise ArchiveError(path, "the line does not begin with a step or a time", line=number) from None


@dataclass(frozen=True)
class Reduction:
    """The history of a reduction variable.

    Attributes
    ----------
    name, material
        Label, and index of the material or -1.
    times
        Times at the end of the steps, shape (n,); NaN where the file gives none.
    steps
        Numbers of the steps, shape (n,), or None where the file gives none.
    values
        Values, shape (n,), (n, 3) or (n, 9).
    """

    name: str
    material: int
    times: np.ndarray
    steps: np.ndarray | None
    values: np.ndarray


def read_history(path: Path, name: str, material: int) -> Reduction:
    """Read a history; which columns precede the value is seen from its tabs.

    A line cut off at the end of the file, without its line break, is left out.

    Raises
    ------
    ArchiveError
        Where the file cannot be read, a line is not numbers, or lines differ in length.
    """
    try:
        covered = checksums.of_history(path)  # first, as the file may grow
        raw = path.read_bytes()
    except OSError as error:
        raise ArchiveError.from_os_error(path, "read the history", error) from error
    checksums.check_history(path, raw, covered)
    text = raw.decode("ascii", errors="replace")
    lines = text.split("\n")[:-1]
    rows = [_row(path, number, line) for number, line in enumerate(lines, 1) if line.strip()]
    for number, row in enumerate(rows, 1):
        if len(row) != len(rows[0]):
            raise ArchiveError(
                path, f"{len(row)} numbers where the first line has {len(rows[0])}", line=number
            )
    if not rows:
        return Reduction(name, material, np.empty(0), None, np.empty(0))
    table = np.array(rows, dtype=float)
    tabs = lines[0].count("\t")
    step_first = tabs > 0 and re.match(r"\s*\d+\t", lines[0]) is not None and lines[0].index("\t") == 10
    steps = table[:, 0].astype(np.int64) if step_first else None
    time_column = tabs - int(step_first)
    times = table[:, tabs - 1] if time_column else np.full(len(rows), np.nan)
    values = table[:, tabs:]
    return Reduction(name, material, times, steps, values[:, 0] if values.shape[1] == 1 else values)


def _row(path: Path, number: int, line: str) -> Sequence[float]:
    try:
        return [float(word) for word in line.split()]
    except ValueError:
        raise ArchiveError(path, f"{line.strip()[:60]!r} is not a row of numbers", line=number) from None
