"""A directory of stored time steps: an archive's own, or that of its checkpoints."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
import numpy.typing as npt
from lxml import etree

from ups.archive import blocks
from ups.archive.errors import ArchiveError
from ups.archive.index import ArchiveIndex, Listed, Timestep
from ups.archive.layout import Grid, Level
from ups.archive.stored import STATE_FILE
from ups.archive.table import Entry, table_lines
from ups.archive.timestep import timestep_lines
from ups.archive.variables import PER_PATCH, Variable

Fields = Mapping[Variable, Mapping[int, npt.ArrayLike]]
"""Values of one level by variable and material, in the order in which they are to be stored.

Particle variables: shape (n, element...). Node, cell and face variables: an array over the whole
level, of the shape of `Level.whole` and indexed [x, y, z, component...]. Per-patch variables: shape
(patches, element...). A matrix may be given as (..., 3, 3) or (..., 9).
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
    """A directory of time steps and its table of contents: the archive's own, or its checkpoints'."""

    def __init__(self, directory: Path, index: ArchiveIndex, grid: Grid, compression: str) -> None:
        self.directory = directory
        self.index = index
        self.grid = grid
        self.compression = compression

    def save_index(self) -> None:
        """Replace ``index.xml`` as a whole."""
        path = self.directory / "index.xml"
        with storing(path, "write the table of contents"):
            _write_lines(path.with_suffix(".partial"), self.index.lines())
            path.with_suffix(".partial").replace(path)

    def write(self, timestep: Timestep, content: Content) -> None:
        """Store a time step, then name it in the table of contents."""
        if any(known.step == timestep.step for known in self.index.timesteps):
            raise ArchiveError(self.directory, f"step {timestep.step} is stored already")
        if len(content.levels) != len(self.grid.levels):
            raise ValueError(f"{len(content.levels)} levels given for a grid of {len(self.grid.levels)}")
        self._check_types(content)
        folder = self.directory / f"t{timestep.step:05d}"
        partial = folder.with_name(folder.name + ".partial")
        with storing(folder, "write the time step"):
            shutil.rmtree(partial, ignore_errors=True)
            try:
                partial.mkdir()
                self._write_folder(partial, timestep, content)
                if folder.exists():  # complete, but the run ended before it was named
                    shutil.rmtree(folder)
                partial.rename(folder)
            except BaseException:
                shutil.rmtree(partial, ignore_errors=True)
                raise
        self._list_variables(content)
        self.index.timesteps.append(replace(timestep, href=f"{folder.name}/timestep.xml"))
        self.save_index()

    def _check_types(self, content: Content) -> None:
        """Make sure that a variable keeps its type from step to step, as readers take it for granted."""
        listed = {known.name: known.type_name for known in self.index.variables}
        for variable in (variable for fields in content.levels for variable in fields):
            before = listed.get(variable.name, variable.type_name)
            if before != variable.type_name:
                message = f"{variable.name} is a {variable.type_name}, but a {before} in earlier time steps"
                raise ArchiveError(self.directory, message, advice="write to another archive")

    def _write_folder(self, folder: Path, timestep: Timestep, content: Content) -> None:
        for level, fields in zip(self.grid.levels, content.levels, strict=True):
            places = _positions(fields, self.index.particle_position)
            if content.positions is not None:
                places = content.positions[level.index]
            subfolder = folder / f"l{level.index}"
            subfolder.mkdir()
            stored = [_StoredVariable.make(level, v, by_material) for v, by_material in fields.items()]
            shares = {m: _Shares.make(level, m, where, folder) for m, where in places.items()}
            for proc in sorted({patch.proc for patch in level.patches}):
                self._write_rank(subfolder, level, proc, stored, shares)
        if content.global_values:
            self._write_globals(folder, content.global_values)
        if content.state is not None:
            _write_state(folder / STATE_FILE, content.state)
        lines = timestep_lines(
            timestep, self.grid, has_globals=bool(content.global_values), sections=content.sections
        )
        _write_lines(folder / "timestep.xml", lines)

    def _write_rank(
        self,
        folder: Path,
        level: Level,
        proc: int,
        stored: Sequence[_StoredVariable],
        shares: Mapping[int, _Shares],
    ) -> None:
        """Write the table and the data of the patches that one rank owns on one level."""
        name = f"p{proc:05d}"
        owned = [position for position, patch in enumerate(level.patches) if patch.proc == proc]
        with _BlockFile(folder / f"{name}.data", self.compression) as file:
            for variable in stored:
                for position in owned:
                    for material, values in variable.values.items():
                        count = None
                        if variable.declaration.is_particle:
                            if material not in shares:
                                raise ValueError(
                                    f"{variable.declaration.name}: no positions for material {material}"
                                )
                            values = shares[material].of(variable.declaration, values, position)
                            count = len(values)
                        raw = variable.block(level, position, values)
                        file.add(variable.declaration, material, level.patches[position].id, raw, count)
        _write_lines(folder / f"{name}.xml", table_lines(file.entries))

    def _write_globals(self, folder: Path, values: Fields) -> None:
        with _BlockFile(folder / "global.data", self.compression) as file:
            for variable, by_material in values.items():
                for material, value in by_material.items():
                    file.add(variable, material, -1, blocks.particle_bytes(variable.shaped(value, ())), None)
        _write_lines(folder / "global.xml", table_lines(file.entries))

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
        self.save_index()
        for timestep in gone:
            shutil.rmtree((self.directory / timestep.href).parent, ignore_errors=True)

    def drop_after(self, step: int) -> None:
        """Remove the time steps later than `step`."""
        self.keep([timestep for timestep in self.index.timesteps if timestep.step <= step])


def _write_lines(path: Path, lines: Sequence[str]) -> None:
    path.write_bytes(("\n".join(lines) + "\n").encode())


def _write_state(path: Path, state: Mapping[str, npt.ArrayLike]) -> None:
    """Write arrays by name into a file that `numpy.load` reads."""
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
class _StoredVariable:
    """A variable of a level with its values checked and of the stored type, materials ascending."""

    declaration: Variable
    values: dict[int, np.ndarray]

    @classmethod
    def make(
        cls, level: Level, variable: Variable, by_material: Mapping[int, npt.ArrayLike]
    ) -> _StoredVariable:
        values = {}
        for material in sorted(by_material):
            if material < 0:
                raise ValueError(f"{variable.name}: material {material} on a level")
            given = np.asarray(by_material[material])
            values[material] = variable.shaped(given, _outer_shape(level, variable, given))
        return cls(variable, values)

    def block(self, level: Level, position: int, values: np.ndarray) -> memoryview | bytes:
        """Bytes of one patch; `values` are the patch's own particles, or the whole level's array."""
        variable = self.declaration
        if variable.is_grid:
            origin = level.whole(variable.container).low
            return blocks.grid_bytes(values[level.extent(position, variable.container).within(origin)])
        return blocks.particle_bytes(values[position] if variable.container == PER_PATCH else values)


def _outer_shape(level: Level, variable: Variable, given: np.ndarray) -> tuple[int, ...]:
    """Shape that the values of a variable on a level must have, the element's own apart."""
    if variable.is_grid:
        return level.whole(variable.container).shape
    if variable.container == PER_PATCH:
        return (len(level.patches),)
    if not variable.is_particle:
        raise ValueError(f"{variable.name}: a {variable.container} does not belong to a level")
    return given.shape[:1]


@dataclass(frozen=True)
class _Shares:
    """How the particles of a material are shared out among the patches of a level.

    `order` lists the particles patch by patch, in their own order within each (None: all are in the
    only patch); those of the patch at position p are ``order[bounds[p] : bounds[p + 1]]``.
    """

    order: np.ndarray | None
    bounds: np.ndarray

    @classmethod
    def make(cls, level: Level, material: int, positions: npt.ArrayLike, folder: Path) -> _Shares:
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
            )
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
