"""Particles that leave the domain of their rank go to the rank of their cell."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.declare import IntVector
from solver.deferred import deferred_kernel
from solver.domains.decomposition import Domain
from solver.grid import Grid, GridIndex

Array = NDArray[Any]
Records = tuple[Any, ...]
"""All arrays of the particles of one body, as NamedTuples, each with a row a particle."""

SPARE = 16
"""One part in so many of a body's arrays is kept free for newcomers."""


def owners(grid: Grid, domains: Sequence[Domain], positions: Array) -> Array:
    """The ranks (n,) of positions (n, 3); beyond the bounding box those of the nearest cell.

    In periodic directions positions go on at the other side.
    """
    if not len(positions):  # as in most steps
        return np.zeros(0, np.int64)
    cells = grid.cell_of(positions)
    for axis in range(3):
        n = grid.cells[axis]
        cells[:, axis] = cells[:, axis] % n if grid.periodic[axis] else np.clip(cells[:, axis], 0, n - 1)
    found = np.empty(len(cells), np.int64)
    open_ones = np.arange(len(cells))
    low, high = np.array([d.low for d in domains]), np.array([d.high for d in domains])
    while len(open_ones):
        rank = int(
            np.flatnonzero(((low <= cells[open_ones[0]]) & (cells[open_ones[0]] < high)).all(axis=1))[0]
        )
        there = ((low[rank] <= cells[open_ones]) & (cells[open_ones] < high[rank])).all(axis=1)
        found[open_ones[there]] = rank
        open_ones = open_ones[~there]
    return found


def leavers(grid: Grid, positions: Array) -> Array:
    """Which particles (n, 3) lie in no cell of this rank, ascending indices."""
    found = np.empty(len(positions), np.int64)
    return found[: find_leavers(positions, grid.index, *grid.own_cells, found)]


@deferred_kernel
def find_leavers(positions: Array, grid: GridIndex, low: IntVector, high: IntVector, found: Array) -> int:
    """Enter the particles outside the cells low <= c < high in ``found`` (n,), and return their number."""
    count = 0
    for p in range(positions.shape[0]):
        inside = True
        for c in range(3):
            cell = math.floor((positions[p, c] - grid.anchor[c]) / grid.spacing[c])
            inside = inside and low[c] <= cell < high[c]
        if not inside:
            found[count] = p
            count += 1
    return count


def packed(bodies: Sequence[Records], chosen: Sequence[Array]) -> bytes:
    """The chosen particles of every body as bytes, after their numbers."""
    numbers = np.array([len(rows) for rows in chosen], np.int64)
    arrays = [
        array[rows]
        for records, rows in zip(bodies, chosen, strict=True)
        if len(rows)
        for record in records
        for array in record
    ]
    return b"".join([numbers.tobytes(), *(array.tobytes() for array in arrays)])


def is_empty(message: bytes, bodies: int) -> bool:
    """Whether another rank packed no particle of any of so many bodies."""
    return not np.frombuffer(message, np.int64, bodies).any()


def unpacked(bodies: Sequence[Records], message: bytes) -> list[Records]:
    """What another rank packed, body by body; ``bodies`` show which arrays there are."""
    numbers = np.frombuffer(message, np.int64, len(bodies))
    start = numbers.nbytes

    def taken(like: Array, count: int) -> Array:
        nonlocal start
        values = np.frombuffer(message, like.dtype, count * math.prod(like.shape[1:]), start)
        start += values.nbytes
        return values.reshape(count, *like.shape[1:])

    return [
        tuple(type(record)(*(taken(array, count) for array in record)) for record in records)
        for records, count in zip(bodies, numbers.tolist(), strict=True)
    ]


def joined(parts: Sequence[Records]) -> Records:
    """The particles of several records of one body, one after the other."""
    return tuple(
        type(same[0])(*(np.concatenate(arrays) for arrays in zip(*same, strict=True)))
        for same in zip(*parts, strict=True)
    )


class Room:
    """Arrays of a body with room to spare, so that a few particles can come and go without a copy of all.

    The records that :meth:`exchanged` returns are views of the first rows of these arrays. Where somebody else
    replaced them in the meantime, the next exchange copies them into new room.
    """

    def __init__(self) -> None:
        self._records: Records = ()

    def exchanged(self, records: Records, gone: Array, come: Records) -> Records:
        """The records without the particles ``gone`` (ascending indices), and with those of ``come``.

        Newcomers take the places of those who left, then places at the end; places that stay free are taken by
        the last particles.
        """
        before, after = len(gone), _count(come)
        count = _count(records)
        new_count = count - before + after
        if not self._holds(records, new_count):
            self._make(records, max(new_count, count))
        refilled = gone[: min(before, after)]
        holes = gone[len(refilled) :]
        last = np.arange(new_count, count)
        movers = np.setdiff1d(last, holes, assume_unique=True)
        holes = holes[holes < new_count]
        views = []
        for record, new in zip(self._records, come, strict=True):
            for array, values in zip(record, new, strict=True):
                array[refilled] = values[: len(refilled)]
                array[count : count + after - len(refilled)] = values[len(refilled) :]
                array[holes] = array[movers]
            views.append(type(record)(*(array[:new_count] for array in record)))
        return tuple(views)

    def _holds(self, records: Records, count: int) -> bool:
        """Whether the records are views of the room, and it is large enough."""
        room = [array for record in self._records for array in record]
        arrays = [array for record in records for array in record]
        return (
            len(room) == len(arrays) > 0
            and len(room[0]) >= count
            and all(array.base is whole for array, whole in zip(arrays, room, strict=True))
        )

    def _make(self, records: Records, count: int) -> None:
        made = []
        for record in records:
            arrays = []
            for array in record:
                whole = np.empty((count + count // SPARE + 1, *array.shape[1:]), array.dtype)
                whole[: len(array)] = array
                arrays.append(whole)
            made.append(type(record)(*arrays))
        self._records = tuple(made)


def _count(records: Records) -> int:
    return len(records[0][0])
