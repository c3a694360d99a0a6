"""Reading archives.

Nothing is read before it is asked for, and large uncompressed blocks are mapped into memory instead
of copied. Archives of any age, byte order, compression and number of ranks and levels are read.

>>> archive = Archive("bar.uda")                                      # doctest: +SKIP
>>> last = archive.timesteps[-1]                                      # doctest: +SKIP
>>> stress = archive.particles(last.step, "p.stress", material=0)     # doctest: +SKIP
>>> mass = archive.grid_variable(last.step, "g.mass", material=0)     # doctest: +SKIP
>>> mass.values.sum(), archive.reductions["TotalMass"].values[-1]     # doctest: +SKIP
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from lxml import etree

from ups.archive.errors import ArchiveError
from ups.archive.index import ArchiveIndex, Timestep, read_index
from ups.archive.layout import Box, Grid, IntVector, Level
from ups.archive.measures import Named, find
from ups.archive.reductions import Reduction, read_history
from ups.archive.stored import StoredTimestep, blocks_of
from ups.archive.table import Entry
from ups.archive.units import plain_name
from ups.archive.variables import FACES, GLOBAL_MATERIAL, NODE, PER_PATCH, Variable
from ups.diagnostics import did_you_mean

if TYPE_CHECKING:
    from ups.archive.tracks import Track

_STEPS_KEPT = 16
"""Time steps whose tables are kept in memory."""

PART = 1 << 16
"""Particles that are worked on at a time where a step is to be streamed."""


@dataclass(frozen=True)
class GridField:
    """A node, cell or face variable over a whole level.

    Attributes
    ----------
    values
        Indexed [x, y, z, component...]. Where the patches do not fill the box around them, numbers
        are NaN and integers zero.
    box
        Indices that `values` covers, extra cells included.
    level
        The level.
    variable
        Declaration of the variable.
    """

    values: np.ndarray
    box: Box
    level: Level
    variable: Variable

    @property
    def origin(self) -> IntVector:
        """Index of the first value."""
        return self.box.low

    @property
    def interior(self) -> Box:
        """Indices of the values that are not in extra cells."""
        low, high = self.level.interior
        site, periodic = self.variable.container, self.level.periodic
        closing = [site in (NODE, FACES[axis]) and not periodic[axis] for axis in range(3)]
        return Box(low, (high[0] + closing[0], high[1] + closing[1], high[2] + closing[2]))

    @property
    def coordinates(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions of the values along each axis."""
        return self.level.coordinates(self.variable.container, self.box)


