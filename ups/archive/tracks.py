"""Particles followed through the time steps by their identity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from ups.archive.errors import ArchiveError

if TYPE_CHECKING:
    from ups.archive.reader import Archive

IDENTITY = "p.particleID"
"""Label under which Uintah stores the identity of a particle."""

IDENTITIES = (IDENTITY, "cz.CZID")
"""The same, and that of a cohesive zone, which is stored as a particle of a material of zones."""


@dataclass(frozen=True)
class Track:
    """Values of some particles at some time steps.

    Attributes
    ----------
    label
        Label of the variable.
    identities
        Identities of the n particles.
    steps, times
        Numbers of the time steps, and the times at their ends.
    present
        Whether a particle is there at a step, shape (steps, n).
    values
        Shape (steps, n, element...); NaN, or zero in integers, where a particle is not there.
    """

    label: str
    identities: np.ndarray
    steps: np.ndarray
    times: np.ndarray
    present: np.ndarray
    values: np.ndarray


def identity_label(archive: Archive, step: int, material: int) -> str | None:
    """Under which label the identities of a material's particles are stored at a step; None without any."""
    stored = (label for label in IDENTITIES if label in archive.labels(step))
    return next((label for label in stored if material in archive.materials(step, label)), None)


def follow(
    archive: Archive,
    label: str,
    identities: npt.ArrayLike,
    material: int | None = None,
    steps: Sequence[int] | None = None,
) -> Track:
    """See `Archive.follow`."""
    wanted = np.atleast_1d(np.asarray(identities, dtype=np.int64))
    if not any(label in archive.variables for label in IDENTITIES):
        message = f"the identities of the particles, {IDENTITY}, are not stored"
        raise ArchiveError(archive.path, message, advice=f'add <save label="{IDENTITY}"/> to the deck')
    named = archive.find(label)
    declared = named.declaration
    if not declared.is_particle:
        raise ArchiveError(archive.path, f"{label} is a {declared.type_name}, not on particles")
    if steps is None:
        plain = named.source.name
        labels = [(t, set(archive.labels(t.step))) for t in archive.timesteps]
        chosen = [t for t, stored in labels if plain in stored and stored.intersection(IDENTITIES)]
    else:
        chosen = [archive.timestep(step) for step in steps]
    element = declared.element_type
    shape = (len(chosen), len(wanted), *element.shape)
    fill = np.nan if element.dtype.kind == "f" else 0
    values = np.full(shape, fill, dtype=element.dtype.newbyteorder("="))
    present = np.zeros(shape[:2], dtype=bool)
    for row, timestep in enumerate(chosen):
        searched = archive.materials(timestep.step, label) if material is None else [material]
        for index in searched:
            identity = identity_label(archive, timestep.step, index)
            there = archive.particles(timestep.step, identity, index) if identity else ()
            if not len(there):
                continue
            order = np.argsort(there, kind="stable")
            place = order[np.minimum(np.searchsorted(there, wanted, sorter=order), len(there) - 1)]
            found = (there[place] == wanted) & ~present[row]
            if found.any():
                values[row, found] = archive.particles(timestep.step, label, index)[place[found]]
                present[row] |= found
    return Track(
        label,
        wanted,
        np.array([t.step for t in chosen], dtype=np.int64),
        np.array([t.time for t in chosen]),
        present,
        values,
    )
