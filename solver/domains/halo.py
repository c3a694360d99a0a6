"""Nodes that several ranks store, or one rank several times: sums over particles are added up over all copies.

A copy of a node is a rank and an index (i, j, k) in the window of that rank; in periodic directions indices that
differ by the number of cells are copies of one node too. Sums are taken over the copies in the order of rank and
index, which is the same wherever they are taken: all copies of a node then hold the same bits.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.declare import IntVector
from solver.domains.communicator import Communicator
from solver.domains.decomposition import Domain
from solver.grid import Grid, Window

Array = NDArray[Any]


@dataclass(frozen=True)
class _Link:
    """Nodes of this rank that are copies of nodes of a rank, in storage order (which is alike on both sides)."""

    rank: int
    shift: IntVector
    """The index of a copy less that of the node of this rank."""
    nodes: Array
    """(k,) storage indices of the nodes of this rank."""
    mine: Array
    """Places in ``nodes`` of those that this rank counts."""
    theirs: Array
    """Places in ``nodes`` of those that the other rank counts."""


class Halo:
    """The shared nodes of one rank.

    Parameters
    ----------
    grid : the grid with the window of this rank.
    domains : the domain of each rank.
    communicator : reaches the other ranks.

    Attributes
    ----------
    counted : (N,) True for the nodes of which this rank's copy is the one that counts in sums over nodes; of all
        copies of a node one counts.
    neighbours : ranks with which this one shares nodes, ascending.
    """

    def __init__(self, grid: Grid, domains: Sequence[Domain], communicator: Communicator) -> None:
        assert grid.window is not None
        self._communicator = communicator
        self._me = communicator.rank
        halo = grid.window.halo
        self._links = list(_links(grid, domains, self._me, halo))
        self.neighbours = sorted({link.rank for link in self._links} - {self._me})
        self._by_rank = {r: [link for link in self._links if link.rank == r] for r in self.neighbours}
        self._sizes = {r: sum(len(link.nodes) for link in links) for r, links in self._by_rank.items()}
        self._order = self._order_of_copies()
        everywhere = [link.nodes for link in self._links]
        self._shared = np.unique(np.concatenate([np.zeros(0, np.int64), *everywhere]))
        self.counted = np.zeros(grid.number_of_nodes, np.bool_)
        low, high = _counted_box(grid, domains[self._me], halo)
        self.counted[_flat(grid, low, high)] = True

    @property
    def doubles_sent(self) -> int:
        """Numbers sent by one :meth:`add` of one number a node."""
        return sum(self._sizes.values())

    @property
    def turns(self) -> list[tuple[int, IntVector]]:
        """The ranks that store nodes of this one, each with the index of its copies less that of the nodes here."""
        return [(link.rank, link.shift) for link in self._links]

    def add(self, *sums: Array) -> Callable[[], None]:
        """Start to add sums (N, ...) at shared nodes over all copies; what is returned finishes it in place.

        All go in one message to each neighbour. Until then they may be read, and must not be changed.
        """
        rows = [array.reshape(len(array), -1) for array in sums]
        sent = {
            r: np.concatenate([part[link.nodes].ravel() for link in links for part in rows])
            for r, links in self._by_rank.items()
        }
        width = sum(part.shape[1] for part in rows)
        wait = self._communicator.send(sent, {r: size * width for r, size in self._sizes.items()})

        def finish() -> None:
            received = wait()
            of_link: dict[int, Array] = {}
            for r, links in self._by_rank.items():
                of_link |= {id(link): numbers for link, numbers in _parts(received[r], links, width)}
            start = 0
            for part in rows:
                self._add_up(
                    part, {key: _columns(theirs, start, part, width) for key, theirs in of_link.items()}
                )
                start += part.shape[1]

        return finish

    def _add_up(self, rows: Array, of_link: dict[int, Array]) -> None:
        """Add to the sums (N, components) those of other ranks, by link, and those of copies on this one."""
        if not len(self._shared):
            return
        own = rows[self._shared]
        of_link |= {
            id(link): rows[self._opposite(link).nodes] for link in self._links if link.rank == self._me
        }
        rows[self._shared] = 0.0
        for link in self._order:
            if link is None:
                rows[self._shared] += own
            else:
                rows[link.nodes] += of_link[id(link)]

    def _order_of_copies(self) -> list[_Link | None]:
        """The links in the order in which copies are added; None stands for this rank's own nodes."""
        keyed: list[tuple[tuple[int, IntVector], _Link | None]] = [
            ((link.rank, link.shift), link) for link in self._links
        ]
        keyed.append(((self._me, (0, 0, 0)), None))
        return [link for _, link in sorted(keyed, key=lambda pair: pair[0])]

    def share(self, values: Array) -> None:
        """Give every copy of a node the values (N, ...) of the copy that counts, in place."""
        rows = values.reshape(len(values), -1)
        width = rows.shape[1]
        mine, theirs = self._counted_here, self._counted_there
        sent = {r: np.concatenate([rows[k.nodes].ravel() for k in links]) for r, links in mine.items()}
        sizes = {r: sum(len(k.nodes) for k in links) * width for r, links in theirs.items()}
        received = self._communicator.send(sent, sizes)()
        for r, links in theirs.items():
            for link, numbers in _parts(received[r], links, width):
                rows[link.nodes] = numbers.reshape(-1, width)
        for link in self._links:
            if link.rank == self._me:
                source = self._opposite(link)
                rows[link.nodes[link.theirs]] = rows[source.nodes[source.mine]]

    def _opposite(self, link: _Link) -> _Link:
        """For copies on this rank the link from the copies back."""
        back = tuple(-s for s in link.shift)
        return next(k for k in self._links if k.rank == self._me and k.shift == back)

    @cached_property
    def _counted_here(self) -> dict[int, list[_Link]]:
        return {r: [replace(k, nodes=k.nodes[k.mine]) for k in links] for r, links in self._by_rank.items()}

    @cached_property
    def _counted_there(self) -> dict[int, list[_Link]]:
        return {r: [replace(k, nodes=k.nodes[k.theirs]) for k in links] for r, links in self._by_rank.items()}


