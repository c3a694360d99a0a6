"""What is to be converted: an archive's time steps, variables and materials."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ups.archive import Archive, ArchiveError, GridField, Timestep, Variable

_SITES = ("p.", "g.", "c.")


def plain_name(label: str) -> str:
    """Label without the prefix that says where it sits: ``stress`` for ``p.stress``."""
    return label[2:] if label.startswith(_SITES) and len(label) > 2 else label


def as_rows(values: np.ndarray) -> np.ndarray:
    """Reshape values from (n, element...) to (n, components)."""
    return values.reshape(len(values), math.prod(values.shape[1:]))


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
    """

    archive: Archive
    timesteps: tuple[Timestep, ...]
    variables: tuple[Variable, ...]
    materials: frozenset[int] | None

    @classmethod
    def make(
        cls,
        archive: Archive,
        variables: Sequence[str] | None = None,
        materials: Sequence[int] | None = None,
        steps: Sequence[int] | None = None,
    ) -> Selection:
        """Select by labels, with or without their prefix, materials, and numbers of steps.

        Raises
        ------
        ArchiveError
            For a label or a step that the archive does not hold.
        """
        timesteps = archive.timesteps if steps is None else [archive.timestep(step) for step in steps]
        known = {label: v for label, v in archive.variables.items() if v.is_particle or v.is_grid}
        chosen = list(known.values())
        if variables is not None:
            for name in variables:
                if not any(name in (label, plain_name(label)) for label in known):
                    there = ", ".join(known) or "none"
                    raise ArchiveError(
                        archive.path, f"there is no variable {name}", advice=f"there are: {there}"
                    )
            chosen = [v for label, v in known.items() if label in variables or plain_name(label) in variables]
        return cls(
            archive,
            tuple(sorted(set(timesteps), key=lambda timestep: timestep.step)),
            tuple(chosen),
            None if materials is None else frozenset(materials),
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

    def particles(self, step: int) -> ParticleSet:
        """Particles of a time step."""
        position = self.archive.index.particle_position
        if position not in self.archive.variables:
            message = f"the positions of the particles, {position}, are not stored"
            raise ArchiveError(
                self.archive.path, message, advice=f'add <save label="{position}"/> to the deck'
            )
        return ParticleSet(self, step, position, self.materials_of(step, position))

    def grid_fields(self, step: int, level: int) -> Iterator[tuple[int, GridField]]:
        """Selected grid variables of a level, each with its material; read one at a time."""
        for variable in self.variables:
            if variable.is_grid:
                for material in self.materials_of(step, variable.name, level):
                    yield material, self.archive.grid_variable(step, variable.name, material, level)


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
        return [self.selection.archive.particle_count(self.step, material) for material in self.materials]

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
        archive = self.selection.archive
        stored = self.selection.materials_of(self.step, label)
        fill = np.nan if dtype.kind == "f" else 0
        parts = [
            archive.particles(self.step, label, material)
            if material in stored
            else np.full((count, *shape), fill, dtype=dtype)
            for material, count in zip(self.materials, self.counts, strict=True)
        ]
        return parts[0] if len(parts) == 1 else np.concatenate([np.empty((0, *shape), dtype=dtype), *parts])
