"""VTK XML for ParaView: particles as .vtp or .vtu, levels of the grid as .vti, and the files that name them.

``x.pvd`` and a folder get everything as series over time. The suffix of a single kind of file gives that kind
only: ``x.vtp`` and ``x.vtu`` the particles, ``x.vti`` the grid of a single level, ``x.vth`` the levels of the
grid as an overlapping hierarchy, ``x.vtm`` particles and levels as blocks of one data set. With several time
steps their files are numbered (``x_00051.vtp``), and ``x.pvd`` (of .vth: ``x.vth.series``) names them by time.

Names are those of Uintah without the ``p.`` or ``g.``; a grid variable carries its material behind
(``mass_0``). Grids are written without their extra cells; a node that a periodic level stores once appears
on both sides; a face variable is given at the cell, as the mean of its two faces there. Cells that a finer
level covers, or that belong to no patch, are marked as hidden.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import TypeVar

import numpy as np

from ups.archive import ArchiveError, Box, Level, Patch, Timestep
from ups.archive.markup import HEADER, attributes, number
from ups.convert.registry import Format, Options, register
from ups.convert.selection import Selection
from ups.convert.vtkpieces import LevelFields, write_cells, write_grid, write_vertices
from ups.convert.vtkxml import Entry, save_blocks, save_json_series, save_lines, save_series

_T = TypeVar("_T")

Pieces = list[tuple[str, int, Path]]
"""Files of a time step: what each holds (``particles`` or ``grid``), its part of the whole, its path."""


def _pieces_of(
    selection: Selection, folder: Path, timestep: Timestep, options: Options, threads: int
) -> Pieces:
    """Write the files of a time step, each level of the grid in one."""
    step, time = timestep.step, timestep.time
    pieces: Pieces = []
    if selection.has_particles:
        path = folder / f"particles_{step:05d}.{'vtu' if options.glyphs else 'vtp'}"
        _write_points(path, selection, timestep, options, threads)
        pieces.append(("particles", 0, path))
    for level in selection.archive.grid(step).levels if selection.has_grid else ():
        cells = selection.cells(level)
        if cells.size:
            path = folder / f"grid_l{level.index}_{step:05d}.vti"
            write_grid(path, LevelFields(selection, step, level), cells, time, threads)
            pieces.append(("grid", level.index, path))
    return pieces


def _write_points(
    path: Path, selection: Selection, timestep: Timestep, options: Options, threads: int
) -> None:
    """Write the particles in the form that the suffix asks for."""
    particles = selection.particles(timestep.step)
    if path.suffix.lower() == ".vtp":
        write_vertices(path, particles, timestep.time, threads)
    else:
        write_cells(path, particles, timestep.time, threads, boxes=options.glyphs)


def write(selection: Selection, out: Path, options: Options) -> list[Path]:
    """Write everything that is selected as series.

    ``x.pvd`` gets the particles, ``x_grid.pvd`` the grid, both with their files in the folder ``x``; a
    folder gets ``particles.pvd`` and ``grid.pvd``. A series is complete after every time step.
    """
    _require(selection, particles=True, grid=True)
    if out.suffix.lower() == ".pvd" and not out.is_dir():
        folder = out.with_suffix("")
        series = {"particles": out, "grid": out.with_name(f"{out.stem}_grid.pvd")}
        if not selection.has_particles:
            series["grid"] = out
    else:
        folder, series = out, {kind: out / f"{kind}.pvd" for kind in ("particles", "grid")}
    folder.mkdir(parents=True, exist_ok=True)
    entries: dict[str, list[Entry]] = {}
    for timestep, pieces in _each_step(selection, options, partial(_pieces_of, selection, folder)):
        for kind, part, path in pieces:
            entries.setdefault(kind, []).append(Entry(timestep.time, part, path))
        for kind, listed in entries.items():
            save_series(series[kind], listed)
    return [series[kind] for kind in entries]


def _require(selection: Selection, *, particles: bool, grid: bool) -> None:
    """Raise where nothing of what a format holds is selected."""
    if not (particles and selection.has_particles) and not (grid and selection.has_grid):
        kinds = " or ".join(["particle"] * particles + ["grid"] * grid)
        raise ArchiveError(selection.archive.path, f"there is no {kinds} variable to convert")
    if not selection.timesteps:
        raise ArchiveError(selection.archive.path, "there are no time steps")


def _each_step(
    selection: Selection, options: Options, work: Callable[[Timestep, Options, int], _T]
) -> Iterator[tuple[Timestep, _T]]:
    """Work on the time steps, several at the same time; give the results in order."""
    steps = selection.timesteps
    at_once = max(1, min(options.jobs, len(steps)))
    pool = ThreadPoolExecutor(at_once)  # threads suffice: zlib runs outside Python's lock
    try:
        threads = max(1, options.jobs // at_once)
        results = pool.map(lambda timestep: work(timestep, options, threads), steps)
        for done, (timestep, result) in enumerate(zip(steps, results, strict=True), 1):
            yield timestep, result
            options.progress(done, len(steps))
    finally:
        pool.shutdown(cancel_futures=True)


def _write_single_kind(
    selection: Selection,
    out: Path,
    options: Options,
    work: Callable[[Path, Timestep, Options, int], None],
    save_listing: Callable[[Path, Sequence[Entry]], None],
    listing: Path,
) -> list[Path]:
    """Write `out` for a single time step, else numbered files and the `listing` that names them."""
    out.parent.mkdir(parents=True, exist_ok=True)
    single = len(selection.timesteps) == 1

    def path_of(timestep: Timestep) -> Path:
        return out if single else out.with_name(f"{out.stem}_{timestep.step:05d}{out.suffix}")

    def write_step(timestep: Timestep, options: Options, threads: int) -> Path:
        work(path_of(timestep), timestep, options, threads)
        return path_of(timestep)

    entries = []
    for timestep, path in _each_step(selection, options, write_step):
        entries.append(Entry(timestep.time, 0, path))
        if not single:
            save_listing(listing, entries)
    return [out if single else listing]


def write_particles(selection: Selection, out: Path, options: Options) -> list[Path]:
    """Write the particles only, as .vtp or .vtu."""
    _require(selection, particles=True, grid=False)
    if options.glyphs and out.suffix.lower() == ".vtp":
        raise ArchiveError(out, "boxes do not fit into this format", advice="write a .vtu or a .pvd")

    def work(path: Path, timestep: Timestep, options: Options, threads: int) -> None:
        _write_points(path, selection, timestep, options, threads)

    return _write_single_kind(selection, out, options, work, save_series, out.with_suffix(".pvd"))


def write_image(selection: Selection, out: Path, options: Options) -> list[Path]:
    """Write the grid of a single level only, as .vti."""
    _require(selection, particles=False, grid=True)

    def work(path: Path, timestep: Timestep, options: Options, threads: int) -> None:
        levels = selection.archive.grid(timestep.step).levels
        if len(levels) > 1:
            message = f"{len(levels)} levels at step {timestep.step} do not fit into one image"
            raise ArchiveError(out, message, advice="write a .vth, a .vtm or a .pvd")
        cells = selection.cells(levels[0])
        fields = LevelFields(selection, timestep.step, levels[0])
        write_grid(path, fields, cells, timestep.time, threads)

    return _write_single_kind(selection, out, options, work, save_series, out.with_suffix(".pvd"))


def write_blocks(selection: Selection, out: Path, options: Options) -> list[Path]:
    """Write particles and levels as blocks of one data set, .vtm, with their files in a folder beside."""
    _require(selection, particles=True, grid=True)
    folder = out.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)

    def work(path: Path, timestep: Timestep, options: Options, threads: int) -> None:
        pieces = _pieces_of(selection, folder, timestep, options, threads)
        names = {"particles": "particles", "grid": "level {part}"}
        save_blocks(path, [(names[kind].format(part=part), file) for kind, part, file in pieces])

    return _write_single_kind(selection, out, options, work, save_series, out.with_suffix(".pvd"))


def write_hierarchy(selection: Selection, out: Path, options: Options) -> list[Path]:
    """Write the levels of the grid as an overlapping hierarchy, .vth, with their files in a folder beside."""
    _require(selection, particles=False, grid=True)
    folder = out.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)

    def work(path: Path, timestep: Timestep, options: Options, threads: int) -> None:
        levels = selection.archive.grid(timestep.step).levels
        _check_ratios(out, levels)
        files = {
            level.index: _write_boxes_of(selection, folder, timestep, level, threads) for level in levels
        }
        _save_hierarchy(path, levels, files)

    listing = out.with_name(f"{out.name}.series")
    return _write_single_kind(selection, out, options, work, save_json_series, listing)


def _check_ratios(out: Path, levels: Sequence[Level]) -> None:
    """Raise where a level does not divide the cells of the one before into as many along every axis."""
    for coarse, fine in pairwise(levels):
        ratios = np.array(coarse.spacing) / fine.spacing
        if not np.allclose(ratios, np.rint(ratios[0]), rtol=1e-6):
            shown = ", ".join(f"{ratio:.6g}" for ratio in ratios)
            message = f"level {fine.index} divides cells by [{shown}], not equally along all axes"
            raise ArchiveError(out, message, advice="write a .vtm or a .pvd")


def _write_boxes_of(
    selection: Selection, folder: Path, timestep: Timestep, level: Level, threads: int
) -> list[tuple[Box, Path]]:
    """Write a level, in one file where its patches fill a box, else a file for each patch."""
    patches: Sequence[Patch | None] = level.patches
    if sum(patch.interior.size for patch in level.patches) == level.interior.size:
        patches = (None,)
    fields = LevelFields(selection, timestep.step, level, keep=len(patches) > 1)
    written = []
    for patch in patches:
        cells = selection.cells(level, None if patch is None else patch.interior)
        if cells.size:
            name = f"grid_l{level.index}" + ("" if patch is None else f"_p{patch.id:05d}")
            path = folder / f"{name}_{timestep.step:05d}.vti"
            write_grid(path, fields, cells, timestep.time, threads, alone=False)
            written.append((cells, path))
    return written


def _save_hierarchy(
    path: Path, levels: Sequence[Level], files: Mapping[int, Sequence[tuple[Box, Path]]]
) -> None:
    """Write the .vth that names the boxes of each level and their files."""
    origin = " ".join(map(number, levels[0].anchor))
    lines = [
        HEADER,
        '<VTKFile type="vtkOverlappingAMR" version="1.1" byte_order="LittleEndian">',
        f"<vtkOverlappingAMR{attributes(origin=origin, grid_description='XYZ')}>",
    ]
    for level in levels:
        lines.append(f"<Block{attributes(level=level.index, spacing=' '.join(map(number, level.spacing)))}>")
        for index, ((low, high), file) in enumerate(files[level.index]):
            box = " ".join(f"{a} {b - 1}" for a, b in zip(low, high, strict=True))
            href = file.relative_to(path.parent).as_posix()
            lines.append(f"<DataSet{attributes(index=index, amr_box=box, file=href)}/>")
        lines.append("</Block>")
    save_lines(path, [*lines, "</vtkOverlappingAMR>", "</VTKFile>"])


register(Format("VTK XML", (".pvd", ""), write))
register(Format("VTK particles", (".vtp", ".vtu"), write_particles))
register(Format("VTK image", (".vti",), write_image))
register(Format("VTK blocks", (".vtm",), write_blocks))
register(Format("VTK hierarchy", (".vth",), write_hierarchy))
