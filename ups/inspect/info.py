"""What an archive holds: its steps, grid, variables and their ranges, histories, size and health."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from ups.archive import Archive, ArchiveError, Level, Timestep, Variable
from ups.archive.measures import MEASURES, measures_of
from ups.archive.units import unit_of
from ups.inspect.check import check_archive

_SIZES = ("B", "kB", "MB", "GB", "TB")


@dataclass(frozen=True)
class VariableSummary:
    """A variable at one time step.

    Attributes
    ----------
    name, type_name, unit
        Label, Uintah's type, and the unit in a deck of SI units (empty where not known).
    material
        Index of the material.
    count
        Number of particles, nodes, cells or faces (extra cells included) or patches.
    low, high
        Smallest and largest finite number of each component, in stored order.
    magnitude
        Smallest and largest length of a vector or norm of a tensor; None for numbers.
    not_finite
        Number of elements with a component that is NaN or infinite.
    """

    name: str
    type_name: str
    unit: str
    material: int
    count: int
    low: tuple[float, ...]
    high: tuple[float, ...]
    magnitude: tuple[float, float] | None
    not_finite: int


@dataclass(frozen=True)
class ArchiveSummary:
    """What an archive holds.

    Attributes
    ----------
    path, title, date, processes
        Where it is, and what it says of its run.
    size
        Bytes on the disk.
    timesteps
        Stored time steps.
    levels
        Grid of the step that the ranges are of.
    step
        That step; None where no step is whole.
    variables
        Ranges at that step.
    unsupported
        Types of variables that cannot be read, by label.
    histories
        Name, number of lines, last value and unit of each history.
    checkpoints
        Steps of the checkpoints.
    restarts
        Archives and steps that the run was taken up from.
    problems
        What is missing, cut off or damaged, as far as tables and sizes of files tell.
    """

    path: str
    title: str
    date: str
    processes: int
    size: int
    timesteps: tuple[Timestep, ...]
    levels: tuple[Level, ...]
    step: int | None
    variables: tuple[VariableSummary, ...]
    unsupported: dict[str, str]
    histories: tuple[tuple[str, int, str, str], ...]
    checkpoints: tuple[int, ...]
    restarts: tuple[tuple[str, int], ...]
    problems: tuple[ArchiveError, ...]

    def as_dict(self) -> dict[str, object]:
        """Everything as plain numbers, strings, lists and dictionaries, for JSON; None for a range of nothing."""
        found = asdict(self)
        for variable in found["variables"]:
            for name in ("low", "high", "magnitude"):
                if any(np.isnan(end) for end in variable[name] or ()):
                    variable[name] = None
        found["levels"] = [
            {
                "cells": level.interior.shape,
                "spacing": level.spacing,
                "anchor": level.anchor,
                "extra_cells": level.extra_cells,
                "periodic": level.periodic,
                "patches": len(level.patches),
            }
            for level in self.levels
        ]
        found["problems"] = [str(problem) for problem in self.problems]
        return found


def summarize(path: str | Path, step: int = -1) -> ArchiveSummary:
    """Summarise an archive; the ranges are those of one time step.

    Parameters
    ----------
    path
        The archive.
    step
        Number of the step, negative ones counted from the last whole one.

    Raises
    ------
    ArchiveError
        Where there is no archive, its table of contents is damaged, or the step is not stored.
    """
    archive = Archive(path)
    health = check_archive(path, values=False)
    chosen = _choose(archive, health.whole, step)
    return ArchiveSummary(
        path=str(archive.path),
        title=archive.index.title,
        date=archive.index.date,
        processes=archive.index.processes,
        size=sum(file.stat().st_size for file in archive.path.resolve().rglob("*") if file.is_file()),
        timesteps=archive.timesteps,
        levels=() if chosen is None else archive.grid(chosen).levels,
        step=chosen,
        variables=() if chosen is None else tuple(_variables(archive, chosen)),
        unsupported=archive.unsupported,
        histories=tuple(_histories(archive)),
        checkpoints=_checkpoints(archive),
        restarts=tuple((restart.source, restart.step) for restart in archive.index.restarts),
        problems=tuple(health.problems),
    )


def _choose(archive: Archive, whole: Sequence[int], step: int) -> int | None:
    if step >= 0:
        return archive.timestep(step).step
    return whole[step] if len(whole) + step >= 0 else None


def _checkpoints(archive: Archive) -> tuple[int, ...]:
    try:
        checkpoints = archive.checkpoints
    except ArchiveError:
        return ()  # what is wrong with them is among the problems
    return () if checkpoints is None else tuple(timestep.step for timestep in checkpoints.timesteps)


def _variables(archive: Archive, step: int) -> list[VariableSummary]:
    found = []
    for label in archive.labels(step):
        variable = archive.variables.get(label)
        if variable is None:
            continue
        for material in archive.materials(step, label):
            parts, absent = _parts(archive, step, variable, material)
            found.append(_summary(variable, material, parts, absent))
    return found


def _parts(archive: Archive, step: int, variable: Variable, material: int) -> tuple[list[np.ndarray], int]:
    """Values of a variable on every level, each of shape (n, components), and how many only fill holes."""
    components = variable.element_type.components
    if variable.is_particle:
        return [archive.particles(step, variable.name, material).reshape(-1, components)], 0
    parts, holes = [], 0
    for level in archive.grid(step).levels:
        if material not in archive.materials(step, variable.name, level.index):
            continue
        if variable.is_grid:
            values = archive.grid_variable(step, variable.name, material, level.index).values
            own = (level.extent(position, variable.container).size for position in range(len(level.patches)))
            holes += max(0, values.size // components - sum(own))
        else:
            values = archive.per_patch(step, variable.name, material, level.index)
        parts.append(values.reshape(-1, components))
    return parts, holes


def _summary(variable: Variable, material: int, parts: list[np.ndarray], holes: int) -> VariableSummary:
    rows = parts[0] if len(parts) == 1 else np.concatenate(parts)
    finite = np.isfinite(rows).all(axis=1) if rows.dtype.kind == "f" else np.ones(len(rows), dtype=bool)
    sound = rows[finite]
    components = variable.element_type.components
    low = tuple(sound.min(axis=0).tolist()) if len(sound) else (np.nan,) * components
    high = tuple(sound.max(axis=0).tolist()) if len(sound) else (np.nan,) * components
    magnitude = None
    for name in {"magnitude", "norm"} & set(measures_of(variable)):
        lengths = MEASURES[name].function(sound.reshape(-1, *variable.element_type.shape))
        magnitude = (float(lengths.min()), float(lengths.max())) if len(sound) else (np.nan, np.nan)
    return VariableSummary(
        variable.name,
        variable.type_name,
        unit_of(variable.name),
        material,
        len(rows) - holes,
        low,
        high,
        magnitude,
        len(rows) - len(sound) - (holes if rows.dtype.kind == "f" else 0),
    )


def _histories(archive: Archive) -> list[tuple[str, int, str, str]]:
    found = []
    for name in archive.reductions:
        try:
            history = archive.reductions[name]
        except ArchiveError:
            continue  # it is among the problems
        last = "" if not len(history.values) else " ".join(f"{v:.9g}" for v in np.ravel(history.values[-1]))
        found.append((name, len(history.values), last, unit_of(history.name)))
    return found


def render(summary: ArchiveSummary) -> str:
    """Return the summary as text for a terminal."""
    lines = [f"{summary.path}: {summary.title or 'archive'}"]
    lines.append(
        f"  written {summary.date or 'at an unknown time'} by {summary.processes} "
        f"process{'es' * (summary.processes != 1)}, {_readable(summary.size)} on disk"
    )
    lines += [
        "",
        f"{len(summary.timesteps)} time step{'s' * (len(summary.timesteps) != 1)}",
        *_step_lines(summary.timesteps),
    ]
    if summary.checkpoints:
        lines.append(f"  checkpoints at the steps {', '.join(map(str, summary.checkpoints))}")
    lines += [f"  taken up from {source} at step {step}" for source, step in summary.restarts]
    lines += ["", "grid", *(_level_line(level) for level in summary.levels)]
    if summary.step is not None:
        lines += [
            "",
            f"variables at step {summary.step}, each with its range (of the length or norm; corners of positions)",
        ]
        lines += _columns([_variable_row(variable) for variable in summary.variables])
    lines += [f"  {name}  {type_name}  (cannot be read)" for name, type_name in summary.unsupported.items()]
    if summary.histories:
        lines += ["", "histories"]
        lines += _columns(
            [(n, f"{count} lines", f"last {v}" if v else "", u) for n, count, v, u in summary.histories]
        )
    lines.append("")
    if summary.problems:
        lines.append(f"{len(summary.problems)} problem{'s' * (len(summary.problems) != 1)}")
        lines += [f"  {problem}" for problem in summary.problems]
    else:
        lines.append("nothing is missing or cut off")
    return "\n".join(lines)


def _step_lines(timesteps: Sequence[Timestep]) -> list[str]:
    """One line a step, those in the middle of a long list left out."""
    lines = [f"  step {timestep.step:>7}  time {timestep.time:.9g} s" for timestep in timesteps]
    return lines if len(lines) <= 12 else [*lines[:5], f"  ... {len(lines) - 10} more ...", *lines[-5:]]


def _level_line(level: Level) -> str:
    cells = " x ".join(map(str, level.interior.shape))
    spacing = ", ".join(f"{h:.6g}" for h in level.spacing)
    low, high = level.bounds(level.interior)
    ends = " to ".join("[" + ", ".join(f"{x:.6g}" for x in corner) + "]" for corner in (low, high))
    patches = f"{len(level.patches)} patch{'es' * (len(level.patches) != 1)}"
    line = f"  level {level.index}: {cells} cells of [{spacing}] m, {ends} m, {patches}"
    axes = [axis for axis, periodic in zip("xyz", level.periodic, strict=True) if periodic]
    extra = f", extra cells {list(level.extra_cells)}" if any(level.extra_cells) else ""
    return line + extra + (f", periodic in {', '.join(axes)}" if axes else "")


def _variable_row(variable: VariableSummary) -> tuple[str, ...]:
    low, high = ([end] for end in variable.magnitude or (min(variable.low), max(variable.high)))
    if variable.type_name.endswith("<Point>"):
        low, high = list(variable.low), list(variable.high)
    bad = f"  {variable.not_finite} not finite" if variable.not_finite else ""
    ends = f"{_numbers(low)} to {_numbers(high)}" if variable.count else ""
    unit = "" if variable.unit == "1" else variable.unit
    return (
        variable.name,
        variable.type_name,
        f"material {variable.material}",
        f"{variable.count}",
        ends,
        unit + bad,
    )


def _numbers(values: Sequence[float]) -> str:
    text = ", ".join(f"{value:.6g}" if isinstance(value, float) else str(value) for value in values)
    return f"[{text}]" if len(values) > 1 else text


def _columns(rows: Sequence[tuple[str, ...]]) -> list[str]:
    """Rows as lines with aligned columns."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)] if rows else []
    return [
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def _readable(size: int) -> str:
    power = 0 if size < 1000 else min(len(_SIZES) - 1, (len(str(size)) - 1) // 3)
    return f"{size / 1000**power:.3g} {_SIZES[power]}"
