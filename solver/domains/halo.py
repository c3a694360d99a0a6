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
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.declare import IntVector
from solver.domains.communicator import Communicator
from solver.domains.decomposition import Domain
from solver.domains.rows import (
    add_own,
    add_rows,
    mark_filled,
    mark_touched,
    pack_places,
    pack_rows,
    take_out,
    touch,
    touch_own,
)
from solver.grid import Grid, Window
from solver.workspace import Workspace

Array = NDArray[Any]


@dataclass(frozen=True)
class _Link:
    """Nodes of this rank that are copies of nodes of a rank, in storage order (which is alike on both sides)."""

    rank: int
    shift: IntVector
    """The index of a copy less that of the node of this rank."""
    nodes: Array
    """(k,) storage indices of the nodes of this rank."""
    places: Array
    """(k,) where they are among all shared nodes of this rank."""
    mine: Array
    """Places in ``nodes`` of those that this rank counts."""
    theirs: Array
    """Places in ``nodes`` of those that the other rank counts."""


class _Buffers(NamedTuple):
    """What one transfer needs until it has ended."""

    marks: Array
    """(shared nodes,) 1 where this rank has something to add."""
    sent: dict[int, Array]
    received: dict[int, Array]


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
        found = _links(grid, domains, self._me, halo)
        everywhere = [link.nodes for link in found]
        self._shared = np.unique(np.concatenate([np.zeros(0, np.int64), *everywhere]))
        self._links = [replace(link, places=np.searchsorted(self._shared, link.nodes)) for link in found]
        self.neighbours = sorted({link.rank for link in self._links} - {self._me})
        self._by_rank = {r: [link for link in self._links if link.rank == r] for r in self.neighbours}
        self._sizes = {r: sum(len(link.nodes) for link in links) for r, links in self._by_rank.items()}
        self._order = self._order_of_copies()
        self._free: dict[int, list[_Buffers]] = {}
        self._room = Workspace()
        self.counted = np.zeros(grid.number_of_nodes, np.bool_)
        low, high = _counted_box(grid, domains[self._me], halo)
        self.counted[_flat(grid, low, high)] = True

    @property
    def turns(self) -> list[tuple[int, IntVector]]:
        """The ranks that store nodes of this one, each with the index of its copies less that of the nodes here."""
        return [(link.rank, link.shift) for link in self._links]

    def add(self, *sums: Array, touched: Array | None = None) -> Callable[[], None]:
        """Start to add sums (N, ...) at shared nodes over all copies; what is returned finishes it in place.

        All go in one message to each neighbour, with the rows of the nodes that are touched (N or more), or that have
        numbers other than 0; the others have to be 0. A node becomes touched (1) where any copy is. Until the
        transfer has ended the sums may be read, and must not be changed.
        """
        rows = [array.reshape(len(array), -1) for array in sums]
        width = sum(part.shape[1] for part in rows)
        buffers = self._buffers(width)
        self._mark(buffers.marks, rows, touched)
        sent = {r: buffers.sent[r][: self._pack(r, rows, buffers)] for r in self._by_rank}
        wait = self._communicator.send(sent, buffers.received)

        def finish() -> None:
            wait()
            if len(self._shared):
                self._add_up(rows, touched, buffers)
            self._free[width].append(buffers)

        return finish

    def _buffers(self, width: int) -> _Buffers:
        """Room for the transfer of so many numbers a node; that of a transfer that has ended, where there is some."""
        free = self._free.setdefault(width, [])
        if free:
            return free.pop()
        sizes = {r: len(self._by_rank[r]) + size * (1 + width) for r, size in self._sizes.items()}
        sent, received = ({r: np.empty(size) for r, size in sizes.items()} for _ in range(2))
        return _Buffers(np.empty(len(self._shared), np.uint8), sent, received)

    def _mark(self, marks: Array, rows: Sequence[Array], touched: Array | None) -> None:
        """Find the shared nodes to which this rank adds something."""
        if touched is not None:
            mark_touched(touched, self._shared, marks)
            return
        marks[:] = 0
        for part in rows:
            mark_filled(part, self._shared, marks)

    def _pack(self, rank: int, rows: Sequence[Array], buffers: _Buffers) -> int:
        """Fill the message to a rank, link by link, and return its length."""
        message, end = buffers.sent[rank], 0
        for link in self._by_rank[rank]:
            start, end = end, pack_places(buffers.marks, link.places, message, end)
            for part in rows:
                end = pack_rows(part, link.nodes, message, start, end)
        return end

    def _add_up(self, rows: Sequence[Array], touched: Array | None, buffers: _Buffers) -> None:
        """Add to the sums those of other ranks and of copies on this one, in the order of copies."""
        came = {
            id(link): (buffers.received[r], start)
            for r, links in self._by_rank.items()
            for link, start in _starts(buffers.received[r], links, sum(part.shape[1] for part in rows))
        }
        ends = {key: start + 1 + int(message[start]) for key, (message, start) in came.items()}
        for part in rows:
            components = part.shape[1]
            own = self._room.rows(f"own {components}", len(self._shared), np.float64, components)
            take_out(part, self._shared, buffers.marks, own)
            for link in self._order:
                if link is None:
                    add_own(part, self._shared, self._all_places, buffers.marks, own)
                elif link.rank == self._me:
                    add_own(part, link.nodes, self._opposite(link).places, buffers.marks, own)
                else:
                    message, start = came[id(link)]
                    ends[id(link)] = add_rows(part, link.nodes, message, start, ends[id(link)])
        if touched is not None:
            for link in self._links:
                if link.rank == self._me:
                    touch_own(touched, link.nodes, self._opposite(link).places, buffers.marks)
                else:
                    touch(touched, link.nodes, *came[id(link)])

    @cached_property
    def _all_places(self) -> Array:
        return np.arange(len(self._shared))

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
        received = {r: np.empty(sum(len(k.nodes) for k in links) * width) for r, links in theirs.items()}
        self._communicator.send(sent, received)()
        for r, links in theirs.items():
            start = 0
            for link in reversed(links):  # a rank sends by its own shifts, which are the opposite of ours
                end = start + len(link.nodes) * width
                rows[link.nodes] = received[r][start:end].reshape(-1, width)
                start = end
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


def _starts(message: Array, links: Sequence[_Link], width: int) -> Iterator[tuple[_Link, int]]:
    """Where the parts of a message begin; a rank sends by its own shifts, which are the opposite of ours."""
    start = 0
    for link in reversed(links):
        yield link, start
        start += 1 + int(message[start]) * (1 + width)


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
            places = np.arange(len(nodes))
            found.append(_Link(rank, (x, y, z), nodes, places, np.flatnonzero(mine), np.flatnonzero(theirs)))
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
