"""A directory of stored time steps: an archive's own, or that of its checkpoints."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
import numpy.typing as npt
from lxml import etree

from ups.archive import blocks, checksums
from ups.archive.errors import ArchiveError
from ups.archive.index import ArchiveIndex, Listed, Timestep
from ups.archive.layout import Box, Grid, Level
from ups.archive.ranks import Ranks, together
from ups.archive.stored import state_file
from ups.archive.table import Entry, table_lines
from ups.archive.timestep import timestep_lines
from ups.archive.variables import PER_PATCH, Variable

Fields = Mapping[Variable, Mapping[int, npt.ArrayLike]]
"""Values of one level by variable and material, in the order in which they are to be stored.

Particle variables: shape (n, element...). Node, cell and face variables: an array over the whole
level, of the shape of `Level.whole` and indexed [x, y, z, component...]. Per-patch variables: shape
(patches, element...). A matrix may be given as (..., 3, 3) or (..., 9).

Where several ranks write together, each gives its own: the particles in its patches, arrays over the box
around them (`Level.whole` with its ``rank``), its patches' values. All name the same variables and
materials; the arrays of a rank that has no patch on a level are not looked at.
"""

Positions = Mapping[int, npt.ArrayLike]
"""Positions of the particles of one level by material, each of shape (n, 3)."""


@contextmanager
def storing(path: Path, doing: str) -> Iterator[None]:
    """Turn the operating system's errors into `ArchiveError`."""
    try:
        yield
    except OSError as error:
        raise ArchiveError.from_os_error(path, doing, error) from error


@dataclass(frozen=True)
class Content:
    """What one stored time step holds."""

    levels: Sequence[Fields]
    positions: Sequence[Positions] | None
    sections: Sequence[etree._Element]
    global_values: Fields | None = None
    state: Mapping[str, npt.ArrayLike] | None = None


