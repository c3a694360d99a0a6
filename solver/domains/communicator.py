"""Messages between the ranks of a run, whatever carries them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Value = TypeVar("Value")
Waiting = Callable[[], None]
"""Ends a transfer: waits until what was sent may be changed, and what is to come has come."""


class Communicator(Protocol):
    """The ranks of a run, numbered from 0, and how they reach each other.

    All methods but ``rank``, ``size`` and ``abort`` are collective or have a counterpart: every rank has to call
    them, in the same order.
    """

    @property
    def rank(self) -> int:
        """The number of this rank."""

    @property
    def size(self) -> int:
        """How many ranks there are."""

    @property
    def sharing_cores(self) -> int:
        """How many ranks share the cores that this process may use, itself included."""

    def total(self, values: Array) -> Array:
        """The sums over all ranks of an array of numbers, the same bits on every rank."""

    def largest(self, values: Array) -> Array:
        """The maxima over all ranks of an array of numbers."""

    def from_root(self, value: Value) -> Value:
        """The value that rank 0 gives."""

    def allgather(self, sendobj: Value, /) -> list[Value]:
        """The values of all ranks, by rank, on every rank."""

    def send(self, arrays: Mapping[int, Array], into: Mapping[int, Array]) -> Waiting:
        """Start to send an array of doubles to each of some ranks, and to receive from others.

        What comes is put at the start of the arrays ``into``, by the rank that sends it, which may be longer.
        """

    def send_unannounced(self, messages: Mapping[int, bytes]) -> dict[int, bytes]:
        """Send bytes to some ranks, and return what came from the same ranks; lengths need not be known."""

    def deal(self, messages: Sequence[bytes]) -> list[bytes]:
        """Send bytes to every rank, by rank, and return what every rank sent to this one."""

    def all_failed(self) -> bool:
        """For a rank that cannot go on: whether within a few seconds all others say so too.

        If so, all failed alike, and one message is enough; if not, the others are waiting, and have to be ended.
        """

    def abort(self) -> None:
        """End the run on all ranks at once, because this one cannot go on."""


class Alone:
    """The communicator of a run on one rank."""

    rank = 0
    size = 1
    sharing_cores = 1

    def total(self, values: Array) -> Array:
        """The values themselves."""
        return values

    def largest(self, values: Array) -> Array:
        """The values themselves."""
        return values

    def from_root(self, value: Value) -> Value:
        """The value itself."""
        return value

    def allgather(self, sendobj: Value, /) -> list[Value]:
        """The value alone."""
        return [sendobj]

    def send(self, arrays: Mapping[int, Array], into: Mapping[int, Array]) -> Waiting:
        """There is nobody to send to."""
        return _nothing

    def send_unannounced(self, messages: Mapping[int, bytes]) -> dict[int, bytes]:
        """There is nobody to send to."""
        return {}

    def deal(self, messages: Sequence[bytes]) -> list[bytes]:
        """The message to itself."""
        return list(messages)

    def all_failed(self) -> bool:
        """Nobody else can."""
        return True

    def abort(self) -> None:
        """Nobody else has to be ended."""


def _nothing() -> None:
    """Wait for nobody."""


def largest_number(communicator: Communicator, value: float) -> float:
    """The largest of one number of each rank."""
    return float(communicator.largest(np.array([value]))[0])
