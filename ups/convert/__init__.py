"""Converting archives to formats that other programs read, one file of this package a format."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ups.archive import Archive, ArchiveError
from ups.convert import csv, npz, vtk, vtkhdf
from ups.convert.registry import FORMATS, Format, Options, Progress, format_of, register
from ups.convert.selection import Region, Selection

__all__ = [
    "FORMATS",
    "Format",
    "Options",
    "Progress",
    "Region",
    "convert",
    "csv",
    "npz",
    "register",
    "vtk",
    "vtkhdf",
]


def convert(
    archive_path: str | Path,
    out: str | Path,
    *,
    variables: Sequence[str] | None = None,
    materials: Sequence[int] | None = None,
    steps: Sequence[int] | None = None,
    every: int = 1,
    region: Region | None = None,
    glyphs: bool = False,
    jobs: int = 1,
    progress: Progress | None = None,
) -> list[Path]:
    """Convert an archive, one time step in memory at a time for each of the jobs.

    Parameters
    ----------
    archive_path
        The archive, or the folder of its checkpoints.
    out
        Where to write; its suffix chooses the format: ``.pvd``, ``.vtkhdf``, ``.csv``, ``.npz``, or a
        folder for VTK XML.
        Files that are there are replaced.
    variables
        Labels, with or without ``p.`` and ``g.``, perhaps with measures (``stress:vonMises``); None for all.
    materials
        Indices of materials; None for all.
    steps
        Numbers of time steps, negative ones counted from the last; None for all.
    every
        Only every so-manieth of these time steps, beginning with the first.
    region
        Box that particles and cells must be in; None for all.
    glyphs
        Whether VTK XML holds the particles as boxes, deformed as their material is, and not as points.
    jobs
        Time steps that VTK XML is written for at the same time.
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
    selection = Selection.make(Archive(archive_path), variables, materials, steps, every=every, region=region)
    options = Options(jobs=jobs, glyphs=glyphs)
    if progress is not None:
        options = replace(options, progress=progress)
    try:
        return format_.write(selection, out, options)
    except OSError as error:
        raise ArchiveError.from_os_error(out, "write the output", error) from error
