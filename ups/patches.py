"""The patches of an archive, and which rank writes them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from solver.domains.decomposition import Domain
from solver.grid import Grid
from ups.archive import Box, Level, Patch
from ups.archive import Grid as ArchiveGrid
from ups.archive.variables import NODE

if TYPE_CHECKING:
    from solver.simulation import Simulation


@lru_cache(maxsize=4)
def archive_grid(grid: Grid, domains: Sequence[Domain] = (), ranks_a_file: int = 1) -> ArchiveGrid:
    """The grid as an archive describes it: the patches of the deck, cut where ranks meet.

    Parameters
    ----------
    grid : the grid, or any rank's window of it.
    domains : the domain of each rank, a tuple; empty for one rank.
    ranks_a_file : how many ranks in a row leave the writing to the first of them.
    """
    ranks = domains or (Domain((0, 0, 0), grid.cells),)
    lows, highs = np.array([d.low for d in ranks]), np.array([d.high for d in ranks])
    patches: list[Patch] = []
    for patch in grid.patches:
        low, high = np.maximum(lows, patch.low), np.minimum(highs, patch.high)
        for rank in np.flatnonzero((low < high).all(axis=1)).tolist():
            (x0, y0, z0), (x1, y1, z1) = low[rank].tolist(), high[rank].tolist()
            writer = rank // ranks_a_file * ranks_a_file
            patches.append(Patch(len(patches), writer, (x0, y0, z0), (x1, y1, z1)))
    px, py, pz = (bool(p) for p in grid.periodic)
    return ArchiveGrid((Level(0, grid.anchor, grid.spacing, grid.extra_cells, (px, py, pz), tuple(patches)),))


def grid_of(simulation: Simulation, ranks_a_file: int = 1) -> ArchiveGrid:
    """The grid of an archive, with the domains that ranks have now."""
    return archive_grid(simulation.grid, simulation.exchange.domains, ranks_a_file)


def stored_nodes(simulation: Simulation) -> Box:
    """The nodes of which this rank gives the values: those of its patches and their extra cells."""
    rank, level = simulation.exchange.communicator.rank, grid_of(simulation).levels[0]
    first = simulation.grid.index.first
    return level.whole(NODE, rank=rank) if level.positions_of(rank) else Box(first, first)
