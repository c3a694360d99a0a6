"""Ranks that write one archive together, each the files of its own patches."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

from ups.archive.errors import ArchiveError


class Ranks(Protocol):
    """The processes of a run: an ``mpi4py.MPI.Comm``, or anything else with these three."""

    @property
    def rank(self) -> int:
        """Number of this process, from 0."""

    @property
    def size(self) -> int:
        """Number of processes."""

    def allgather(self, sendobj: Any, /) -> list[Any]:
        """Give what each process sends, by rank, to all; every process must call it."""


class OneRank:
    """A process that writes by itself."""

    rank = 0
    size = 1

    def allgather(self, sendobj: Any, /) -> list[Any]:
        """Return what was sent, the only element of a list."""
        return [sendobj]


ALONE = OneRank()


@contextmanager
def together(ranks: Ranks, path: Path) -> Iterator[None]:
    """Do the body on every rank; none goes on before all have, and where it fails on one, all raise.

    Raises
    ------
    ArchiveError
        Where the body failed on another rank; `path` is what they were at. Its own failure a rank raises
        as it is.
    """
    failure: BaseException | None = None
    try:
        yield
    except BaseException as error:  # an interrupt, too: the others would wait for this rank for ever
        failure = error
    told = ranks.allgather(None if failure is None else str(failure) or type(failure).__name__)
    if failure is not None:
        raise failure
    for rank, message in enumerate(told):
        if message is not None:
            raise ArchiveError(path, f"rank {rank} could not write: {message}")
