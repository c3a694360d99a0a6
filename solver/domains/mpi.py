"""The ranks of ``mpirun``: the only module that knows MPI, imported where a run has several ranks."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from solver.domains.communicator import Alone, Array, Communicator, Waiting

Value = TypeVar("Value")

SIZE_VARIABLES = ("PMI_SIZE", "OMPI_COMM_WORLD_SIZE", "MV2_COMM_WORLD_SIZE", "SLURM_STEP_NUM_TASKS")
"""Where launchers say how many ranks they started: MPICH and its kin, Open MPI, MVAPICH, srun."""

LOCAL_SIZE_VARIABLES = ("MPI_LOCALNRANKS", "OMPI_COMM_WORLD_LOCAL_SIZE", "MV2_COMM_WORLD_LOCAL_SIZE")
"""Where launchers say how many of them they started on this machine."""

HALO, PARTICLES = 1, 2
"""Tags of messages."""


PATIENCE = 3.0
"""Seconds that a rank which cannot go on waits to see whether the others cannot either."""
TURN = 0.1
"""Seconds between the ranks that then end the run."""


def yield_core() -> None:
    """Let another process run, where one waits for the core."""
    if hasattr(os, "sched_yield"):
        os.sched_yield()


class MissingMpiError(RuntimeError):
    """The program was started on several ranks, and mpi4py or the MPI library is not there."""


def ranks_started() -> int:
    """How many ranks the launcher says it started, 1 where there is none; imports nothing."""
    return _number_in(SIZE_VARIABLES) or 1


def _number_in(variables: Sequence[str]) -> int:
    """The first number that one of some environment variables holds, else 0."""
    texts = (os.environ.get(name, "") for name in variables)
    return next((int(text) for text in texts if text.isdecimal()), 0)


def world() -> Communicator:
    """The ranks of this run: those of ``mpirun``, or this process alone.

    Raises
    ------
    MissingMpiError
        where a launcher started several ranks and they cannot find each other.
    """
    started = ranks_started()
    if started == 1:
        return Alone()
    try:
        from mpi4py import MPI
    except (ImportError, RuntimeError) as problem:
        raise MissingMpiError(
            f"started on {started} ranks, and MPI cannot be used: {problem}; pip install 'ups-mpm[mpi]'"
        ) from None
    if MPI.COMM_WORLD.Get_size() != started:
        raise MissingMpiError(
            f"started on {started} ranks, of which mpi4py sees {MPI.COMM_WORLD.Get_size()}: "
            "mpirun belongs to another MPI than mpi4py"
        )
    return Mpi(MPI.COMM_WORLD)


class Mpi:
    """A communicator of MPI.

    Parameters
    ----------
    communicator : mpi4py's communicator.
    """

    def __init__(self, communicator: Any) -> None:
        from mpi4py import MPI

        self._mpi = MPI
        self._world = communicator
        self._failures = communicator.Dup()
        self.rank: int = communicator.Get_rank()
        self.size: int = communicator.Get_size()
        local = _number_in(LOCAL_SIZE_VARIABLES) or self.size
        # A launcher that binds ranks to cores of their own leaves nothing to share.
        bound = hasattr(os, "sched_getaffinity") and len(os.sched_getaffinity(0)) < (os.cpu_count() or 1)
        self.sharing_cores: int = 1 if bound else local

    def total(self, values: Array) -> Array:
        """Sums over all ranks."""
        return self._combined(values, self._mpi.SUM)

    def largest(self, values: Array) -> Array:
        """Maxima over all ranks."""
        return self._combined(values, self._mpi.MAX)

    def _combined(self, values: Array, operation: Any) -> Array:
        result = np.empty_like(values)
        self._end([self._world.Iallreduce(np.ascontiguousarray(values), result, op=operation)])
        return result

    def _end(self, requests: list[Any]) -> None:
        """Wait for transfers. MPI would wait at full speed, and keep a core from a rank that is still at work."""
        while not self._mpi.Request.Testall(requests):
            yield_core()

    def from_root(self, value: Value) -> Value:
        """The value of rank 0."""
        result: Value = self._world.bcast(value)
        return result

    def allgather(self, sendobj: Value, /) -> list[Value]:
        """The values of all ranks."""
        result: list[Value] = self._world.allgather(sendobj)
        return result

    def send(self, arrays: Mapping[int, Array], into: Mapping[int, Array]) -> Waiting:
        """Start transfers of doubles."""
        requests = [self._world.Irecv(buffer, rank, HALO) for rank, buffer in into.items()]
        requests += [self._world.Isend(array, rank, HALO) for rank, array in arrays.items()]

        def wait() -> None:
            self._end(requests)

        return wait

    def send_unannounced(self, messages: Mapping[int, bytes]) -> dict[int, bytes]:
        """Send bytes to ranks that send some in turn."""
        requests = [self._world.Isend(message, rank, PARTICLES) for rank, message in messages.items()]
        received = {}
        status = self._mpi.Status()
        for rank in sorted(messages):
            while (message := self._world.Improbe(rank, PARTICLES, status)) is None:
                yield_core()
            buffer = bytearray(status.Get_count(self._mpi.BYTE))
            message.Recv(buffer)
            received[rank] = bytes(buffer)
        self._end(requests)
        return received

    def deal(self, messages: Sequence[bytes]) -> list[bytes]:
        """Send bytes to every rank."""
        received: list[bytes] = self._world.alltoall(list(messages))
        return received

    def all_failed(self) -> bool:
        """Whether every rank comes here in time."""
        request = self._failures.Ibarrier()
        limit = time.monotonic() + PATIENCE
        while not request.Test():
            if time.monotonic() > limit:
                time.sleep(TURN * self.rank)  # of several, the lowest speaks and ends the others
                return False
            time.sleep(0.01)
        return True

    def abort(self) -> None:
        """End all ranks."""
        sys.stdout.flush()
        sys.stderr.flush()
        self._world.Abort(1)