class Archive:
    """An archive on the disk.

    Time steps are named by their number; -1 is the last stored, -2 the one before, and so on.
    Every method raises `ArchiveError` where the archive does not hold what is asked for or is
    damaged at that place.

    Parameters
    ----------
    path
        The archive: its folder, a link to it, or its ``index.xml``.

    Attributes
    ----------
    path
        The folder.
    index
        Its table of contents.
    """

    def __init__(self, path: str | Path) -> None:
        path = Path(path)
        self.path = path.parent if path.name == "index.xml" else path
        if not (self.path / "index.xml").is_file():
            raise ArchiveError(self.path, "not an archive: there is no index.xml", advice="check the path")
        self.index: ArchiveIndex = read_index(self.path / "index.xml")
        self._stored: OrderedDict[int, StoredTimestep] = OrderedDict()
        self._lock = Lock()
        self._histories: Mapping[str, Reduction] = _Histories(self)

    def __repr__(self) -> str:
        return f"Archive({str(self.path)!r}, {len(self.timesteps)} time steps)"

    @property
    def timesteps(self) -> tuple[Timestep, ...]:
        """Stored time steps in the order of the archive."""
        return tuple(self.index.timesteps)

    @cached_property
    def variables(self) -> dict[str, Variable]:
        """Particle, grid and per-patch variables by label, apart from those in `unsupported`."""
        return {
            listed.name: Variable.from_type(listed.name, listed.type_name)
            for listed in self.index.variables
            if listed.name not in self.unsupported
        }

    @cached_property
    def unsupported(self) -> dict[str, str]:
        """Types by label of variables whose element type is unknown."""
        found = {}
        for listed in self.index.variables:
            try:
                Variable.from_type(listed.name, listed.type_name)
            except ValueError:
                found[listed.name] = listed.type_name
        return found

    def find(self, name: str) -> Named:
        """Find what a name stands for: ``p.stress``, ``stress``, ``stress:vonMises``, ``speed``.

        Raises
        ------
        ArchiveError
            Where there is no such variable, or it has no such measure.
        """
        try:
            return find(name, self.variables)
        except LookupError as error:
            label = name.partition(":")[0]
            names = {alias for known in self.variables for alias in (known, plain_name(known))}
            nearest = did_you_mean(label, sorted(names))
            there = f"there are: {', '.join(self.variables) or 'none'}"
            advice = f"did you mean {nearest}? {there}" if nearest else there
            message = error.args[0]
            raise ArchiveError(self.path, message, advice="" if "; " in message else advice) from None

    @property
    def reductions(self) -> Mapping[str, Reduction]:
        """Histories by name, a material's with its index behind (``rho_1``); each read when taken."""
        return self._histories

    @cached_property
    def checkpoints(self) -> Archive | None:
        """The checkpoints, an archive by itself, or None where there are none."""
        folder = self.path / "checkpoints"
        return Archive(folder) if (folder / "index.xml").is_file() else None

    def with_earlier_runs(self) -> Archive:
        """Return this archive with what came before it, where its run was taken up from another archive.

        Uintah's restart begins a new archive. The earlier ones, where they are still found where this one
        says, or beside it, give the time steps and the lines of the histories up to its own.
        """
        from ups.archive.restarts import with_earlier_runs

        return with_earlier_runs(self)

    def timestep(self, step: int) -> Timestep:
        """Stored time step of the number `step`, or counted from the last where negative."""
        if step < 0:
            if len(self.timesteps) + step >= 0:
                return self.timesteps[step]
            raise ArchiveError(self.path, f"there are only {len(self.timesteps)} time steps")
        for timestep in self.timesteps:
            if timestep.step == step:
                return timestep
        stored = ", ".join(str(timestep.step) for timestep in self.timesteps) or "none"
        raise ArchiveError(self.path, f"time step {step} is not stored", advice=f"there are: {stored}")

    def grid(self, step: int = -1) -> Grid:
        """Levels and patches at a time step."""
        return self._step(step).file.grid

    def problems(self, step: int, *, values: bool = False) -> list[ArchiveError]:
        """Everything that is wrong with a time step: missing or cut off files, tables and blocks.

        Parameters
        ----------
        step
            Number of the time step.
        values
            Whether to read every block, which also finds damage inside compressed ones; else only the
            tables and the sizes of the files are looked at.
        """
        return list(self._step(step).problems(values=values))

    def sections(self, step: int) -> tuple[etree._Element, ...]:
        """XML elements that components left in ``timestep.xml``."""
        return self._step(step).file.sections

    def state(self, step: int, rank: int = 0) -> dict[str, np.ndarray]:
        """Arrays that a rank gave `ArchiveWriter.write_checkpoint` as ``state``."""
        return self._step(step).state(rank)

    def global_values(self, step: int) -> dict[str, dict[int, np.ndarray]]:
        """Values of a checkpoint that belong to no patch, by label and material (-1 for none)."""
        return self._step(step).global_values()

    def labels(self, step: int) -> list[str]:
        """Labels of the variables that a time step holds, in the order of the archive."""
        stored = self._step(step)
        return list(
            dict.fromkeys(name for level in stored.levels for name in stored.table(level.index).entries)
        )

    def materials(self, step: int, label: str | None = None, level: int | None = None) -> list[int]:
        """Materials of one variable (or of a measure of one), or of all, on one level, or on all."""
        label = None if label is None else self._source(label)
        stored = self._step(step)
        tables = [stored.table(lattice.index) for lattice in stored.levels if level in (None, lattice.index)]
        return sorted(
            {
                material
                for table in tables
                for name, entries in table.entries.items()
                if label in (None, name)
                for material, _patch in entries
            }
        )

    def particle_count(self, step: int, material: int) -> int:
        """Number of particles of a material."""
        stored = self._step(step)
        counts = (stored.table(level.index).particles for level in stored.levels)
        return sum(count for table in counts for (index, _patch), count in table.items() if index == material)

    def particles(
        self, step: int, label: str, material: int | None = None, patch: int | None = None
    ) -> np.ndarray:
        """Values of a particle variable, shape (n, element...).

        The order is by material, level and patch, and the same for all variables that are stored for
        the same materials. An array may be a read-only view of the file.

        Parameters
        ----------
        step
            Number of the time step.
        label
            Label of the variable, with or without its prefix, perhaps with a measure: ``p.stress:vonMises``.
        material
            Material, or None for all that the variable is stored for.
        patch
            Number of the patch, or None for all.
        """
        if self._source(label) != label:
            named = self.find(label)
            return _measured(self.particles(step, named.source.name, material, patch), named)
        return _joined(
            list(self._particle_blocks(step, label, material, patch)), self._declared(self._step(step), label)
        )

    def particle_parts(self, step: int, label: str, material: int) -> Iterator[np.ndarray]:
        """Values of a particle variable of a material, `PART` particles or fewer at a time.

        The parts follow each other as in `particles`; those of all variables of the material have the same
        lengths. Of a mapped block only the present part is in memory, and measures are computed by the part.
        """
        named = self.find(label)
        for block in self._particle_blocks(step, named.source.name, material, None):
            for start in range(0, len(block), PART):
                yield _measured(block[start : start + PART], named)

    def _particle_blocks(
        self, step: int, label: str, material: int | None, patch: int | None
    ) -> Iterator[np.ndarray]:
        """Blocks of a particle variable by material, level and patch."""
        stored = self._step(step)
        self._declared(stored, label)
        there = self.materials(step, label)
        if material is not None and material not in there:
            raise self._absent(stored, label, material)
        for index in there if material is None else [material]:
            for level in stored.levels:
                entries = blocks_of(stored.table(level.index).entries.get(label, {}), index)
                self._check_particles(stored, level, label, index, entries)
                for number in sorted(entries) if patch is None else sorted({patch} & set(entries)):
                    yield stored.particle_block(level.index, entries[number])

    def grid_variable(self, step: int, label: str, material: int, level: int = 0) -> GridField:
        """Return a node, cell or face variable of a material, put together over the patches of a level.

        The array may be a read-only view of the file where there is only one patch. The label may name a
        measure: ``g.stressFS:vonMises``.
        """
        if self._source(label) != label:
            named = self.find(label)
            stored_field = self.grid_variable(step, named.source.name, material, level)
            values = _measured(stored_field.values, named)
            return replace(stored_field, values=values, variable=named.declaration)
        stored = self._step(step)
        lattice, entries = self._on_level(stored, label, material, level)
        variable = stored.variable(next(iter(entries.values())))
        if not variable.is_grid:
            raise ArchiveError(stored.path, f"{label} is a {variable.type_name}, not on the grid")
        whole = lattice.whole(variable.container, next(iter(entries.values())).boundary_layer)
        found = [stored.grid_block(level, entries[patch.id]) for patch in lattice.patches]
        if len(found) == 1:
            return GridField(found[0][1], whole, lattice, variable)
        first = found[0][1]
        fill = np.nan if first.dtype.kind == "f" else 0
        trailing = first.shape[3:]
        # x runs fastest in memory, as in the blocks and in other formats
        stored_order = np.full((*whole.shape[::-1], *trailing), fill, dtype=first.dtype)
        values = stored_order.transpose(2, 1, 0, *range(3, stored_order.ndim))
        for box, part in found:
            values[box.within(whole.low)] = part
        return GridField(values, whole, lattice, variable)

    def follow(
        self,
        label: str,
        identities: npt.ArrayLike,
        material: int | None = None,
        steps: Sequence[int] | None = None,
    ) -> Track:
        """Follow particles through the time steps by their ``p.particleID``.

        Parameters
        ----------
        label
            Label of a particle variable, perhaps with a measure.
        identities
            Identities of the particles, shape (n,).
        material
            Their material, or None to look through all.
        steps
            Numbers of the time steps; None for all that hold the variable.
        """
        from ups.archive.tracks import follow

        return follow(self, label, identities, material, steps)

    def dataset(self, variables: Sequence[str] | None = None, material: int = 0, level: int = 0) -> Any:
        """Return an `xarray.Dataset` of one material and level, whose values are read when they are used.

        Grid variables have the dimensions (time, x, y, z, ...); those at nodes, cell centres
        and faces have coordinates of their own (``x_node``, ``x_cell``, ``x_face``). Particle variables,
        (time, particle, ...), are there where ``p.particleID`` is stored, and hold the particles
        of the first time step. Vectors have the dimension ``component``, matrices ``row`` and ``column``,
        all labelled X, Y, Z. A history has a dimension of its own, ``time_KineticEnergy``.

        Parameters
        ----------
        variables
            Labels, perhaps with measures; None for all that the material has.
        material, level
            Their indices.

        Raises
        ------
        ArchiveError
            Where xarray is not installed.
        """
        from ups.archive.dataset import dataset

        return dataset(self, variables, material, level)

    def per_patch(self, step: int, label: str, material: int, level: int = 0) -> np.ndarray:
        """Values of a per-patch variable, shape (patches, element...)."""
        stored = self._step(step)
        lattice, entries = self._on_level(stored, label, material, level)
        return np.array([stored.patch_block(level, entries[patch.id]) for patch in lattice.patches])

    def fields(self, step: int, level: int = 0) -> dict[Variable, dict[int, np.ndarray]]:
        """Everything that a time step holds on a level, in the form that `ArchiveWriter` takes."""
        stored = self._step(step)
        found: dict[Variable, dict[int, np.ndarray]] = {}
        for label, entries in stored.table(level).entries.items():
            variable = stored.variable(next(iter(entries.values())))
            compressed = any(entry.compression for entry in entries.values())
            variable = replace(variable, compression="gzip" if compressed else "none")
            by_material = found.setdefault(variable, {})
            for material in sorted({material for material, _patch in entries}):
                if variable.is_particle:
                    of_patch = blocks_of(entries, material)
                    parts = [stored.particle_block(level, of_patch[number]) for number in sorted(of_patch)]
                    by_material[material] = _joined(parts, variable)
                elif variable.container == PER_PATCH:
                    by_material[material] = self.per_patch(step, label, material, level)
                else:
                    by_material[material] = self.grid_variable(step, label, material, level).values
        return found

    def _step(self, step: int) -> StoredTimestep:
        timestep = self.timestep(step)
        with self._lock:  # steps may be read by several threads
            return self._opened(timestep)

    def _opened(self, timestep: Timestep) -> StoredTimestep:
        stored = self._stored.get(timestep.step)
        if stored is None:
            beside = self.path / timestep.href
            path = beside if beside.exists() else Path(timestep.href)
            stored = self._stored[timestep.step] = StoredTimestep(path, self.index, timestep)
            if len(self._stored) > _STEPS_KEPT:
                self._stored.popitem(last=False)
        return stored

    def _on_level(
        self, stored: StoredTimestep, label: str, material: int, level: int
    ) -> tuple[Level, dict[int, Entry]]:
        """Return a level and the blocks of a variable of a material there, which every patch must have."""
        if not 0 <= level < len(stored.levels):
            raise ArchiveError(stored.path, f"there is no level {level}, only {len(stored.levels)} levels")
        entries = blocks_of(stored.table(level).entries.get(label, {}), material)
        if not entries:
            raise self._absent(stored, label, material)
        missing = [patch.id for patch in stored.levels[level].patches if patch.id not in entries]
        if missing:
            message = f"{label} of material {material} is missing on the patches {missing[:5]}"
            raise ArchiveError(stored.path, message, advice="the archive is damaged; try another time step")
        return stored.levels[level], entries

    def _check_particles(
        self, stored: StoredTimestep, level: Level, label: str, material: int, entries: Mapping[int, Entry]
    ) -> None:
        """Make sure that no patch with particles lacks an entry; without particles, old archives may."""
        for (index, patch), count in stored.table(level.index).particles.items():
            if entries and index == material and count and patch not in entries:
                message = f"{label} of material {material} is missing on patch {patch} with {count} particles"
                raise ArchiveError(
                    stored.path, message, advice="the archive is damaged; try another time step"
                )

    def _source(self, name: str) -> str:
        """Label of the variable that a name stands for; the name itself where there is none."""
        if name in self.variables or name in self.unsupported:
            return name
        try:
            return find(name, self.variables).source.name
        except LookupError:
            return name.partition(":")[0]

    def _declared(self, stored: StoredTimestep, label: str) -> Variable:
        for level in stored.levels:
            for entry in stored.table(level.index).entries.get(label, {}).values():
                variable = stored.variable(entry)
                if not variable.is_particle:
                    raise ArchiveError(stored.path, f"{label} is a {variable.type_name}, not on particles")
                return variable
        raise self._absent(stored, label, None)

    def _absent(self, stored: StoredTimestep, label: str, material: int | None) -> ArchiveError:
        step, labels = stored.timestep.step, self.labels(stored.timestep.step)
        if label in labels:
            there = ", ".join(str(index) for index in self.materials(step, label))
            message = f"{label} is not stored for material {material} at step {step}"
            return ArchiveError(self.path, message, advice=f"its materials are: {there}")
        return ArchiveError(
            self.path,
            f"there is no variable {label} at step {step}",
            advice=f"there are: {', '.join(labels)}",
        )


