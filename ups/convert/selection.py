"""What is to be converted: an archive's time steps, variables, materials and region."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ups.archive import Archive, ArchiveError, Box, GridField, Level, Timestep, Variable
from ups.archive.layout import FloatVector
from ups.archive.units import plain_name
from ups.archive.variables import FACES, NODE
from ups.convert.glyphs import particle_edges


def plain_title(label: str) -> str:
    """Name for formats whose readers do arithmetic with names: ``stress_vonMises``."""
    return plain_name(label).replace(":", "_")


def as_rows(values: np.ndarray) -> np.ndarray:
    """Reshape values from (n, element...) to (n, components)."""
    return values.reshape(len(values), math.prod(values.shape[1:]))


@dataclass(frozen=True)
class Region:
    """A box in space.

    Raises
    ------
    ValueError
        Where a lower end is not below the upper.
    """

    low: FloatVector
    high: FloatVector

    def __post_init__(self) -> None:
        if not all(low < high for low, high in zip(self.low, self.high, strict=True)):
            raise ValueError(f"the region from {self.low} to {self.high} is empty")

    def holds(self, positions: np.ndarray) -> np.ndarray:
        """Whether each position, shape (n, 3), is inside."""
        return np.all((positions >= self.low) & (positions <= self.high), axis=1)

    def cells(self, level: Level) -> Box:
        """Cells of a level's lattice that the region touches."""
        ends = []
        for corner, rounded in ((self.low, np.floor), (self.high, np.ceil)):
            along = (np.array(corner) - np.array(level.anchor)) / np.array(level.spacing)
            nearest = np.rint(along)
            i, j, k = (int(x) for x in rounded(np.where(np.abs(along - nearest) < 1e-9, nearest, along)))
            ends.append((i, j, k))
        return Box(*ends)


@dataclass(frozen=True)
class Selection:
    """The part of an archive to convert.

    Attributes
    ----------
    archive
        The archive.
    timesteps
        Time steps, ascending.
    variables
        Particle and grid variables.
    materials
        Materials, or None for all.
    region
        Box that particles and cells must be in, or None.
    """

    archive: Archive
    timesteps: tuple[Timestep, ...]
    variables: tuple[Variable, ...]
    materials: frozenset[int] | None
    region: Region | None = None

    @classmethod
    def make(
        cls,
        archive: Archive,
        variables: Sequence[str] | None = None,
        materials: Sequence[int] | None = None,
        steps: Sequence[int] | None = None,
        *,
        every: int = 1,
        region: Region | None = None,
    ) -> Selection:
        """Select by labels, with or without their prefix, perhaps with measures, and by the rest.

        Parameters
        ----------
        archive
            The archive.
        variables
            Labels; one without its prefix stands for the variables on particles and on nodes.
        materials
            Indices of materials; None for all.
        steps
            Numbers of time steps, negative ones counted from the last; None for all.
        every
            Only every so-manieth of these time steps, beginning with the first.
        region
            Box that particles and cells must be in.

        Raises
        ------
        ArchiveError
            For a label or a step that the archive does not hold.
        """
        timesteps = archive.timesteps if steps is None else [archive.timestep(step) for step in steps]
        known = {label: v for label, v in archive.variables.items() if v.is_particle or v.is_grid}
        chosen = list(known.values())
        if variables is not None:
            found = [archive.find(name) for name in variables]
            for one in found:
                if one.source.name not in known:
                    message = f"{one.source.name} is a {one.source.type_name}, which has no place in space"
                    raise ArchiveError(
                        archive.path, message, advice=f"there are: {', '.join(known) or 'none'}"
                    )
            plain = [v for label, v in known.items() if label in variables or plain_name(label) in variables]
            chosen = plain + [one.declaration for one in found if one.measure is not None]
        ordered = sorted(set(timesteps), key=lambda timestep: timestep.step)
        return cls(
            archive,
            tuple(ordered[::every]),
            tuple(dict.fromkeys(chosen)),
            None if materials is None else frozenset(materials),
            region,
        )

    @property
    def has_particles(self) -> bool:
        """Whether a particle variable is selected."""
        return any(variable.is_particle for variable in self.variables)

    @property
    def has_grid(self) -> bool:
        """Whether a grid variable is selected."""
        return any(variable.is_grid for variable in self.variables)

    def materials_of(self, step: int, label: str, level: int | None = None) -> list[int]:
        """Selected materials that a variable is stored for."""
        stored = self.archive.materials(step, label, level)
        return [index for index in stored if self.materials is None or index in self.materials]

    def of_material(self, step: int, label: str, material: int) -> np.ndarray:
        """Values of the particles of one material that are in the region, shape (n, element...)."""
        if self.region is None:  # positions are not needed
            return self.archive.particles(step, label, material)
        return self.particles(step).of_material(label, material)

    def particles(self, step: int) -> ParticleSet:
        """Particles of a time step."""
        position = self.archive.index.particle_position
        if position not in self.archive.variables:
            message = f"the positions of the particles, {position}, are not stored"
            raise ArchiveError(
                self.archive.path, message, advice=f'add <save label="{position}"/> to the deck'
            )
        return ParticleSet(self, step, position, self.materials_of(step, position))

    def cells(self, level: Level) -> Box:
        """Cells of the interior of a level that are in the region; a box of no cells where there are none."""
        return level.interior if self.region is None else _common(level.interior, self.region.cells(level))

    def cropped(self, found: GridField) -> GridField:
        """Part of a field that belongs to cells in the region, extra cells included."""
        if self.region is None:
            return found
        low, high = self.region.cells(found.level)
        site = found.variable.container
        i, j, k = (high[axis] + (site in (NODE, FACES[axis])) for axis in range(3))
        box = _common(found.box, Box(low, (i, j, k)))
        return replace(found, values=found.values[box.within(found.origin)], box=box)

    def grid_fields(self, step: int, level: int) -> Iterator[tuple[int, GridField]]:
        """Selected grid variables of a level, each with its material; read one at a time."""
        for variable in self.variables:
            if variable.is_grid:
                for material in self.materials_of(step, variable.name, level):
                    yield material, self.archive.grid_variable(step, variable.name, material, level)


