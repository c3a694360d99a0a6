"""Converting archives to formats that other programs read, one file of this package a format."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ups.archive import Archive, ArchiveError
from ups.convert import csv, npz, uda, vtk, vtkhdf
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
    "uda",
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
    alone: bool = False,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> list[Path]:
    """Convert an archive; of a time step no more is in memory than one variable on the grid, or its blocks.

    Parameters
    ----------
    archive_path
        The archive, or the folder of its checkpoints.
    out
        Where to write; its suffix chooses the format: ``.pvd`` or a folder for series of VTK XML, ``.vtp``,
        ``.vtu``, ``.vti``, ``.vtm`` and ``.vth`` for one kind of it, ``.vtkhdf``, ``.csv``, ``.npz``, and
        ``.uda`` for an archive again.
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
    alone
        Whether to leave out the time steps of earlier archives that the run was taken up from.
    jobs
        Threads that write VTK XML; None for as many as there are processor cores to use.
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
    archive = Archive(archive_path) if alone else Archive(archive_path).with_earlier_runs()
    selection = Selection.make(archive, variables, materials, steps, every=every, region=region)
    options = Options(jobs=jobs or _cores(), glyphs=glyphs)
    if progress is not None:
        options = replace(options, progress=progress)
    try:
        return format_.write(selection, out, options)
    except OSError as error:
        raise ArchiveError.from_os_error(out, "write the output", error) from error


def _cores() -> int:
    """Processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):  # not on every system
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
