"""Nodal fields of all materials, as contact, boundary conditions and the step share them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.grid import Grid

Array = NDArray[Any]

EMPTY_MASS = 1.0e-200
"""Mass and volume that every node starts from, so that an empty node has velocity 0 instead of 0/0."""


class NodalFields(NamedTuple):
    """Values at the nodes, first axis the material (0..M-1), second the node in storage order (see GridIndex)."""

    mass: Array
    """(M, N)"""
    volume: Array
    """(M, N)"""
    velocity: Array
    """(M, N, 3) before the accelerations of the step."""
    velocity_star: Array
    """(M, N, 3) after them."""
    acceleration: Array
    """(M, N, 3)"""
    internal_force: Array
    """(M, N, 3)"""
    external_force: Array
    """(M, N, 3)"""
    temperature: Array
    """(M, N)"""
    temperature_rate: Array
    """(M, N)"""
    heat: Array
    """(M, N) rate of heat by conduction and external sources divided by specific heat, mass times K/s."""

    def of(self, m: int) -> NodalFields:
        """The fields of one material, without the first axis."""
        return NodalFields(*(field[m] for field in self))


def new_nodal_fields(grid: Grid, materials: int) -> NodalFields:
    """Fields of empty nodes."""
    scalar = (materials, grid.number_of_nodes)
    fields = NodalFields(
        *(np.zeros(scalar + (3,) * (name in _VECTORS)) for name in NodalFields._fields),
    )
    fields.mass[:] = fields.volume[:] = EMPTY_MASS
    return fields


_VECTORS = {"velocity", "velocity_star", "acceleration", "internal_force", "external_force"}
