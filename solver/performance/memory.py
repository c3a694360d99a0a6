"""How much memory the arrays of particles take."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from solver.materials import CONSTITUTIVE_MODEL
from solver.materials.constitutive import state_record
from solver.materials.erosion import ErosionState
from solver.particles import Particles, new_arrays


def bytes_of(records: Iterable[Iterable[Any]]) -> int:
    """The bytes of all arrays of some records."""
    return sum(array.nbytes for record in records for array in record)


def bytes_a_particle(record: type[Any]) -> int:
    """The bytes that a NamedTuple of state variables takes for each particle."""
    return bytes_of([new_arrays(record, 1)])


PARTICLE = bytes_a_particle(Particles) + bytes_a_particle(ErosionState)
"""Bytes that every particle takes, the time at which it failed included."""


def bytes_of_models() -> dict[str, int]:
    """The bytes that each constitutive model keeps of a particle, beside those of :data:`PARTICLE`.

    With the fields that a deck may leave out as they are then; some models keep more if they are given.
    """
    return {name: bytes_a_particle(_state(model)) for name, model in CONSTITUTIVE_MODEL.models.items()}


def _state(model: Any) -> type[Any]:
    return state_record(model(*(model._field_defaults.get(field) for field in model._fields)))
