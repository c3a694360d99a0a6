"""Conversion of failed particles: they become particles of another material, with a velocity field of its own.

The new surface that failure leaves is then one between two materials: contact acts across it as across any other
(B. Banerjee, "Material point method simulations of fragmenting cylinders", 17th ASCE Engineering Mechanics
Conference, 2004). Earlier versions of Uintah do the same.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solver.domains.communicator import Alone, Communicator, largest_number
from solver.materials.constitutive import initialize
from solver.materials.damage import initialize_damage
from solver.materials.erosion import lets_fail
from solver.particles import append, keep, new_arrays, state_variables
from solver.random import Births

if TYPE_CHECKING:
    from solver.body import Body

Array = NDArray[Any]


def convert_failed_particles(
    bodies: Sequence[Body], targets: Mapping[int, int], communicator: Communicator | None = None
) -> int:
    """Move the particles that failed to other materials, and give their number.

    A particle keeps its identity, place, mass, velocity, deformation, stress and heat. Of the states of the
    models it keeps what the new material's models know by the same label; the rest starts anew, with random
    numbers in the order of ids. As everywhere nothing fails in a material whose erosion is none.

    Parameters
    ----------
    bodies : by index of their materials; changed in place.
    targets : index of a material -> index of the one that takes its failed particles.
    communicator : the ranks that hold the bodies together, each of which has to call this.
    """
    ranks, converted = communicator or Alone(), 0
    for source, target in targets.items():
        failed = bodies[source].particles.localized > 0
        here = int(np.count_nonzero(failed)) if lets_fail(bodies[source].failure.erosion) else 0
        # States that start anew are drawn by all ranks together.
        anywhere = here if _alike(bodies[source], bodies[target]) else largest_number(ranks, here)
        if anywhere:
            _move(bodies[source], bodies[target], failed, ranks)
            converted += here
    return converted


def _alike(source: Body, target: Body) -> bool:
    """Whether the particles of both have the same records."""
    return tuple(map(type, source.records)) == tuple(map(type, target.records))


def _move(source: Body, target: Body, chosen: Array, ranks: Communicator) -> None:
    """Move chosen particles, a mask (n,), from one body to another."""
    moving = tuple(keep(record, chosen) for record in source.records)
    if not _alike(source, target):
        moving = _translated(moving, target, ranks)
    source.keep(~chosen)
    _keep_heat(moving[0], source.material.specific_heat / target.material.specific_heat)
    target.records = tuple(append(old, new) for old, new in zip(target.records, moving, strict=True))


def _translated(moving: tuple[Any, ...], target: Body, ranks: Communicator) -> tuple[Any, ...]:
    """Records for the models of another material, with what they know by the same labels."""
    particles = moving[0]
    known: dict[str, Array] = {}
    for record in moving[1:]:
        for name, variable in state_variables(type(record)).items():
            known[variable.label] = getattr(record, name)
    fresh = [new_arrays(type(record), len(particles)) for record in target.records]
    bystander = type(particles)(*(array.copy() for array in particles))
    patch = Births(np.zeros(len(particles), np.int32), lambda: _turns_by_id(particles.id, ranks))
    initialize(target.model, fresh[1], bystander, target.material, patch)
    initialize_damage(target.failure.damage, fresh[2], bystander, patch)
    for record in fresh[1:]:
        for name, variable in state_variables(type(record)).items():
            if variable.label and variable.label in known:
                getattr(record, name)[:] = known[variable.label]
    return particles, *fresh[1:]


def _turns_by_id(ids: Array, ranks: Communicator) -> tuple[Array, Array]:
    """The places of ids (n,) among those of all ranks, twice, as ``solver.random.Births`` asks for."""
    turn = np.searchsorted(np.sort(np.concatenate(ranks.allgather(ids))), ids)
    return turn, turn


def _keep_heat(particles: Any, ratio: float) -> None:
    """Change temperatures such that the heat m c T is the same with another specific heat."""
    particles.temperature[:] *= ratio
    particles.previous_temperature[:] *= ratio
