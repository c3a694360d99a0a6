"""Several ranks whose data go into one file, so that an archive of many ranks has fewer files."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ups.archive import Fields, Variable
from ups.archive.variables import NODE
from ups.patches import grid_of, stored_nodes

if TYPE_CHECKING:
    from solver.simulation import Simulation

Array = NDArray[Any]
Values = dict[Variable, dict[int, Array]]


class Gathering:
    """Brings what several ranks have to the first of them, who writes it as its own.

    Parameters
    ----------
    ranks_a_file : how many ranks in a row share a file; 1, as ``sus`` does it, for none.
    """

    def __init__(self, ranks_a_file: int = 1) -> None:
        self.ranks_a_file = ranks_a_file

    def fields(self, simulation: Simulation, fields: Fields) -> Fields:
        """For a rank that writes the values of all that share its file; for another, what it gave."""
        ranks = self._ranks(simulation)
        if len(ranks) == 1:
            return fields
        given = self._gathered(simulation, {v: dict(by_material) for v, by_material in fields.items()})
        if given is None:
            return fields
        return {
            variable: {
                m: self._together(simulation, variable, [part[variable][m] for part in given]) for m in mine
            }
            for variable, mine in fields.items()
        }

    def arrays(self, simulation: Simulation, arrays: dict[str, Array]) -> dict[str, Array]:
        """The same for arrays of particles by name."""
        if len(self._ranks(simulation)) == 1:
            return arrays
        given = self._gathered(simulation, arrays)
        return (
            arrays if given is None else {name: np.concatenate([g[name] for g in given]) for name in arrays}
        )

    def _ranks(self, simulation: Simulation) -> range:
        """The ranks that share the file of this one."""
        communicator = simulation.exchange.communicator
        first = communicator.rank // self.ranks_a_file * self.ranks_a_file
        return range(first, min(first + self.ranks_a_file, communicator.size))

    def _gathered(self, simulation: Simulation, mine: Any) -> list[Any] | None:
        """What all that share a file have, for the first of them; None for the others."""
        communicator, ranks = simulation.exchange.communicator, self._ranks(simulation)
        first = ranks[0]
        if communicator.rank != first:
            communicator.send_unannounced({first: pickle.dumps((stored_nodes(simulation), mine))})
            return None
        received = communicator.send_unannounced(dict.fromkeys(ranks[1:], b""))
        others = [pickle.loads(received[rank]) for rank in ranks[1:]]
        self._boxes = [stored_nodes(simulation), *(box for box, _ in others)]
        return [mine, *(theirs for _, theirs in others)]

    def _together(self, simulation: Simulation, variable: Variable, parts: Sequence[Any]) -> Array:
        """Particles one after the other; at nodes an array over the box around all."""
        arrays = [np.asarray(part) for part in parts]
        if variable.is_particle:
            return np.concatenate(arrays)
        level = grid_of(simulation, self.ranks_a_file).levels[0]
        whole = level.whole(NODE, rank=simulation.exchange.communicator.rank)
        values = np.zeros((*whole.shape, *arrays[0].shape[3:]))
        for box, array in zip(self._boxes, arrays, strict=True):
            if box.size:
                values[box.within(whole.low)] = array
        return values