class Tree:
    """A directory of time steps and its table of contents: the archive's own, or its checkpoints'.

    Several ranks write it together, each the data of its own patches, the first all else. One alone writes
    the data of every patch, whichever rank the grid says that it belongs to.
    """

    def __init__(
        self, directory: Path, index: ArchiveIndex, grid: Grid, compression: str, ranks: Ranks
    ) -> None:
        self.directory = directory
        self.index = index
        self.compression = compression
        self.ranks = ranks
        self.grid = grid
        self._own = ranks.rank if ranks.size > 1 else None  # None for all

    @property
    def grid(self) -> Grid:
        """Grid of the time steps to come; ValueError where several ranks write and one of its patches has none."""
        return self._grid

    @grid.setter
    def grid(self, grid: Grid) -> None:
        if 1 < self.ranks.size < grid.number_of_processes:
            raise ValueError(f"{self.ranks.size} ranks write patches of {grid.number_of_processes}")
        self._grid = grid
        self.index.processes = max(self.index.processes, grid.number_of_processes)

    @property
    def is_first(self) -> bool:
        """Whether this rank writes what belongs to no patch, such as the table of contents."""
        return self.ranks.rank == 0

    def save_index(self) -> None:
        """Replace ``index.xml`` as a whole, on the first rank."""
        if not self.is_first:
            return
        path = self.directory / "index.xml"
        with storing(path, "write the table of contents"):
            replace_index(path, self.index)

    def write(self, timestep: Timestep, content: Content) -> None:
        """Store a time step, then name it in the table of contents."""
        if any(known.step == timestep.step for known in self.index.timesteps):
            raise ArchiveError(self.directory, f"step {timestep.step} is stored already")
        if len(content.levels) != len(self.grid.levels):
            raise ValueError(f"{len(content.levels)} levels given for a grid of {len(self.grid.levels)}")
        folder = self.directory / f"t{timestep.step:05d}"
        partial = folder.with_name(folder.name + ".partial")
        try:
            with together(self.ranks, folder), storing(folder, "write the time step"):
                self._check_types(content)
                if self.is_first:
                    self._begin_folder(partial)
            with together(self.ranks, folder), storing(folder, "write the time step"):
                self._write_levels(partial, content)
            with together(self.ranks, folder), storing(folder, "write the time step"):
                if self.is_first:
                    self._finish_folder(partial, folder, timestep, content)
        except BaseException:
            if self.is_first:
                shutil.rmtree(partial, ignore_errors=True)
            raise
        self._list_variables(content)
        self.index.timesteps.append(replace(timestep, href=f"{folder.name}/timestep.xml"))
        with together(self.ranks, self.directory):
            self.save_index()

    def _check_types(self, content: Content) -> None:
        """Make sure that a variable keeps its type from step to step, as readers take it for granted."""
        listed = {known.name: known.type_name for known in self.index.variables}
        for variable in (variable for fields in content.levels for variable in fields):
            before = listed.get(variable.name, variable.type_name)
            if before != variable.type_name:
                message = f"{variable.name} is a {variable.type_name}, but a {before} in earlier time steps"
                raise ArchiveError(self.directory, message, advice="write to another archive")

    def _begin_folder(self, partial: Path) -> None:
        """Make the folder of a time step and those of its levels, without what an earlier attempt left."""
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir()
        for level in self.grid.levels:
            (partial / f"l{level.index}").mkdir()

    def _write_levels(self, folder: Path, content: Content) -> None:
        """Write the tables and data of the patches of this rank, and what it wants for a restart."""
        for level, fields in zip(self.grid.levels, content.levels, strict=True):
            owners = {level.patches[position].proc for position in level.positions_of(self._own)}
            if not owners:
                continue
            places = _positions(fields, self.index.particle_position)
            if content.positions is not None:
                places = content.positions[level.index]
            share = _Share(level, self._own)
            stored = [_StoredVariable.make(share, v, by_material) for v, by_material in fields.items()]
            owned = {m: _Particles.make(share, m, where, folder) for m, where in places.items()}
            for proc in sorted(owners):
                self._write_rank(folder / f"l{level.index}", share, proc, stored, owned)
        if content.state is not None:
            _write_state(folder / state_file(self.ranks.rank), content.state)

    def _finish_folder(self, partial: Path, folder: Path, timestep: Timestep, content: Content) -> None:
        """Write what belongs to no patch, and give the folder its name."""
        if content.global_values:
            self._write_globals(partial, content.global_values)
        lines = timestep_lines(
            timestep, self.grid, has_globals=bool(content.global_values), sections=content.sections
        )
        _write_xml(partial / "timestep.xml", lines)
        if folder.exists():  # complete, but the run ended before it was named
            shutil.rmtree(folder)
        partial.rename(folder)

    def _write_rank(
        self,
        folder: Path,
        share: _Share,
        proc: int,
        stored: Sequence[_StoredVariable],
        particles: Mapping[int, _Particles],
    ) -> None:
        """Write the table and the data of the patches that one rank owns on one level."""
        name = f"p{proc:05d}"
        level = share.level
        with _BlockFile(folder / f"{name}.data", self.compression) as file:
            for variable in stored:
                for position in level.positions_of(proc):
                    for material, values in variable.values.items():
                        count = None
                        if variable.declaration.is_particle:
                            if material not in particles:
                                raise ValueError(
                                    f"{variable.declaration.name}: no positions for material {material}"
                                )
                            values = particles[material].of(variable.declaration, values, position)
                            count = len(values)
                        raw = variable.block(share, position, values)
                        file.add(variable.declaration, material, level.patches[position].id, raw, count)
        _write_xml(folder / f"{name}.xml", table_lines(file.entries), file.entries)

    def _write_globals(self, folder: Path, values: Fields) -> None:
        with _BlockFile(folder / "global.data", self.compression) as file:
            for variable, by_material in values.items():
                for material, value in by_material.items():
                    file.add(variable, material, -1, blocks.particle_bytes(variable.shaped(value, ())), None)
        _write_xml(folder / "global.xml", table_lines(file.entries), file.entries)

    def _list_variables(self, content: Content) -> None:
        for fields in content.levels:
            for variable, by_material in fields.items():
                _list_variable(self.index.variables, variable, len(by_material))
        for variable, by_material in (content.global_values or {}).items():
            _list_variable(self.index.globals_, variable, len(by_material))

    def keep(self, timesteps: Sequence[Timestep]) -> None:
        """Remove all other time steps, first from the table of contents, then from the disk."""
        gone = [timestep for timestep in self.index.timesteps if timestep not in timesteps]
        self.index.timesteps = list(timesteps)
        with together(self.ranks, self.directory):
            self.save_index()
            for timestep in gone if self.is_first else ():
                shutil.rmtree((self.directory / timestep.href).parent, ignore_errors=True)

    def drop_after(self, step: int) -> None:
        """Remove the time steps later than `step`."""
        self.keep([timestep for timestep in self.index.timesteps if timestep.step <= step])


