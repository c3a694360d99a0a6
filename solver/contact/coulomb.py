"""Friction between each material of a node and the centre of mass of all that are there."""

from __future__ import annotations

from typing import NamedTuple

from solver.contact.law import Array, ContactScene, same
from solver.contact.vectors import dot, length, minus, over, plus, times, vector_at
from solver.declare import Vector
from solver.dispatch import inline

NO_CHANGE = (0.0, 0.0, 0.0)
GREATEST_STRAIN = 0.5
"""A change of velocity that strains a cell by more in one step is scaled down to this."""


class CentreOfMass(NamedTuple):
    """The listed materials of one node taken together."""

    mass: float
    momentum: Vector
    volume: float


class Filling(NamedTuple):
    """How far the materials have to fill a node for a law to act there."""

    share: float
    """Of the cell volume at the node."""
    cell_volume: float
    per_radian: bool
    """Whether the cell volume is min(r, dx/2) dx dy, as in Uintah with axial symmetry."""
    spacing: Vector
    positions: Array
    """(N, 3) of the nodes."""
    node_to_cell_weight: Array
    """(N,) 1/8, more on faces of symmetry, where the node has less of a cell."""


def filling(scene: ContactScene, share: float, per_radian: bool) -> Filling:
    """The filling of a scene's nodes that a share of their cells makes."""
    return Filling(
        share,
        scene.cell_volume,
        per_radian,
        scene.grid.spacing,
        scene.node_positions,
        scene.node_to_cell_weight,
    )


@inline
def least_volume(needed: Filling, n: int) -> float:
    """The volume of the materials above which a law acts at a node."""
    volume = needed.cell_volume
    if needed.per_radian:
        dx, dy, _ = needed.spacing
        volume = min(needed.positions[n, 0], 0.5 * dx) * dx * dy
    return needed.share * volume / (8.0 * needed.node_to_cell_weight[n])


@inline
def centre_of_mass(velocity: Array, mass: Array, volume: Array, listed: Array, n: int) -> CentreOfMass:
    """Sums over the listed materials at a node."""
    total, momentum, filled = 0.0, (0.0, 0.0, 0.0), 0.0
    for m in listed:
        total += mass[m, n]
        momentum = plus(momentum, times(mass[m, n], vector_at(velocity[m], n)))
        filled += volume[m, n]
    return CentreOfMass(total, momentum, filled)


@inline
def shares_node(mass: float, total: float) -> bool:
    """Whether a material has mass at a node and is not the only one."""
    return not same(mass / total, 0.0) and not same(mass - total, 0.0)


@inline
def friction_change(relative: Vector, normal: Vector, mu: float) -> Vector:
    """Change of velocity that ends the approach and, up to Coulomb's limit, the slip.

    With w = relative . normal and t the unit vector of the part of ``relative`` across the normal,
    dv = -w n - t min(mu, (relative . t) / |w|) |w|.
    """
    w = dot(relative, normal)
    approach = times(w, normal)
    slip = minus(relative, approach)
    if same(dot(slip, slip), 0.0):
        return times(-1.0, approach)
    if same(w, 0.0):
        return NO_CHANGE
    tangent = over(slip, length(slip))
    friction = min(mu, dot(relative, tangent) / abs(w)) * abs(w)
    return times(-1.0, plus(approach, times(friction, tangent)))


@inline
def limited(change: Vector, mass: float, total: float, spacing: Vector, dt: float) -> Vector:
    """A change of velocity, less where it would strain the cell by more than GREATEST_STRAIN in the step."""
    strain = max(abs(change[0] / spacing[0]), abs(change[1] / spacing[1]), abs(change[2] / spacing[2])) * dt
    if same(strain, 0.0):
        return change
    strain *= max(1.0, mass / (total - mass))
    return times(min(strain, GREATEST_STRAIN) / strain, change)