def _measured(values: np.ndarray, named: Named) -> np.ndarray:
    """Values of what a name stands for, from those of its variable."""
    return values if named.measure is None else named.measure.function(values)


def _joined(parts: list[np.ndarray], variable: Variable) -> np.ndarray:
    """Return the blocks of a particle variable as one array, without a copy where there is only one."""
    filled = [part for part in parts if len(part)]
    if len(filled) == 1:
        return filled[0]
    element = variable.element_type
    if not filled:
        return np.empty((0, *element.shape), dtype=element.dtype.newbyteorder("="))
    return np.concatenate(filled)


class _Histories(Mapping[str, Reduction]):
    """The histories of an archive, each read when it is first taken."""

    def __init__(self, archive: Archive) -> None:
        self._archive = archive
        self._listed = {Path(g.href).stem: g for g in archive.index.globals_ if g.href}
        self._read: dict[str, Reduction] = {}

    def __getitem__(self, key: str) -> Reduction:
        if key not in self._read:
            listed = self._listed[key]
            suffix = key.removeprefix(listed.name).removeprefix("_")
            material = int(suffix) if suffix.isdecimal() else GLOBAL_MATERIAL
            self._read[key] = read_history(self._archive.path / f"{key}.dat", listed.name, material)
        return self._read[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._listed)

    def __len__(self) -> int:
        return len(self._listed)