def _common(first: Box, second: Box) -> Box:
    """Indices that two boxes share; a box of no indices where they share none."""
    low = [max(pair) for pair in zip(first.low, second.low, strict=True)]
    high = [max(a, min(pair)) for a, pair in zip(low, zip(first.high, second.high, strict=True), strict=True)]
    return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))


@dataclass(frozen=True)
class ParticleSet:
    """The particles of a time step, of all selected materials; each variable read when asked for.

    Attributes
    ----------
    selection, step
        Where they come from.
    position_label
        Label of their positions.
    materials
        Materials in the order of the particles.
    """

    selection: Selection
    step: int
    position_label: str
    materials: list[int]

    @property
    def counts(self) -> list[int]:
        """Number of particles of each material."""
        counts = []
        for material in self.materials:
            inside = self._inside[material]
            every = self.selection.archive.particle_count(self.step, material)
            counts.append(every if inside is None else int(np.count_nonzero(inside)))
        return counts

    @cached_property
    def _inside(self) -> dict[int, np.ndarray | None]:
        """Whether each particle is in the region, by material; None where all count."""
        region = self.selection.region
        if region is None:
            return dict.fromkeys(self.materials)
        archive = self.selection.archive
        return {m: region.holds(archive.particles(self.step, self.position_label, m)) for m in self.materials}

    def _kept(self, material: int, values: np.ndarray) -> np.ndarray:
        inside = self._inside[material]
        return values if inside is None else values[inside]

    def of_material(self, label: str, material: int) -> np.ndarray:
        """Values of one material, shape (n, element...)."""
        return self._kept(material, self.selection.archive.particles(self.step, label, material))

    @property
    def edges(self) -> np.ndarray:
        """Edge vectors of the boxes that the particles fill, see `particle_edges`; shape (n, 3, 3)."""
        archive = self.selection.archive
        level = archive.grid(self.step).levels[-1]
        parts = [self._kept(m, particle_edges(archive, self.step, m, level)) for m in self.materials]
        return np.concatenate([np.empty((0, 3, 3)), *parts])

    @property
    def positions(self) -> np.ndarray:
        """Positions, shape (n, 3)."""
        return self._values(self.position_label, (3,), np.dtype(float))

    @property
    def material_indices(self) -> np.ndarray:
        """Material of each particle, shape (n,)."""
        return np.repeat(np.array(self.materials, dtype=np.int32), self.counts)

    def values(self) -> Iterator[tuple[Variable, np.ndarray]]:
        """Selected variables apart from the positions, shape (n, element...).

        Particles of materials that a variable is not stored for get NaN, or zero in an integer.
        """
        for variable in self.selection.variables:
            if variable.is_particle and variable.name != self.position_label:
                element = variable.element_type
                if self.selection.archive.materials(self.step, variable.name):
                    yield (
                        variable,
                        self._values(variable.name, element.shape, element.dtype.newbyteorder("=")),
                    )

    def _values(self, label: str, shape: tuple[int, ...], dtype: np.dtype) -> np.ndarray:
        stored = self.selection.materials_of(self.step, label)
        fill = np.nan if dtype.kind == "f" else 0
        parts = [
            self.of_material(label, material)
            if material in stored
            else np.full((count, *shape), fill, dtype=dtype)
            for material, count in zip(self.materials, self.counts, strict=True)
        ]
        return parts[0] if len(parts) == 1 else np.concatenate([np.empty((0, *shape), dtype=dtype), *parts])
