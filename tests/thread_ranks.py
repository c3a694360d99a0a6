"""Ranks that are threads of one process: what several ranks do can be tested where there is no MPI."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from queue import Queue
from typing import Any

import numpy as np

PATIENCE = 120.0
"""Seconds after which a rank that waits in vain fails its test."""


class Team:
    """What the threads share."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.barrier = threading.Barrier(size)
        self.slots: list[Any] = [None] * size
        self.mail: dict[tuple[int, int, str], Queue[Any]] = {
            (a, b, kind): Queue() for a in range(size) for b in range(size) for kind in ("halo", "particles")
        }


class ThreadRank:
    """A communicator (see ``solver.domains.communicator``) that counts what it sends.

    Attributes
    ----------
    sent : (kind, bytes) of every message to another rank, "halo" or "particles".
    reductions : how many sums and maxima were taken.
    """

    def __init__(self, team: Team, rank: int) -> None:
        self.rank, self.size = rank, team.size
        self.sharing_cores = team.size
        self._team = team
        self.sent: list[tuple[str, int]] = []
        self.reductions = 0

    def allgather(self, sendobj: Any, /) -> list[Any]:
        self._team.slots[self.rank] = sendobj
        self._team.barrier.wait(PATIENCE)
        everything = list(self._team.slots)
        self._team.barrier.wait(PATIENCE)
        return everything

    def total(self, values: Any) -> Any:
        self.reductions += 1
        return np.sum(self.allgather(values), axis=0)

    def largest(self, values: Any) -> Any:
        self.reductions += 1
        return np.max(self.allgather(values), axis=0)

    def from_root(self, value: Any) -> Any:
        return self.allgather(value)[0]

    def send(self, arrays: Mapping[int, Any], into: Mapping[int, Any]) -> Callable[[], None]:
        for rank, array in arrays.items():
            self.sent.append(("halo", array.nbytes))
            self._team.mail[self.rank, rank, "halo"].put(array.copy())

        def wait() -> None:
            for rank, buffer in into.items():
                array = self._team.mail[rank, self.rank, "halo"].get(timeout=PATIENCE)
                buffer[: len(array)] = array

        return wait

    def send_unannounced(self, messages: Mapping[int, bytes]) -> dict[int, bytes]:
        for rank, message in messages.items():
            self.sent.append(("particles", len(message)))
            self._team.mail[self.rank, rank, "particles"].put(message)
        return {r: self._team.mail[r, self.rank, "particles"].get(timeout=PATIENCE) for r in messages}

    def deal(self, messages: Sequence[bytes]) -> list[bytes]:
        return [theirs[self.rank] for theirs in self.allgather(list(messages))]

    def all_failed(self) -> bool:
        return True

    def abort(self) -> None:
        self._team.barrier.abort()


def on_ranks(size: int, action: Callable[[ThreadRank], Any]) -> list[Any]:
    """What an action gives on each of some ranks; the first exception of a rank is raised here."""
    team = Team(size)
    results: list[Any] = [None] * size
    failures: list[BaseException] = []

    def work(rank: int) -> None:
        try:
            results[rank] = action(ThreadRank(team, rank))
        except threading.BrokenBarrierError:
            pass  # another rank failed
        except BaseException as failure:  # raised again in the test's thread
            failures.append(failure)
            team.barrier.abort()

    threads = [threading.Thread(target=work, args=(rank,), daemon=True) for rank in range(size)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(2 * PATIENCE)
    if failures:
        raise failures[0]
    return results