def replace_index(path: Path, index: ArchiveIndex) -> None:
    """Write a table of contents, which is at any moment the old one or the new one, with its checksum."""
    raw = ("\n".join(index.lines()) + "\n").encode()
    checksums.save(path, raw, present=path.read_bytes() if path.exists() else None)
    partial = path.with_suffix(".partial")
    partial.write_bytes(raw)
    partial.replace(path)


def _write_xml(path: Path, lines: Sequence[str], entries: Sequence[Entry] = ()) -> None:
    """Write an XML file, and beside it the checksums of it and of the blocks that it lists."""
    raw = ("\n".join(lines) + "\n").encode()
    path.write_bytes(raw)
    checksums.save(path, raw, [entry.checksum for entry in entries])


def _write_state(path: Path, state: Mapping[str, npt.ArrayLike]) -> None:
    """Write arrays by name into a file that `numpy.load` reads."""
    import zipfile  # here, as only checkpoints are in this form

    with zipfile.ZipFile(path, "w") as archive:
        for name, value in state.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.asarray(value), allow_pickle=False)


def _list_variable(listing: list[Listed], variable: Variable, materials: int) -> None:
    """Add a variable to a list, or raise its number of materials there."""
    for position, listed in enumerate(listing):
        if listed.name == variable.name:
            listing[position] = replace(listed, materials=max(materials, listed.materials))
            return
    listing.append(Listed(variable.name, variable.type_name, materials))


def _positions(fields: Fields, label: str) -> Positions:
    """Positions of the particles as `fields` has them, empty where it has none."""
    return next((values for variable, values in fields.items() if variable.name == label), {})


@dataclass(frozen=True)
class _Share:
    """The patches of a level that are written here: those of one rank, or (None) all."""

    level: Level
    rank: int | None

    @cached_property
    def positions(self) -> list[int]:
        """Their positions among the patches of the level."""
        return self.level.positions_of(self.rank)

    def box(self, container: str) -> Box:
        """The box around what they store."""
        return self.level.whole(container, rank=self.rank)


@dataclass(frozen=True)
class _StoredVariable:
    """A variable of a level with its values checked and of the stored type, materials ascending."""

    declaration: Variable
    values: dict[int, np.ndarray]

    @classmethod
    def make(
        cls, share: _Share, variable: Variable, by_material: Mapping[int, npt.ArrayLike]
    ) -> _StoredVariable:
        values = {}
        for material in sorted(by_material):
            if material < 0:
                raise ValueError(f"{variable.name}: material {material} on a level")
            given = np.asarray(by_material[material])
            values[material] = variable.shaped(given, _outer_shape(share, variable, given))
        return cls(variable, values)

    def block(self, share: _Share, position: int, values: np.ndarray) -> memoryview | bytes:
        """Bytes of one patch; `values` are the patch's own particles, or the array over the share."""
        variable = self.declaration
        if variable.is_grid:
            box = share.level.extent(position, variable.container)
            return blocks.grid_bytes(values[box.within(share.box(variable.container).low)])
        if variable.container == PER_PATCH:
            values = values[share.positions.index(position)]
        return blocks.particle_bytes(values)


