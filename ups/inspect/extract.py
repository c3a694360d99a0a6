"""Values of variables at a point, along a line, or of a particle, over the time steps, as a table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np

from ups.archive import Archive, ArchiveError, Level, Timestep, Variable
from ups.archive.layout import FloatVector
from ups.archive.reader import GridField
from ups.convert.csv import TableFile, components_of, headings


@dataclass(frozen=True)
class Table:
    """Columns of equal length with their names."""

    names: tuple[str, ...]
    columns: tuple[np.ndarray, ...]

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the column of a name."""
        return self.columns[self.names.index(name)]

    def write(self, file: IO[str]) -> None:
        """Write comma-separated values, with the digits that give numbers back exactly."""
        TableFile(file, self.names).extend(self.columns)

    def save(self, path: str | Path) -> None:
        """Write comma-separated values to a file.

        Raises
        ------
        ArchiveError
            Where it cannot be written.
        """
        try:
            with Path(path).open("w", encoding="utf-8", newline="") as file:
                self.write(file)
        except OSError as error:
            raise ArchiveError.from_os_error(path, "write the table", error) from error


def extract(
    archive: Archive,
    names: Sequence[str],
    *,
    point: FloatVector | None = None,
    line: tuple[FloatVector, FloatVector] | None = None,
    particle: int | None = None,
    count: int | None = None,
    material: int | None = None,
    level: int | None = None,
    steps: Sequence[int] | None = None,
) -> Table:
    """Do `at_point`, `along_line` or `of_particle`, as the place given asks for; the material 0 by default.

    Raises
    ------
    ValueError
        Where not exactly one place is given.
    """
    if [point, line, particle].count(None) != 2:
        raise ValueError("give one of point, line and particle")
    if particle is not None:
        return of_particle(archive, names, particle, material=material, steps=steps)
    index = 0 if material is None else material
    if point is not None:
        return at_point(archive, names, point, material=index, level=level, steps=steps)
    assert line is not None  # as only this is left
    return along_line(archive, names, *line, count=count, material=index, level=level, steps=steps)


def at_point(
    archive: Archive,
    names: Sequence[str],
    point: FloatVector,
    *,
    material: int = 0,
    level: int | None = None,
    steps: Sequence[int] | None = None,
) -> Table:
    """Values at a point over time.

    A grid variable is interpolated linearly between its nodes, cell centres or faces; of a particle
    variable the mean over the particles of the point's cell is given, NaN where there are none.

    Parameters
    ----------
    archive
        The archive.
    names
        Labels, perhaps with measures.
    point
        The point.
    material
        Index of the material.
    level
        Level of the grid; None for the finest that holds the point.
    steps
        Numbers of time steps; None for all.

    Returns
    -------
    Table
        The columns ``step``, ``time``, and one for each component of each variable.

    Raises
    ------
    ArchiveError
        Where a variable, material, level or step is not there, or the point is outside the grid.
    """
    return _sampled(archive, names, np.array([point], dtype=float), material, level, steps, keep_places=False)


def along_line(
    archive: Archive,
    names: Sequence[str],
    start: FloatVector,
    end: FloatVector,
    *,
    count: int | None = None,
    material: int = 0,
    level: int | None = None,
    steps: Sequence[int] | None = None,
) -> Table:
    """Values along a line, for each time step one row a point; see `at_point`.

    Parameters
    ----------
    archive, names, material, level, steps
        As for `at_point`.
    start, end
        Ends of the line.
    count
        Number of points, evenly spaced with both ends; None for one a cell.

    Returns
    -------
    Table
        The columns ``step``, ``time``, ``x``, ``y``, ``z``, ``distance`` (from the start), and the values.
    """
    first, last = np.array(start, dtype=float), np.array(end, dtype=float)
    if count is None:
        lattice = _level_of(archive, archive.timesteps[-1].step, first[None], level)
        count = 1 + max(1, math.ceil(np.max(np.abs(last - first) / lattice.spacing) - 1e-9))
    places = first + np.linspace(0.0, 1.0, count)[:, None] * (last - first)
    return _sampled(archive, names, places, material, level, steps, keep_places=True)


def of_particle(
    archive: Archive,
    names: Sequence[str],
    identity: int,
    *,
    material: int | None = None,
    steps: Sequence[int] | None = None,
) -> Table:
    """Values of one particle over time, at the steps where it is there.

    Parameters
    ----------
    archive, names, steps
        As for `at_point`.
    identity
        Its ``p.particleID``.
    material
        Its material, or None to look through all.

    Raises
    ------
    ArchiveError
        Where identities are not stored or no step has the particle.
    """
    chosen = [t.step for t in _steps(archive, steps)]
    tracks = [archive.follow(archive.find(n).declaration.name, [identity], material, chosen) for n in names]
    there = tracks[0].present[:, 0]
    if not there.any():
        raise ArchiveError(
            archive.path,
            f"no particle is called {identity}",
            advice="p.particleID lists the identities: ups convert ARCHIVE ids.csv --variable p.particleID",
        )
    titles, columns = ["step", "time"], [tracks[0].steps[there], tracks[0].times[there]]
    for name, track in zip(names, tracks, strict=True):
        titles += headings(archive.find(name).declaration)
        columns += components_of(track.values[there, 0])
    return Table(tuple(titles), tuple(columns))


def _steps(archive: Archive, steps: Sequence[int] | None) -> list[Timestep]:
    if not archive.timesteps:
        raise ArchiveError(archive.path, "there are no time steps")
    return list(archive.timesteps) if steps is None else [archive.timestep(step) for step in steps]


