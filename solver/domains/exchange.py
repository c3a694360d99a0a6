"""What a simulation sees of the other ranks: one object for a run on one rank, one for a run on several."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from solver.domains.communicator import Alone, Communicator
from solver.domains.decomposition import CELL_WORK, Domain, cut, imbalance
from solver.domains.halo import Halo
from solver.domains.images import periodic_images
from solver.domains.migration import Records, Room, is_empty, joined, leavers, owners, packed, unpacked
from solver.grid import Grid, Window

Array = NDArray[Any]

BALANCE_EVERY = 25
"""Steps between looks at the balance of the ranks."""
UNBALANCED = 1.05
"""Largest work of a rank over the mean above which domains are cut anew."""
WORTHWHILE = 0.97
"""Domains are cut anew only if that brings the imbalance to this part of what it was, or less."""


class HasRecords(Protocol):
    """A body, as far as its particles are concerned."""

    @property
    def records(self) -> Records:
        """All that its particles carry, as NamedTuples of arrays with a row a particle."""

    @records.setter
    def records(self, records: Records) -> None: ...


class Status(NamedTuple):
    """What the ranks tell each other at the end of a step beside the sums."""

    stable: float
    """Stable step of this rank, then the least."""
    reach: int
    """Layers of cells around its own that particles reach, then the most."""
    fault: bool
    """Whether this rank, then any, cannot go on."""


class Exchange(Protocol):
    """The other ranks, for a simulation.

    Attributes
    ----------
    communicator : for what is special.
    counted : (N,) the nodes that count in sums over nodes: of all copies of a node one does.
    buffers : how many arrays of sums can be on their way at a time.
    domains : the domain of each rank; empty for one rank.
    """

    communicator: Communicator
    domains: tuple[Domain, ...]
    counted: Array
    buffers: int

    def add(self, *sums: Array, touched: Array | None = None) -> Callable[[], None]:
        """Start to add sums over particles (N, ...) over all copies of a node; what is returned finishes it.

        In between they must not be changed. Several of them share messages. With ``touched`` (N or more) only nodes
        that are touched (1) have sums, and a node becomes touched where any copy is.
        """

    def repeat(self, field: Array, touched: Array) -> None:
        """Give images of touched nodes the values (N, ...) of those they repeat, where only these were acted on."""

    def share(self, field: Array) -> None:
        """Give all copies of a node the values (N, ...) of the copy that counts."""

    def with_neighbours(self, record: Any) -> Any:
        """A NamedTuple of arrays of particles, ``position`` among them, with those of others that reach nodes here."""

    def migrate(self, bodies: Sequence[HasRecords]) -> None:
        """Send particles that left to the rank of their cell."""

    def conclude(self, status: Status, sums: dict[Any, Any]) -> Status:
        """End a step: add up ``sums`` (numbers and arrays by key) in place, and agree on the status."""

    def deliver(self, bodies: Sequence[HasRecords]) -> None:
        """Send particles that left for ranks that are no neighbours."""

    def new_grid(self, reach: int, bodies: Sequence[HasRecords], step: int) -> Grid | None:
        """The grid to go on with after a step, where the window of this rank has to change."""


class OneRank:
    """The exchange of a run on one rank: it knows of periodic images only.

    Parameters
    ----------
    grid : the grid.
    """

    def __init__(self, grid: Grid) -> None:
        self.communicator: Communicator = Alone()
        self.buffers = 1
        self.domains: tuple[Domain, ...] = ()
        self._images = periodic_images(grid)
        self.counted = np.ones(grid.number_of_nodes, np.bool_)
        self.counted[self._images[1]] = False

    def add(self, *sums: Array, touched: Array | None = None) -> Callable[[], None]:
        """Add up what images got, at once."""
        if len(self._images[0]):
            from solver.kernels.nodes import fold_images

            for values in sums:
                everywhere = np.ones(len(values), np.uint8)
                rows = values.reshape(len(values), -1)
                fold_images(rows, everywhere if touched is None else touched, *self._images)
        return _nothing

    def repeat(self, field: Array, touched: Array) -> None:
        """Images follow the nodes they repeat."""
        if len(self._images[0]):
            from solver.kernels.nodes import copy_to_images

            copy_to_images(field.reshape(len(field), -1), touched, *self._images)

    def share(self, field: Array) -> None:
        """There are no others."""

    def with_neighbours(self, record: Any) -> Any:
        """There are no others."""
        return record

    def migrate(self, bodies: Sequence[HasRecords]) -> None:
        """There is nowhere to go."""

    def conclude(self, status: Status, sums: dict[Any, Any]) -> Status:
        """There is nobody to agree with."""
        return status

    def deliver(self, bodies: Sequence[HasRecords]) -> None:
        """There is nowhere to go."""

    def new_grid(self, reach: int, bodies: Sequence[HasRecords], step: int) -> Grid | None:
        """The grid stays."""
        return None


class ManyRanks:
    """The exchange of one of several ranks.

    Parameters
    ----------
    communicator : the ranks.
    grid : the whole grid, or any rank's window of it.
    domains : the domain of each rank.
    reach : layers of cells around their own that particles reach.
    sees_neighbours : whether :meth:`with_neighbours` is used, which takes a wider halo.
    """

    def __init__(
        self,
        communicator: Communicator,
        grid: Grid,
        domains: Sequence[Domain],
        reach: int,
        *,
        sees_neighbours: bool = False,
    ) -> None:
        self.communicator = communicator
        self.buffers = 2
        self._sees_neighbours = sees_neighbours
        self._rooms: list[Room] = []
        self._far = 0
        self._counts = np.zeros(0)
        self.domains: tuple[Domain, ...] = ()
        self._place(grid, tuple(domains), reach)

    def _place(self, grid: Grid, domains: tuple[Domain, ...], reach: int) -> None:
        self.domains, self.reach = domains, reach
        # Particles of others reach twice as far beyond this domain as its own.
        halo = 2 * reach + 1 if self._sees_neighbours else reach
        self.grid = replace(grid, window=Window(*domains[self.communicator.rank], halo))
        self.halo = Halo(self.grid, domains, self.communicator)
        self.counted = self.halo.counted

    def add(self, *sums: Array, touched: Array | None = None) -> Callable[[], None]:
        """Send the sums at shared nodes; finishing adds those of all ranks."""
        return self.halo.add(*sums, touched=touched)

    def repeat(self, field: Array, touched: Array) -> None:
        """What acts at nodes acts at all copies."""

    def share(self, field: Array) -> None:
        """Send values to the other copies."""
        self.halo.share(field)

    def with_neighbours(self, record: Any) -> Any:
        """Add the particles of neighbours (and periodic images) that reach nodes counted here."""
        messages: dict[int, list[Records]] = {rank: [] for rank in self.halo.neighbours}
        mine: list[Records] = []
        cells = self.grid.cell_of(record.position)
        for rank, shift in self.halo.turns:
            domain = self.domains[rank]
            low = np.array(domain.low) - np.array(shift) - 1 - self.reach
            high = np.array(domain.high) - np.array(shift) + self.reach
            near = np.flatnonzero(((cells >= low) & (cells < high)).all(axis=1))
            chosen = type(record)(*(array[near] for array in record))
            moved = chosen.position + np.array(shift) * np.array(self.grid.spacing)
            chosen = chosen._replace(position=moved)
            (mine if rank == self.communicator.rank else messages[rank]).append((chosen,))
        sent = {
            rank: packed([joined(parts)], [np.arange(sum(len(p[0].position) for p in parts))])
            for rank, parts in messages.items()
        }
        received = self.communicator.send_unannounced(sent)
        others = [unpacked([(record,)], received[rank])[0] for rank in sorted(received)]
        return joined([(record,), *mine, *others])[0]

    def migrate(self, bodies: Sequence[HasRecords]) -> None:
        """Send leavers to neighbours; those who go farther wait for the end of the step."""
        neighbours = self.halo.neighbours
        gone, to = self._leavers(bodies)
        near = [np.isin(ranks, neighbours) if len(ranks) else np.zeros(0, bool) for ranks in to]
        self._far = sum(int(np.count_nonzero(~n)) for n in near)
        carried = [body.records for body in bodies]
        messages = {
            rank: packed(carried, [g[r == rank] for g, r in zip(gone, to, strict=True)])
            for rank in neighbours
        }
        received = self.communicator.send_unannounced(messages)
        self._settle(bodies, [g[n] for g, n in zip(gone, near, strict=True)], received)

    def _leavers(self, bodies: Sequence[HasRecords]) -> tuple[list[Array], list[Array]]:
        gone = [leavers(self.grid, body.records[0].position) for body in bodies]
        to = [
            owners(self.grid, self.domains, body.records[0].position[g])
            for body, g in zip(bodies, gone, strict=True)
        ]
        return gone, to

    def _settle(self, bodies: Sequence[HasRecords], gone: list[Array], received: Mapping[int, bytes]) -> None:
        """Take those who left out of the bodies, and put those who came in, by the rank they came from."""
        self._rooms = self._rooms or [Room() for _ in bodies]
        carried = [body.records for body in bodies]
        filled = [rank for rank in sorted(received) if not is_empty(received[rank], len(bodies))]
        came = [unpacked(carried, received[rank]) for rank in filled]
        for m, body in enumerate(bodies):
            parts = [part[m] for part in came if len(part[m][0].position)]
            if len(gone[m]) or parts:
                newcomers = joined(parts) if parts else unpacked([carried[m]], bytes(8))[0]
                body.records = self._rooms[m].exchanged(carried[m], gone[m], newcomers)

    def deal(self, bodies: Sequence[HasRecords]) -> None:
        """Send every particle that is not in the domain of its rank to the one it belongs to, however far."""
        gone, to = self._leavers(bodies)
        carried = [body.records for body in bodies]
        messages = [
            packed(carried, [g[r == rank] for g, r in zip(gone, to, strict=True)])
            for rank in range(self.communicator.size)
        ]
        received = self.communicator.deal(messages)
        self._settle(bodies, gone, {r: m for r, m in enumerate(received) if r != self.communicator.rank})

    def conclude(self, status: Status, sums: dict[Any, Any]) -> Status:
        """Add up the sums of all ranks and agree on the status, in two reductions."""
        flat = [np.atleast_1d(np.asarray(value, float)) for value in sums.values()]
        total = self.communicator.total(np.concatenate([[float(self._far)], *flat]))
        self._far = int(total[0])
        start = 1
        for key, part in zip(sums, flat, strict=True):
            values = total[start : start + len(part)]
            sums[key] = values if np.ndim(sums[key]) else float(values[0])
            start += len(part)
        worst = self.communicator.largest(np.array([-status.stable, status.reach, status.fault], float))
        return Status(-float(worst[0]), int(worst[1]), bool(worst[2]))

    def deliver(self, bodies: Sequence[HasRecords]) -> None:
        """Send particles to all ranks, if any rank has some that went far."""
        if self._far:
            self.deal(bodies)

    def new_grid(self, reach: int, bodies: Sequence[HasRecords], step: int) -> Grid | None:
        """Widen the halo where particles reach beyond it, and cut domains anew where they are out of balance."""
        domains = self.domains
        if step % BALANCE_EVERY == 0:
            domains = self._balanced(bodies)
        if domains == self.domains and reach <= self.reach:
            return None
        self._place(self.grid, domains, max(reach, self.reach))
        self.deal(bodies)
        return self.grid

    def _balanced(self, bodies: Sequence[HasRecords]) -> tuple[Domain, ...]:
        particles = sum(len(body.records[0].position) for body in bodies)
        mine = particles + CELL_WORK * self.domains[self.communicator.rank].size
        now = imbalance(self.communicator.allgather(mine))
        if now <= UNBALANCED:
            return self.domains
        cells = np.concatenate([self.grid.cell_of(body.records[0].position) for body in bodies])
        domains = cut(self.grid, self.communicator.size, lambda boxes: self._profile(cells, boxes))
        sizes = np.array([domain.size for domain in domains])
        numbers = self.communicator.total(_numbers_in(cells, domains))
        expected = imbalance((numbers + CELL_WORK * sizes).tolist())
        return domains if expected <= WORTHWHILE * now else self.domains

    def _profile(self, cells: Array, boxes: Sequence[Domain]) -> list[list[Array]]:
        """The work of all ranks in the layers of cells of some boxes."""
        own = []
        for box in boxes:
            inside = cells[((cells >= box.low) & (cells < box.high)).all(axis=1)]
            own += [np.bincount(inside[:, a] - box.low[a], minlength=box.shape[a]) for a in range(3)]
        total = self.communicator.total(np.concatenate(own).astype(float))
        parts = np.split(total, np.cumsum([len(part) for part in own])[:-1])
        layers = iter(parts)
        return [[next(layers) + CELL_WORK * box.size / n for n in box.shape] for box in boxes]


def _numbers_in(cells: Array, domains: Sequence[Domain]) -> Array:
    """How many of the cells (n, 3) lie in each domain."""
    return np.array(
        [np.count_nonzero(((cells >= d.low) & (cells < d.high)).all(axis=1)) for d in domains], float
    )


def _nothing() -> None:
    """Finish what was done at once."""
