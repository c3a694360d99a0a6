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
from ups.convert.glyphs import edge_parts


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
        variable = self.archive.find(label).declaration
        return joined(self.particles(step).parts(label, material), variable)

    def particles(self, step: int) -> ParticleSet:
        """Particles of a time step."""
        position = self.archive.index.particle_position
        if position not in self.archive.variables:
            message = f"the positions of the particles, {position}, are not stored"
            raise ArchiveError(
                self.archive.path, message, advice=f'add <save label="{position}"/> to the deck'
            )
        return ParticleSet(self, step, position, self.materials_of(step, position))

    def cells(self, level: Level, box: Box | None = None) -> Box:
        """Cells of a box, by default the interior of a level, that are in the region; of no cells where none are."""
        box = level.interior if box is None else box
        return box if self.region is None else _common(box, self.region.cells(level))

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

    @cached_property
    def counts(self) -> list[int]:
        """Number of particles of each material."""
        return [sum(map(_count, self._kept[material])) for material in self.materials]

    @property
    def variables(self) -> list[Variable]:
        """Selected particle variables that the step holds, apart from the positions."""
        archive, position = self.selection.archive, self.position_label
        return [
            variable
            for variable in self.selection.variables
            if variable.is_particle
            and variable.name != position
            and archive.materials(self.step, variable.name)
        ]

    @cached_property
    def _kept(self) -> dict[int, list[np.ndarray | int]]:
        """By material and part, which particles are in the region; their number where all count."""
        region = self.selection.region
        return {
            material: [len(part) if region is None else region.holds(part) for part in self._stored(material)]
            for material in self.materials
        }

    def _stored(self, material: int, label: str | None = None) -> Iterator[np.ndarray]:
        return self.selection.archive.particle_parts(self.step, label or self.position_label, material)

    def parts(self, label: str, material: int) -> Iterator[np.ndarray]:
        """Values of one material, shape (n, element...), part by part."""
        return _inside(self._stored(material, label), self._kept[material])

    def position_parts(self) -> Iterator[np.ndarray]:
        """Positions of all particles, part by part; shapes (n, 3)."""
        for material in self.materials:
            yield from self.parts(self.position_label, material)

    def edge_parts(self) -> Iterator[np.ndarray]:
        """Edge vectors of the boxes that the particles fill, see `particle_edges`; shapes (n, 3, 3)."""
        archive = self.selection.archive
        level = archive.grid(self.step).levels[-1]
        for material in self.materials:
            yield from _inside(edge_parts(archive, self.step, material, level), self._kept[material])

    def material_parts(self) -> Iterator[np.ndarray]:
        """Material of each particle, part by part; shapes (n,)."""
        for material in self.materials:
            for kept in self._kept[material]:
                yield np.full(_count(kept), material, dtype=np.int32)

    def value_parts(self, variable: Variable) -> Iterator[np.ndarray]:
        """Values of a variable for all particles, part by part; shapes (n, element...).

        Particles of materials that it is not stored for get NaN, or zero in an integer.
        """
        element = variable.element_type
        dtype = element.dtype.newbyteorder("=")
        fill = np.nan if dtype.kind == "f" else 0
        stored = self.selection.materials_of(self.step, variable.name)
        for material in self.materials:
            if material in stored:
                yield from self.parts(variable.name, material)
            else:
                for kept in self._kept[material]:
                    yield np.full((_count(kept), *element.shape), fill, dtype=dtype)


def _count(kept: np.ndarray | int) -> int:
    return kept if isinstance(kept, int) else int(np.count_nonzero(kept))


def _inside(parts: Iterator[np.ndarray], kept: Sequence[np.ndarray | int]) -> Iterator[np.ndarray]:
    for part, inside in zip(parts, kept, strict=True):
        yield part if isinstance(inside, int) else part[inside]


def joined(parts: Iterator[np.ndarray], variable: Variable) -> np.ndarray:
    """Parts as one array."""
    element = variable.element_type
    return np.concatenate([np.empty((0, *element.shape), element.dtype.newbyteorder("=")), *parts])
