"""Converting archives to formats that other programs read, one file of this package a format."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ups.archive import Archive, ArchiveError
from ups.convert import csv, npz, vtk
from ups.convert.registry import FORMATS, Format, Progress, format_of, register
from ups.convert.selection import Selection

__all__ = ["FORMATS", "Format", "Progress", "convert", "csv", "npz", "register", "vtk"]


def convert(
    archive_path: str | Path,
    out: str | Path,
    *,
    variables: Sequence[str] | None = None,
    materials: Sequence[int] | None = None,
    steps: Sequence[int] | None = None,
    progress: Progress | None = None,
) -> list[Path]:
    """Convert an archive, one time step in memory at a time.

    Parameters
    ----------
    archive_path
        The archive, or the folder of its checkpoints.
    out
        Where to write; its suffix chooses the format: ``.pvd``, ``.csv``, ``.npz``, or a folder for VTK.
        Files that are there are replaced.
    variables
        Labels, with or without ``p.`` and ``g.``; None for all.
    materials
        Indices of materials; None for all.
    steps
        Numbers of time steps, negative ones counted from the last; None for all.
    progress
        Called after each time step with the number done and the number of all.

    Returns
    -------
    list[Path]
        The files to open.

    Raises
    ------
    ArchiveError
        Where the archive does not hold what is asked for or is damaged, or the disk refuses.
    """
    out = Path(out)
    format_ = format_of(out)
    selection = Selection.make(Archive(archive_path), variables, materials, steps)
    try:
        return format_.write(selection, out, progress or (lambda done, total: None))
    except OSError as error:
        raise ArchiveError.from_os_error(out, "write the output", error) from error
