"""The model of scale: what a rank sends in a step, as a function of cells, particles and ranks.

Two kinds of message go to every neighbour in every step: the sums at shared nodes, one for each body (and for each
further sum over particles, such as those of contact), and the particles that leave. Beside them there are three
reductions over all ranks. docs/parallel.md works out what that costs on many ranks; tests count what is sent.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from solver.declare import IntVector

NUMBER = 8
"""Bytes of a double."""

REDUCTIONS = 3
"""Reductions over all ranks in a step: the sums, the extremes, and the agreement of the run on time and stop."""


class Cost(NamedTuple):
    """What one rank sends in a step."""

    neighbours: int
    messages: int
    halo_bytes: int
    """Sums at shared nodes, where particles touch all of them; the rows of nodes that none touches are not sent."""
    particle_bytes: float
    """Particles that leave, and a number of particles of each body in every message."""


def shared_nodes(cells: IntVector, layers: int, cut: IntVector) -> int:
    """Numbers that a rank inside the grid sends for one number a node.

    A neighbour across a face, edge or corner gets the nodes that both store, 2 layers + 1 deep across the cut.

    Parameters
    ----------
    cells : cells of the rank's domain, at least 2 layers + 1 in a direction that is cut.
    layers : layers of its halo.
    cut : 1 in the directions in which there are neighbours on both sides, else 0; there it stores
        cells + 1 + 2 layers nodes.
    """
    depth = 2 * layers + 1
    whole = [n + 1 + 2 * layers for n in cells]
    total = 0
    for sides in _neighbours(cut):
        total += math.prod(depth if side else n for side, n in zip(sides, whole, strict=True))
    return total


def _neighbours(cut: IntVector) -> list[IntVector]:
    """The directions (-1, 0, 1)^3 of the neighbours of a rank."""
    x, y, z = (range(-1, 2) if c else range(1) for c in cut)
    return [(i, j, k) for i in x for j in y for k in z if (i, j, k) != (0, 0, 0)]


def cost(
    cells: IntVector,
    layers: int,
    channels: Sequence[int],
    bytes_a_particle: float,
    leavers: float,
    cut: IntVector = (1, 1, 1),
) -> Cost:
    """What a rank sends in a step.

    Parameters
    ----------
    cells, layers, cut : as for :func:`shared_nodes`.
    channels : numbers a node of each sum: ``CHANNELS`` of ``solver.kernels.transfer`` for every body, then those of
        contact and of what else is summed. With them goes a number that says which node it is, and in each message
        one that says how many there are.
    bytes_a_particle : all that a particle carries.
    leavers : particles that leave in a step, for instance speed times dt times the particles a volume times the
        area of the cuts.
    """
    neighbours = len(_neighbours(cut))
    nodes = shared_nodes(cells, layers, cut)
    return Cost(
        neighbours,
        neighbours * (len(channels) + 1),
        NUMBER * sum(nodes * (1 + c) + neighbours for c in channels),
        leavers * bytes_a_particle + neighbours * NUMBER,
    )