def _parts(numbers: Array, links: Sequence[_Link], width: int) -> Iterator[tuple[_Link, Array]]:
    """What a rank sent for each of its links; it sent by its own shifts, which are the opposite of ours."""
    start = 0
    for link in reversed(links):
        end = start + len(link.nodes) * width
        yield link, numbers[start:end]
        start = end


def _columns(numbers: Array, start: int, like: Array, width: int) -> Array:
    """Of the arrays that came for a link, one behind the other, that which begins at a component of ``width``."""
    count = len(numbers) // width
    columns = like.shape[1]
    return numbers[count * start : count * (start + columns)].reshape(count, columns)


def _links(grid: Grid, domains: Sequence[Domain], me: int, halo: int) -> list[_Link]:
    """The links of a rank, by rank and shift."""
    windows = np.array([_window_box(grid, domain, halo) for domain in domains])
    counted = np.array([_counted_box(grid, domain, halo) for domain in domains])
    found = []
    most = [(n + 2 * halo) // n if p else 0 for n, p in zip(grid.cells, grid.periodic, strict=True)]
    for turns in itertools.product(*(range(-m, m + 1) for m in most)):
        shift = np.array(turns) * np.array(grid.cells)
        low = np.maximum(windows[me, 0], windows[:, 0] - shift)
        high = np.minimum(windows[me, 1], windows[:, 1] - shift)
        for rank in np.flatnonzero((low < high).all(axis=1)).tolist():
            if rank == me and not any(turns):
                continue
            box = low[rank], high[rank]
            x, y, z = shift.tolist()
            nodes = _flat(grid, *box)
            mine = _inside(box, counted[me])
            theirs = _inside(box, counted[rank] - shift)
            found.append(_Link(rank, (x, y, z), nodes, np.flatnonzero(mine), np.flatnonzero(theirs)))
    return sorted(found, key=lambda link: (link.rank, link.shift))


def _window_box(grid: Grid, domain: Domain, halo: int) -> tuple[IntVector, IntVector]:
    """First and past-last nodes that the rank of a domain stores."""
    index = replace(grid, window=Window(*domain, halo)).index
    first, nodes = index.first, index.nodes
    return first, (first[0] + nodes[0], first[1] + nodes[1], first[2] + nodes[2])


def _counted_box(grid: Grid, domain: Domain, halo: int) -> tuple[IntVector, IntVector]:
    """First and past-last nodes that the rank of a domain counts: the lower nodes of its cells.

    At the upper end of the domain, and outside, the rank next to it counts the rest.
    """
    first, last = (list(corner) for corner in _window_box(grid, domain, halo))
    for axis in range(3):
        if domain.low[axis] > 0 or grid.periodic[axis]:
            first[axis] = domain.low[axis]
        if domain.high[axis] < grid.cells[axis] or grid.periodic[axis]:
            last[axis] = domain.high[axis]
    return (first[0], first[1], first[2]), (last[0], last[1], last[2])


def _flat(grid: Grid, low: Any, high: Any) -> Array:
    """Storage indices of the nodes low <= (i, j, k) < high, ascending."""
    k, j, i = np.meshgrid(*(np.arange(low[a], high[a]) for a in (2, 1, 0)), indexing="ij")
    return np.asarray(grid.flat(i, j, k)).ravel()


def _inside(box: Any, part: Any) -> Array:
    """For the nodes of a box in storage order whether they lie in a part of it."""
    k, j, i = np.meshgrid(*(np.arange(box[0][a], box[1][a]) for a in (2, 1, 0)), indexing="ij")
    nodes = np.stack([i.ravel(), j.ravel(), k.ravel()], axis=1)
    return np.asarray(((nodes >= part[0]) & (nodes < part[1])).all(axis=1))