def _outer_shape(share: _Share, variable: Variable, given: np.ndarray) -> tuple[int, ...]:
    """Shape that the values of a variable must have, the element's own apart."""
    if variable.is_grid:
        return share.box(variable.container).shape
    if variable.container == PER_PATCH:
        return (len(share.positions),)
    if not variable.is_particle:
        raise ValueError(f"{variable.name}: a {variable.container} does not belong to a level")
    return given.shape[:1]


@dataclass(frozen=True)
class _Particles:
    """How the particles of a material are shared out among the patches of a level.

    `order` lists the particles patch by patch, in their own order within each (None: all are in the
    only patch); those of the patch at position p are ``order[bounds[p] : bounds[p + 1]]``.
    """

    order: np.ndarray | None
    bounds: np.ndarray

    @classmethod
    def make(cls, share: _Share, material: int, positions: npt.ArrayLike, folder: Path) -> _Particles:
        level = share.level
        points = np.asarray(positions, dtype=float).reshape(-1, 3)
        owners = level.nearest_patch(points)
        if (owners < 0).any():
            lost = int(np.argmax(owners < 0))
            raise ArchiveError(
                folder.with_suffix(""),
                f"{np.count_nonzero(owners < 0)} particles of material {material} are nowhere on the grid, "
                f"the first at {points[lost].tolist()}",
                advice="positions that are not numbers come from an unstable run: try a smaller time step",
            )
        strange = ~np.isin(owners, share.positions)
        if strange.any():
            patch = level.patches[int(owners[np.argmax(strange)])]
            raise ValueError(
                f"{np.count_nonzero(strange)} particles of material {material} are not in the patches of rank "
                f"{share.rank}, the first in patch {patch.id} of rank {patch.proc}"
            )
        counts = np.bincount(owners, minlength=len(level.patches))
        order = np.argsort(owners, kind="stable") if len(level.patches) > 1 else None
        return cls(order, np.concatenate([[0], np.cumsum(counts)]))

    def of(self, variable: Variable, values: np.ndarray, position: int) -> np.ndarray:
        """Values of the particles of one patch."""
        if len(values) != self.bounds[-1]:
            raise ValueError(f"{variable.name} has {len(values)} values for {self.bounds[-1]} particles")
        if self.order is None:
            return values
        return values[self.order[self.bounds[position] : self.bounds[position + 1]]]


class _BlockFile:
    """A data file that grows block by block, and the entries of its table."""

    def __init__(self, path: Path, compression: str) -> None:
        self.entries: list[Entry] = []
        self._path = path
        self._compression = compression
        self._offset = 0
        self._file = path.open("wb")

    def add(
        self, variable: Variable, material: int, patch: int, raw: memoryview | bytes, particles: int | None
    ) -> None:
        """Append a block, compressed where the variable or else the archive says so."""
        if len(raw) > blocks.LARGEST_BLOCK:
            raise ArchiveError(
                self._path,
                f"{variable.name} of patch {patch} takes {len(raw)} bytes, more than Uintah reads at once",
                advice="divide the level into more patches",
            )
        compression = variable.compression or self._compression
        compression = "" if compression == "none" else compression
        if compression:
            raw = blocks.compress(raw)
        gap = blocks.padding(self._offset)
        self._file.write(bytes(gap))
        self._file.write(raw)
        start = self._offset + gap
        self._offset = start + len(raw)
        self.entries.append(
            Entry(
                name=variable.name,
                type_name=variable.type_name,
                material=material,
                patch=patch,
                start=start,
                end=self._offset,
                filename=self._path.name,
                compression=compression,
                particles=particles,
                checksum=checksums.text(checksums.crc32(raw)),
            )
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