def _sampled(
    archive: Archive,
    names: Sequence[str],
    places: np.ndarray,
    material: int,
    level: int | None,
    steps: Sequence[int] | None,
    *,
    keep_places: bool,
) -> Table:
    """Values of the variables at the places, shape (n, 3), step by step."""
    declared = [archive.find(name).declaration for name in names]
    titles = ["step", "time", *(("x", "y", "z", "distance") if keep_places else ())]
    titles += [title for variable in declared for title in headings(variable)]
    blocks = []
    for timestep in _steps(archive, steps):
        lattice = _level_of(archive, timestep.step, places, level)
        columns = [np.full(len(places), timestep.step), np.full(len(places), timestep.time)]
        if keep_places:
            columns += [*places.T, np.linalg.norm(places - places[0], axis=1)]
        for variable in declared:
            sample = _particle_means if variable.is_particle else _grid_values
            columns += components_of(sample(archive, timestep.step, variable, material, lattice, places))
        blocks.append(columns)
    return Table(tuple(titles), tuple(np.concatenate(column) for column in zip(*blocks, strict=True)))


def _level_of(archive: Archive, step: int, places: np.ndarray, level: int | None) -> Level:
    """Return the given level, or the finest that holds all places."""
    levels = archive.grid(step).levels
    if level is not None and not 0 <= level < len(levels):
        raise ArchiveError(archive.path, f"there is no level {level}, only {len(levels)} levels")
    for lattice in reversed(levels) if level is None else [levels[level]]:
        low, high = (np.array(corner) for corner in lattice.bounds(lattice.interior))
        slack = 1e-9 * np.array(lattice.spacing)
        if ((places >= low - slack) & (places <= high + slack)).all():
            return lattice
    reach = levels[level or 0].bounds(levels[level or 0].interior)
    outside = places[0] if len(places) == 1 else places[[0, -1]]
    raise ArchiveError(
        archive.path,
        f"{outside.tolist()} is not inside the grid",
        advice=f"it reaches from {reach[0]} to {reach[1]}",
    )


def _grid_values(
    archive: Archive, step: int, variable: Variable, material: int, level: Level, places: np.ndarray
) -> np.ndarray:
    """Values of a grid variable at the places, shape (n, element...)."""
    return interpolate(archive.grid_variable(step, variable.name, material, level.index), places)


def interpolate(found: GridField, places: np.ndarray) -> np.ndarray:
    """Interpolate a field linearly in each axis; beyond its outermost values these hold.

    Parameters
    ----------
    found
        The field.
    places
        Shape (n, 3).

    Returns
    -------
    np.ndarray
        Shape (n, element...).
    """
    total = np.zeros((len(places), *found.values.shape[3:]))
    axes = [_weights(found, axis, places[:, axis]) for axis in range(3)]
    trailing = (1,) * (found.values.ndim - 3)
    for corner in np.ndindex(2, 2, 2):
        indices = tuple(axis[0][side] for axis, side in zip(axes, corner, strict=True))
        x, y, z = (axis[1][side] for axis, side in zip(axes, corner, strict=True))
        weight = (x * y * z).reshape(-1, *trailing)
        # a value of weight zero may lie in a hole of the level, which is filled with NaN
        values = np.where(weight > 0.0, found.values[indices], 0.0)
        total += weight * values
    return total


def _weights(
    found: GridField, axis: int, places: np.ndarray
) -> tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """Indices of the two values around each place on an axis, and their weights."""
    count = found.values.shape[axis]
    along = (places - found.coordinates[axis][0]) / found.level.spacing[axis]
    if not found.level.periodic[axis]:
        along = np.clip(along, 0.0, count - 1)
    nearest = np.rint(along)
    along = np.where(np.abs(along - nearest) < 1e-9, nearest, along)  # the node itself, in spite of rounding
    below = np.floor(along).astype(np.int64)
    share = along - below
    return (below % count, (below + 1) % count), (1.0 - share, share)


def _particle_means(
    archive: Archive, step: int, variable: Variable, material: int, level: Level, places: np.ndarray
) -> np.ndarray:
    """Means over the particles of the cells that hold the places, shape (n, element...)."""
    position = archive.index.particle_position
    values = archive.particles(step, variable.name, material)
    cells = _cell_numbers(level, archive.particles(step, position, material))
    wanted, back = np.unique(_cell_numbers(level, places), return_inverse=True)
    slot = np.searchsorted(wanted, cells)
    inside = (slot < len(wanted)) & (wanted[np.minimum(slot, len(wanted) - 1)] == cells)
    counts = np.bincount(slot[inside], minlength=len(wanted))
    rows = values[inside].reshape(-1, variable.element_type.components)
    sums = [np.bincount(slot[inside], weights=column, minlength=len(wanted)) for column in rows.T]
    with np.errstate(invalid="ignore"):
        means = np.stack(sums, axis=1) / counts[:, None]
    return means[back].reshape(len(places), *variable.element_type.shape)


def _cell_numbers(level: Level, places: np.ndarray) -> np.ndarray:
    """One number for the cell of each place; -1 outside the level. A place at the far edge is inside."""
    low, shape = np.array(level.interior.low), np.array(level.interior.shape)
    along = (places - np.array(level.anchor)) / np.array(level.spacing) - low
    nearest = np.rint(along)
    along = np.where(np.abs(along - nearest) < 1e-9, nearest, along)
    cells = np.floor(along).astype(np.int64)
    cells = np.where(along == shape, shape - 1, cells)
    inside = ((cells >= 0) & (cells < shape)).all(axis=1)
    return np.where(inside, (cells[:, 0] * shape[1] + cells[:, 1]) * shape[2] + cells[:, 2], -1)
