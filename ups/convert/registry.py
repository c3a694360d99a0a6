"""The formats that an archive can be converted to, by the suffix of the output."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from ups.archive import ArchiveError
from ups.convert.selection import Selection

Progress = Callable[[int, int], None]
"""Called after each time step with the number done and the number of all."""


def _silent(done: int, total: int) -> None:
    """Report to nobody."""


@dataclass(frozen=True)
class Options:
    """How to convert.

    Attributes
    ----------
    progress
        Called after each time step.
    jobs
        Threads that work at the same time, where the format allows it: on time steps, or on parts of one.
    glyphs
        Whether particles become boxes, deformed as their material is, where the format can hold them.
    """

    progress: Progress = _silent
    jobs: int = 1
    glyphs: bool = False


@dataclass(frozen=True)
class Format:
    """A format that archives are converted to.

    Attributes
    ----------
    name
        What the format is called.
    suffixes
        Suffixes of the output that choose it; ``""`` stands for a folder.
    write
        Writes what is selected to the output and returns the files to open; raises OSError where the
        disk refuses.
    makes_folder
        Whether an output of these suffixes is a folder.
    """

    name: str
    suffixes: tuple[str, ...]
    write: Callable[[Selection, Path, Options], list[Path]]
    makes_folder: bool = False


FORMATS: dict[str, Format] = {}
"""Known formats by suffix."""


def register(format_: Format) -> None:
    """Make a format known."""
    for suffix in format_.suffixes:
        if suffix in FORMATS:
            raise ValueError(f"both {FORMATS[suffix].name} and {format_.name} claim {suffix!r}")
        FORMATS[suffix] = format_


def format_of(out: Path) -> Format:
    """Format that the output's suffix asks for; an existing folder asks for that of folders."""
    suffix = out.suffix.lower()
    if out.is_dir() and not (suffix in FORMATS and FORMATS[suffix].makes_folder):
        suffix = ""
    if suffix not in FORMATS:
        known = ", ".join(f"a name ending in {known}" for known in FORMATS if known)
        raise ArchiveError(
            out, f"no format is known by the suffix {suffix}", advice=f"give {known}, or a folder"
        )
    return FORMATS[suffix]


@contextmanager
def atomically(path: Path) -> Iterator[Path]:
    """Give the name under which a file is written; it gets its own when it is whole, and is removed if it fails."""
    partial = path.with_name(path.name + ".partial")
    try:
        yield partial
        partial.replace(path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise
