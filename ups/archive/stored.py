"""One stored time step of an archive: finding, checking and decoding its blocks."""

from __future__ import annotations

import math
import mmap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from ups.archive import blocks, checksums
from ups.archive.errors import ArchiveError
from ups.archive.index import ArchiveIndex, Timestep
from ups.archive.layout import Box, Level
from ups.archive.table import Entry, read_table
from ups.archive.timestep import TimestepFile, contradictions, read_timestep
from ups.archive.variables import ELEMENTS, PARTICLE, Variable


def state_file(rank: int) -> str:
    """File of a checkpoint that holds what only this program needs for a restart, of one rank."""
    return f"restart.{rank:05d}.npz" if rank else "restart.npz"


_MAPPED_FROM = 1 << 20
"""Blocks of at least this many bytes are mapped into memory, smaller ones read: a map takes a file handle.

What is read is held against its checksum; what is mapped only by `StoredTimestep.problems`, as it would be read.
"""

_CUT_OFF = "the archive is damaged or was cut off while it was written; other time steps may be whole"


@dataclass
class LevelTable:
    """The blocks of one level.

    Attributes
    ----------
    patches
        Numbers of the patches of the level.
    entries
        Blocks by label, then by material and patch number.
    particles
        Number of particles by material and patch number.
    """

    patches: range
    entries: dict[str, dict[tuple[int, int], Entry]] = field(default_factory=dict)
    particles: dict[tuple[int, int], int] = field(default_factory=dict)

    def add(self, path: Path, entry: Entry) -> None:
        """Take an entry of the file `path` in; of two for the same block the first counts, as in Uintah."""
        if entry.patch not in self.patches:
            message = f"{entry.name} is said to be on patch {entry.patch}, which is not on this level"
            raise ArchiveError(path, message, line=entry.line, advice=_CUT_OFF)
        key = (entry.material, entry.patch)
        self.entries.setdefault(entry.name, {}).setdefault(key, entry)
        if not entry.type_name.startswith(PARTICLE):
            return
        if entry.particles is None:
            raise ArchiveError(path, f"{entry.name} has no <numParticles>", line=entry.line, advice=_CUT_OFF)
        if self.particles.setdefault(key, entry.particles) != entry.particles:
            message = f"{entry.name} has {entry.particles} particles, other variables {self.particles[key]}"
            raise ArchiveError(path, message, line=entry.line, advice=_CUT_OFF)


class StoredTimestep:
    """One stored time step, read as it is asked for.

    Parameters
    ----------
    path
        Its ``timestep.xml``.
    index
        Table of contents of the archive.
    timestep
        The step as the table of contents lists it.
    """

    def __init__(self, path: Path, index: ArchiveIndex, timestep: Timestep) -> None:
        self.path = path
        self.timestep = timestep
        self._index = index
        self._types = {listed.name: listed.type_name for listed in index.variables}
        self._tables: dict[int, LevelTable] = {}
        self._maps: dict[Path, mmap.mmap] = {}

    @cached_property
    def file(self) -> TimestepFile:
        """What ``timestep.xml`` says."""
        return read_timestep(self.path, self._index, self.timestep)

    @property
    def levels(self) -> tuple[Level, ...]:
        """Levels of the grid."""
        return self.file.grid.levels

    def table(self, level: int) -> LevelTable:
        """Blocks of a level."""
        if level not in self._tables:
            patches = self.levels[level].patches
            table = LevelTable(range(patches[0].id, patches[-1].id + 1))
            for proc in sorted({patch.proc for patch in patches}):
                path = self._folder(level) / f"p{proc:05d}.xml"
                for entry in read_table(path):
                    table.add(path, entry)
            self._tables[level] = table
        return self._tables[level]

    def _folder(self, level: int) -> Path:
        return self.path.parent / f"l{level}"

    def variable(self, entry: Entry) -> Variable:
        """Declaration of the variable that a block belongs to.

        Raises
        ------
        ArchiveError
            Where the type is unknown or not the one of the table of contents.
        """
        if self._types.get(entry.name, entry.type_name) != entry.type_name:
            message = f"{entry.name} is a {entry.type_name}, but index.xml says {self._types[entry.name]}"
            raise ArchiveError(self.path.parent, message, line=entry.line, advice=_CUT_OFF)
        try:
            return Variable.from_type(entry.name, entry.type_name, entry.compression)
        except ValueError as error:
            raise ArchiveError(self.path.parent, str(error), advice="choose other variables") from None

    def problems(self, *, values: bool) -> Iterator[ArchiveError]:
        """Everything that is wrong with the step: files, tables, blocks that are missing or cut off.

        Parameters
        ----------
        values
            Whether to decode every block too, which finds damage inside compressed ones.
        """
        try:
            levels = self.levels
        except ArchiveError as error:
            yield error
            return
        if self.file.time is not None and not math.isclose(self.file.time, self.timestep.time, rel_tol=1e-12):
            message = f"this is time {self.file.time:.9g}, but index.xml says {self.timestep.time:.9g}"
            yield ArchiveError(self.path, message, advice=_CUT_OFF)
        yield from contradictions(self.path, self.file.grid)
        try:
            self.global_values()
        except ArchiveError as error:
            yield error
        for level in levels:
            try:
                table = self.table(level.index)
            except ArchiveError as error:
                yield error
                continue
            for label, entries in table.entries.items():
                if label not in self._types:
                    message = f"{label} is stored, but index.xml does not list it"
                    yield ArchiveError(self.path.parent, message, advice=_CUT_OFF)
                yield from self._gaps(level, label, entries, table.particles)
                for entry in entries.values():
                    try:
                        self._check(level.index, entry, values)
                    except ArchiveError as error:
                        yield error

    def _gaps(
        self,
        level: Level,
        label: str,
        entries: Mapping[tuple[int, int], Entry],
        particles: Mapping[tuple[int, int], int],
    ) -> Iterator[ArchiveError]:
        """Blocks of a variable that must be there and are not; old archives omit those without particles."""
        on_particles = next(iter(entries.values())).type_name.startswith(PARTICLE)
        for material in sorted({material for material, _patch in entries}):
            lacking = [
                patch.id
                for patch in level.patches
                if (material, patch.id) not in entries
                and (not on_particles or particles.get((material, patch.id), 0) > 0)
            ]
            if lacking:
                message = f"{label} of material {material} is missing on the patches {lacking[:5]}"
                yield ArchiveError(self.path, message, advice=_CUT_OFF)

    def _check(self, level: int, entry: Entry, values: bool) -> None:
        """Raise where a block is not whole; one of an unknown type is only looked for in its file."""
        if values:
            path = self._folder(level) / entry.filename
            _verify(path, entry, self._stored(path, entry, entry.name))
        if ELEMENTS.get(entry.type_name.partition("<")[2].rstrip("> ")) is None:
            self._stored(self._folder(level) / entry.filename, entry, entry.name)
        elif values or not entry.compression:
            if self.variable(entry).is_particle:
                self.particle_block(level, entry)
            elif self.variable(entry).is_grid:
                self.grid_block(level, entry)
            else:
                self.patch_block(level, entry)
        else:
            self._stored(self._folder(level) / entry.filename, entry, entry.name)

    def particle_block(self, level: int, entry: Entry) -> np.ndarray:
        """Values of the particles of a block, shape (n, element...)."""
        element, count = self.variable(entry).element_type, entry.particles or 0
        raw = self._plain(self._folder(level), entry, count * element.nbytes)
        return _native(blocks.particles_from_bytes(raw, element, self.file.byte_order, count))

    def patch_block(self, level: int, entry: Entry) -> np.ndarray:
        """Value of a per-patch variable."""
        element = self.variable(entry).element_type
        raw = self._plain(self._folder(level), entry, element.nbytes)
        return _native(blocks.particles_from_bytes(raw, element, self.file.byte_order, 1))[0]

    def grid_block(self, level: int, entry: Entry) -> tuple[Box, np.ndarray]:
        """Indices and values of a block of a grid variable, indexed [x, y, z, component...]."""
        variable, lattice = self.variable(entry), self.levels[level]
        position = entry.patch - lattice.patches[0].id
        box = lattice.extent(position, variable.container, entry.boundary_layer)
        element = variable.element_type
        raw = self._plain(self._folder(level), entry, box.size * element.nbytes)
        return box, _native(blocks.grid_from_bytes(raw, element, self.file.byte_order, box.shape))

    def global_values(self) -> dict[str, dict[int, np.ndarray]]:
        """Values of a checkpoint that belong to no patch, by label and material (-1 for none)."""
        path = self.path.with_name("global.xml")
        found: dict[str, dict[int, np.ndarray]] = {}
        for entry in read_table(path) if path.exists() else []:
            element = self.variable_of_global(entry).element_type
            raw = self._plain(path.parent, entry, element.nbytes)
            value = _native(blocks.particles_from_bytes(raw, element, self.file.byte_order, 1))[0]
            found.setdefault(entry.name, {})[entry.material] = value
        return found

    def variable_of_global(self, entry: Entry) -> Variable:
        """Declaration of a global; its size decides where Uintah gives the wrong type.

        Uintah calls every SoleVariable one of ``int``, also those that hold a double.
        """
        variable = self.variable(entry)
        stored = entry.end - entry.start
        if not entry.compression and stored != variable.element_type.nbytes == ELEMENTS["int"].nbytes:
            return Variable(entry.name, variable.container, "double")
        return variable

    def state(self, rank: int = 0) -> dict[str, np.ndarray]:
        """Arrays that a rank of this program left for a restart, by name."""
        path = self.path.with_name(state_file(rank))
        try:
            with np.load(path, allow_pickle=False) as stored:
                return {name: stored[name] for name in stored.files}
        except FileNotFoundError as error:
            message = "the checkpoint holds no state of this program"
            raise ArchiveError(path, message, advice="restart it with the program that wrote it") from error
        except Exception as error:  # a damaged file raises whatever its bits ask for: "is encrypted", ...
            raise ArchiveError(path, f"cannot be read: {error}", advice=_CUT_OFF) from error

    def _plain(self, folder: Path, entry: Entry, size: int) -> memoryview | bytes:
        """Bytes of a block, decompressed; there must be `size` of them."""
        path = folder / entry.filename
        stored = entry.end - entry.start
        if size == 0 and stored == 0:
            return b""
        where = f"{entry.name} of material {entry.material}, patch {entry.patch}"
        if not entry.compression and stored != size:
            message = f"{where} has {stored} bytes where {size} are due"
            raise ArchiveError(path, message, offset=entry.start, advice=_CUT_OFF)
        raw = self._stored(path, entry, where)
        if not entry.compression:
            return raw
        try:
            return blocks.decompress(raw, self.file.byte_order, self.file.size_bytes, size)
        except ValueError as error:
            raise ArchiveError(path, f"{where}: {error}", offset=entry.start, advice=_CUT_OFF) from None

    def _stored(self, path: Path, entry: Entry, where: str) -> memoryview | bytes:
        """Bytes of a block as they are in the file."""
        try:
            with path.open("rb") as file:
                length = file.seek(0, 2)
                if entry.end > length:
                    message = f"the file ends at byte {length}, but {where} reaches to byte {entry.end}"
                    raise ArchiveError(path, message, offset=entry.start, advice=_CUT_OFF)
                if entry.end - entry.start < _MAPPED_FROM:
                    file.seek(entry.start)
                    raw = file.read(entry.end - entry.start)
                    _verify(path, entry, raw)
                    return raw
                if path not in self._maps:
                    self._maps[path] = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
                return memoryview(self._maps[path])[entry.start : entry.end]
        except OSError as error:
            raise ArchiveError.from_os_error(path, "read the data", error) from error


def _verify(path: Path, entry: Entry, raw: memoryview | bytes) -> None:
    """Raise where a block is not as its checksum says."""
    if entry.checksum and checksums.text(checksums.crc32(raw)) != entry.checksum:
        message = (
            f"{entry.name} of material {entry.material}, patch {entry.patch} was changed after it was written"
        )
        raise ArchiveError(path, message, offset=entry.start, advice=_CUT_OFF)


def _native(values: np.ndarray) -> np.ndarray:
    """Return the same values in the byte order of this machine."""
    return values.astype(values.dtype.newbyteorder("="), copy=False)


def blocks_of(entries: Mapping[tuple[int, int], Entry], material: int) -> dict[int, Entry]:
    """Blocks of one material by patch number."""
    return {patch: entry for (index, patch), entry in entries.items() if index == material}
