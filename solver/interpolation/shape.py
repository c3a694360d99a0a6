"""What every interpolator provides: the nodes that a particle touches, their weights and gradients.

Kernels use them through :func:`scatter`, which adds what a particle carries to its nodes, and :func:`gather`, which
sums nodal values at a particle.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solver.dispatch import generic, generic_with_default, inline, lanewise
from solver.grid import GridIndex, NodeBlock
from solver.lanes import WIDTH, Lanes, every, lanes_at, put_lanes
from solver.particles import Particles
from solver.scratch import scratch_numbers, scratch_rows
from solver.tensor import Tensor, tensor_at

MOST_NODES = 64
"""Room that callers give to :func:`shape_functions`; no interpolator touches more nodes."""


@generic
def particle_domain(interpolator: Any, deformation_gradient: Tensor, size: Tensor) -> Tensor:
    """The particle's vectors r1, r2, r3 (columns, cell units) that the shape functions of this step use.

    ``size`` holds the initial vectors; interpolators whose particle domains deform return F times that.
    """
    raise NotImplementedError


@generic
def shape_functions(
    interpolator: Any,
    grid: GridIndex,
    x: float,
    y: float,
    z: float,
    domain: Tensor,
    nodes: Any,
    weights: Any,
    gradients: Any,
) -> int:
    """Weights of a particle at (x, y, z) on the nodes around it.

    Fills ``nodes`` (storage indices), ``weights`` S and ``gradients`` (.., 3), the derivatives of S by x, y, z
    in 1/length, and returns how many entries count. Axisymmetric interpolators put S/r, which the hoop
    components need, into the third column.
    """
    raise NotImplementedError


class Room(NamedTuple):
    """Room for the shape functions of the particles that a loop is at."""

    nodes: Any
    """(MOST_NODES,) as :func:`shape_functions` fills them, for one particle."""
    weights: Any
    gradients: Any
    factors: Any
    """(80, 8), a column for each of eight particles: what :func:`prepare` stores."""


@inline
def new_room() -> Room:
    """Room for any interpolator, to be made once for a loop over particles."""
    return Room(
        scratch_numbers(MOST_NODES, np.uint64),
        scratch_numbers(MOST_NODES, np.float64),
        scratch_rows(MOST_NODES, 3),
        scratch_rows(80, WIDTH),
    )


@generic_with_default
def prepare(
    interpolator: Any, grid: GridIndex, block: NodeBlock, particles: Particles, first: int, room: Room
) -> bool:
    """Do for the particles ``first`` to ``first + 7`` what is sooner done for eight at once.

    :func:`is_near`, :func:`scatter` and :func:`gather` of a particle have to be called after that, with its number
    among the eight as ``lane``, and before it is called for the next eight. False where it was seen early that none
    of the eight has nodes in the block.
    """
    return True


@inline
def shapes_of(interpolator: Any, grid: GridIndex, particles: Particles, p: int, room: Room) -> int:
    """Fill in nodes, weights and gradients of a particle and return how many count."""
    F, size = tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
    return shape_functions(
        interpolator,
        grid,
        particles.position[p, 0],
        particles.position[p, 1],
        particles.position[p, 2],
        particle_domain(interpolator, F, size),
        room.nodes,
        room.weights,
        room.gradients,
    )


class Content(NamedTuple):
    """What a particle gives to a node of weight S and gradient G = (gx, gy, gz), in two groups of channels.

    The node gets ``plain`` S in the first and ``mixed`` S + ``by_x`` gx + ``by_y`` gy + ``by_z`` gz in the second.
    """

    plain: Lanes
    mixed: Lanes
    by_x: Lanes
    by_y: Lanes
    by_z: Lanes


class Sums(NamedTuple):
    """What particles are summed into."""

    rows: Any
    """(N, 16), one row a node."""
    touched: Any
    """(N,) set to 1 at every node that something is added to."""


@lanewise
@generic_with_default
def scatter(
    interpolator: Any,
    grid: GridIndex,
    block: NodeBlock,
    particles: Particles,
    p: int,
    lane: int,
    content: Content,
    sums: Sums,
    room: Room,
) -> None:
    """Add what particle ``p`` carries to its nodes in ``block``."""
    count = shapes_of(interpolator, grid, particles, p, room)
    for n in range(count):
        node, S = room.nodes[n], room.weights[n]
        if in_block(grid, block, node):
            sums.touched[node] = 1
            put_lanes(sums.rows, node, 0, lanes_at(sums.rows, node, 0) + content.plain * S)
            gx, gy, gz = room.gradients[n, 0], room.gradients[n, 1], room.gradients[n, 2]
            more = content.mixed * S + content.by_x * gx + content.by_y * gy + content.by_z * gz
            put_lanes(sums.rows, node, 8, lanes_at(sums.rows, node, 8) + more)


@inline
def in_block(grid: GridIndex, block: NodeBlock, node: int) -> bool:
    """Whether a block holds a node."""
    if block.whole:
        return True
    row, low, high = np.uint64(grid.nodes[0]), block.low, block.high
    layer = row * np.uint64(grid.nodes[1])
    i, j, k = np.int64(node % row), np.int64(node % layer // row), np.int64(node // layer)
    return bool(low[0] <= i < high[0] and low[1] <= j < high[1] and low[2] <= k < high[2])


class Gathered(NamedTuple):
    """Sums over the nodes of a particle of the rows (8) of nodal values: times S, and times the components of G."""

    value: Lanes
    by_x: Lanes
    by_y: Lanes
    by_z: Lanes


@inline
def nothing() -> Lanes:
    """Eight zeros."""
    return every(0.0)


@generic_with_default
def gather(
    interpolator: Any, grid: GridIndex, particles: Particles, p: int, lane: int, rows: Any, room: Room
) -> Gathered:
    """Interpolate what rows (N, ..) of nodal values begin with, and its gradients, to particle ``p``."""
    count = shapes_of(interpolator, grid, particles, p, room)
    value, by_x, by_y, by_z = nothing(), nothing(), nothing(), nothing()
    for n in range(count):
        row = lanes_at(rows, room.nodes[n], 0)
        value = value + row * room.weights[n]
        by_x = by_x + row * room.gradients[n, 0]
        by_y = by_y + row * room.gradients[n, 1]
        by_z = by_z + row * room.gradients[n, 2]
    return Gathered(value, by_x, by_y, by_z)


@generic_with_default
def reach(interpolator: Any, domain: Tensor) -> float:
    """No node of a particle is farther away than that in any direction, in cells.

    How far threads and ranks look follows from it. The default is that of a layer of nodes around the cell's own.
    """
    return 2.0


@generic_with_default
def is_near(
    interpolator: Any, grid: GridIndex, block: NodeBlock, particles: Particles, p: int, lane: int, room: Room
) -> bool:
    """Whether particle ``p`` may have nodes in a block."""
    if block.whole:
        return True
    F, size = tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
    far = reach(interpolator, particle_domain(interpolator, F, size))
    near = True
    for axis in range(3):
        q = (particles.position[p, axis] - grid.anchor[axis]) / grid.spacing[axis] - grid.first[axis]
        near = near and block.low[axis] <= q + far and q - far < block.high[axis]
    return near
