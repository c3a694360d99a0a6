"""A body: the particles of one material, and what acts on them alone."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from solver.diffusion.solute import NoSolute
from solver.materials.constitutive import Material, numbers_only
from solver.materials.failure import Failure
from solver.particles import Array, Particles, keep


@dataclass
class Body:
    """The particles of one material of a deck, with all that acts on them alone.

    Attributes
    ----------
    index : material index in the deck.
    name : the material's name in the deck, or its constitutive model's.
    material : constants.
    model : the constitutive model's record.
    state : the model's own arrays.
    particles : the particles.
    failure : how they are damaged, and what becomes of those that failed.
    solute : what they carry of a diffusing substance.
    rigid : moves as contact tells it and carries no stress.
    transmits_force : feels no acceleration of its own (Uintah's force-transmitting material).
    activation_time : before this time the body neither weighs nor pushes.
    is_active : False keeps it out until ``activation_time``, and for good where that is zero.
    possible_alpha : whether contact may take its surface for the one that separates it from the others.
    """

    index: int
    name: str
    material: Material
    model: Any
    state: Any
    particles: Particles
    failure: Failure
    solute: Any = field(default_factory=NoSolute)
    rigid: bool = False
    transmits_force: bool = False
    activation_time: float = 0.0
    is_active: bool = True
    possible_alpha: bool = True

    @cached_property
    def numeric_model(self) -> Any:
        """The model as kernels take it."""
        return numbers_only(self.model)

    def takes_part(self, time: float) -> bool:
        """Whether the body is on the grid in a step that begins at a time."""
        return time >= self.activation_time and (self.is_active or self.activation_time > 0.0)

    def keep(self, kept: Array) -> None:
        """Keep the particles that a mask (n,) or indices name, in that order."""
        self.records = tuple(keep(record, kept) for record in self.records)

    @property
    def records(self) -> tuple[Any, ...]:
        """All arrays of the particles: NamedTuples whose fields declare how an archive calls them."""
        failure = self.failure
        return self.particles, self.state, failure.damage_state, failure.erosion_state, self.solute

    @records.setter
    def records(self, records: tuple[Any, ...]) -> None:
        self.particles, self.state, damage_state, erosion_state, self.solute = records
        self.failure = self.failure._replace(damage_state=damage_state, erosion_state=erosion_state)
