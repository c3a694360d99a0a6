"""Tables of comma-separated values: one of the particles, and one for each kind of grid variable.

``x.csv`` holds the particles; node, cell and face variables go to ``x_nodes.csv``, ``x_cells.csv`` and
``x_xfaces.csv`` and so on, a row for each index, level and material, extra cells included. All time steps
follow each other in one table, with their number and time in the first columns. Numbers have the
digits that give them back exactly.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from itertools import repeat
from pathlib import Path
from typing import IO

import numpy as np

from ups.archive import ArchiveError, Box, GridField, Variable
from ups.archive.reader import PART
from ups.archive.variables import CELL, FACES, NODE
from ups.convert.registry import Format, Options, register
from ups.convert.selection import Selection, as_rows

_TABLES = {NODE: "nodes", CELL: "cells", FACES[0]: "xfaces", FACES[1]: "yfaces", FACES[2]: "zfaces"}


class TableFile:
    """A table that grows by blocks of rows under one heading."""

    def __init__(self, file: IO[str], heading: Sequence[str]) -> None:
        self._file = file
        file.write(",".join(f'"{name}"' if "," in name else name for name in heading) + "\n")

    def extend(self, columns: Sequence[np.ndarray]) -> None:
        """Add rows given as columns."""
        form = ",".join("%.17g" if column.dtype.kind == "f" else "%d" for column in columns) + "\n"
        rows = zip(*(column.tolist() for column in columns), strict=True)
        self._file.writelines(map(form.__mod__, rows))


def headings(variable: Variable) -> list[str]:
    """Names of the columns of a variable: the label, with its components where there are several."""
    element = variable.element_type
    names: Iterable[str] = element.component_names or map(str, range(element.components))
    return [f"{variable.name}.{name}" for name in names] if element.shape else [variable.name]


def components_of(values: np.ndarray) -> list[np.ndarray]:
    """Components of values of shape (n, element...), each of shape (n,)."""
    return list(as_rows(values).T)


def _particle_rows(
    selection: Selection, step: int, time: float, named: Sequence[Variable]
) -> Iterator[list[np.ndarray]]:
    """Columns of the particles of a time step, some rows at a time."""
    particles = selection.particles(step)
    stored = particles.variables
    parts = [particles.value_parts(v) if v in stored else repeat(None) for v in named]
    places = zip(particles.material_parts(), particles.position_parts(), strict=True)
    for (material, positions), *values in zip(places, *parts, strict=False):
        count = len(material)
        columns = [np.full(count, step), np.full(count, time), material, *components_of(positions)]
        for variable, found in zip(named, values, strict=True):
            absent = np.full((count, *variable.element_type.shape), np.nan)
            columns += components_of(absent if found is None else found)
        yield columns


def _grid_columns(
    step: int,
    time: float,
    level: int,
    material: int,
    fields: dict[Variable, GridField],
    named: Sequence[Variable],
) -> list[np.ndarray]:
    first = next(iter(fields.values()))
    shape = first.box.shape
    indices = [axis.reshape(-1) + low for axis, low in zip(np.indices(shape), first.origin, strict=True)]
    places = [axis.reshape(-1) for axis in np.meshgrid(*first.coordinates, indexing="ij")]
    count = first.box.size
    head = [np.full(count, step), np.full(count, time), np.full(count, level), np.full(count, material)]
    columns = [*head, *indices, *places]
    for variable in named:
        outer = (count, *variable.element_type.shape)
        values = fields[variable].values.reshape(outer) if variable in fields else np.full(outer, np.nan)
        columns += components_of(values)
    return columns


def write(selection: Selection, out: Path, options: Options) -> list[Path]:
    """Write the selection as tables; see the module for their names."""
    position = selection.archive.index.particle_position
    on_particles = [v for v in selection.variables if v.is_particle and v.name != position]
    on_grid = {c: [v for v in selection.variables if v.container == c] for c in _TABLES}
    paths: dict[str, Path] = {"particles": out} if selection.has_particles else {}
    paths |= {c: out.with_name(f"{out.stem}_{_TABLES[c]}.csv") for c, named in on_grid.items() if named}
    if not paths:
        raise ArchiveError(selection.archive.path, "there is no particle or grid variable to convert")
    out.parent.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        tables: dict[str, TableFile] = {}
        for kind, path in paths.items():
            named = on_grid.get(kind, on_particles)
            head = ["step", "time", "material", "x", "y", "z"]
            if kind in on_grid:
                head = ["step", "time", "level", "material", "i", "j", "k", "x", "y", "z"]
            file = stack.enter_context(path.open("w", encoding="utf-8", newline=""))
            tables[kind] = TableFile(file, head + [name for variable in named for name in headings(variable)])
        for done, timestep in enumerate(selection.timesteps, 1):
            _write_step(selection, timestep.step, timestep.time, tables, on_particles, on_grid)
            options.progress(done, len(selection.timesteps))
    return list(paths.values())


def _write_step(
    selection: Selection,
    step: int,
    time: float,
    tables: dict[str, TableFile],
    on_particles: Sequence[Variable],
    on_grid: dict[str, list[Variable]],
) -> None:
    if "particles" in tables:
        for columns in _particle_rows(selection, step, time, on_particles):
            tables["particles"].extend(columns)
    for level in selection.archive.grid(step).levels if set(tables) - {"particles"} else ():
        grouped: dict[tuple[str, int], dict[Variable, GridField]] = {}
        for material, grid_field in selection.grid_fields(step, level.index):
            declared = next(v for v in selection.variables if v.name == grid_field.variable.name)
            cropped = selection.cropped(grid_field)
            grouped.setdefault((declared.container, material), {})[declared] = cropped
        for (container, material), fields in grouped.items():
            for layers in _layers(fields):
                columns = _grid_columns(step, time, level.index, material, layers, on_grid[container])
                tables[container].extend(columns)


def _layers(fields: dict[Variable, GridField]) -> Iterator[dict[Variable, GridField]]:
    """Variables of one box, some layers along x at a time."""
    low, high = next(iter(fields.values())).box
    thickness = max(1, PART // max(1, (high[1] - low[1]) * (high[2] - low[2])))
    for begin in range(low[0], high[0], thickness):
        part = Box((begin, *low[1:]), (min(begin + thickness, high[0]), *high[1:]))
        yield {v: replace(f, values=f.values[part.within(low)], box=part) for v, f in fields.items()}


register(Format("CSV", (".csv",), write))
