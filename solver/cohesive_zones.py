"""Cohesive zones: pieces of a surface that tie two materials until they are pulled or slid apart.

The traction law is that of Xu and Needleman (J. Mech. Phys. Solids 42, 1994) with r = 0, as it was brought to
the material point method by Daphalapurkar, Lu, Coker and Komanduri (Int. J. Fracture 143, 2007).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.creation import ParticleIds
from solver.declare import Parameter
from solver.geometry.read_table import read_table
from solver.grid import Grid
from solver.nodal import NodalFields
from solver.particles import StateVariable, keep, new_arrays
from solver.workspace import Workspace

if TYPE_CHECKING:
    from solver.simulation import Simulation

Array = NDArray[Any]

COLUMNS = 12
"""Numbers in a row of a file: position, area, normal, tangent, bottom material, top material."""

LEAST_MASS = 2.0e-200
"""Nodal mass above which a node has a velocity of the material."""

NO_WEIGHT = 1.0e-100
"""Added to sums of weights, so that a zone far from a material has velocity 0 instead of 0/0."""

STEPS_TO_RELEASE = 1000
"""Steps of opening in which a failed zone lets go."""

OFFSETS = np.array([[a, b, c] for c in (0, 1) for b in (0, 1) for a in (0, 1)])
"""The nodes of a cell."""


class CohesiveZone(NamedTuple):
    """The law of the zones of one file, by the opening D_n and the slidings D_1, D_2.

    Normal traction: e sig_max (D_n/d_n) exp(-D_n/d_n) (E_1 + (1 - q) (1 - E_1)) with E_i = exp(-(D_i/d_t)^2);
    tangential ones: sqrt(2 e) tau_max (D_i/d_t) (1 + D_n/d_n) exp(-D_n/d_n) E_i. The ratio of the energies is
    q = sqrt(e/2) tau_max d_t / (e sig_max d_n). Beyond its largest opening or sliding a zone has failed, and
    lets go within 1000 steps in which it opens. As in Uintah the second sliding does not count in E_1.
    """

    delta_n: Annotated[float, Parameter("opening of the largest normal traction", unit="m", gt=0.0)]
    delta_t: Annotated[
        float, Parameter("sliding, times sqrt(2), of the largest tangential traction", unit="m", gt=0.0)
    ]
    sig_max: Annotated[float, Parameter("largest normal traction", unit="Pa", gt=0.0)]
    tau_max: Annotated[float, Parameter("largest tangential traction", unit="Pa", gt=0.0)]
    cz_filename: Annotated[
        str,
        Parameter(
            "file with a row per zone: position, area, normal, tangent (ten numbers), bottom and top material"
        ),
    ]
    delta_n_fail: Annotated[
        float | None, Parameter("opening at failure; by default 4 delta_n", unit="m", gt=0.0)
    ] = None
    delta_t_fail: Annotated[
        float | None, Parameter("sliding at failure; by default 4 delta_t", unit="m", gt=0.0)
    ] = None
    do_rotation: Annotated[bool, Parameter("zones turn with their two materials")] = False
    name: Annotated[str, Parameter("a name for the reader", attribute=True)] = ""


class ZoneState(NamedTuple):
    """The zones of one material of zones, (n,) or (n, 3); an archive stores them as particles."""

    position: Annotated[Array, StateVariable("p.x", "Point")]
    area: Annotated[Array, StateVariable("cz.area")]
    normal: Annotated[Array, StateVariable("cz.norm", "Vector")]
    """From the bottom to the top material."""
    tangent: Annotated[Array, StateVariable("cz.tang", "Vector")]
    top_displacement: Annotated[Array, StateVariable("cz.disptop", "Vector")]
    bottom_displacement: Annotated[Array, StateVariable("cz.dispbottom", "Vector")]
    separation: Annotated[Array, StateVariable("cz.separation", "Vector")]
    force: Annotated[Array, StateVariable("cz.force", "Vector")]
    """On the bottom material; the top one feels the opposite."""
    top: Annotated[Array, StateVariable("cz.topmat", "int")]
    bottom: Annotated[Array, StateVariable("cz.botmat", "int")]
    failed: Annotated[Array, StateVariable("cz.failed", "int")]
    """0 while the zone is sound, then the number of steps in which it opened, at most 1000."""
    id: Annotated[Array, StateVariable("cz.CZID", "long64")]


def read_zones(file: Path, grid: Grid, materials: int, ids: ParticleIds) -> ZoneState:
    """The zones of a file that lie in the grid, or in the cells of this rank.

    Parameters
    ----------
    materials : number of materials of the deck; a zone names its two by their index.
    ids : gives ids to the zones of all files, apart from those of particles.

    Raises
    ------
    ValueError
        when a row is not twelve numbers or names a material that does not exist; names file and line.
    """
    table = read_table(file, COLUMNS)
    indices = table[:, 10:12]
    wrong = ((indices < 0) | (indices >= materials) | (indices != np.floor(indices))).any(axis=1)
    if wrong.any():
        row = int(np.flatnonzero(wrong)[0])
        raise ValueError(
            f"{file}: row {row + 1} names the materials {indices[row, 0]:g} and {indices[row, 1]:g}; "
            f"the deck has {materials}, the first is 0"
        )
    table = table[_in_domain(grid, table[:, :3]) & _in_own_cells(grid, table[:, :3])]
    zones = new_arrays(ZoneState, len(table))
    zones.position[:], zones.area[:] = table[:, :3], table[:, 3]
    zones.normal[:], zones.tangent[:] = table[:, 4:7], table[:, 7:10]
    zones.bottom[:], zones.top[:] = table[:, 10], table[:, 11]
    zones.id[:] = ids.assign(zones.position)
    return zones


def _in_domain(grid: Grid, positions: Array) -> Array:
    """Whether positions (n, 3) lie in a patch of the grid, (n,)."""
    cells = grid.cell_of(positions)
    inside = [((cells >= patch.low) & (cells < patch.high)).all(axis=1) for patch in grid.patches]
    return np.asarray(np.any(inside, axis=0))


def _in_own_cells(grid: Grid, positions: Array) -> Array:
    """Whether positions (n, 3) lie in cells of this rank, (n,)."""
    low, high = grid.own_cells
    cells = grid.cell_of(positions)
    return np.asarray(((cells >= low) & (cells < high)).all(axis=1))


def tractions(law: CohesiveZone, opening: Array, first: Array, second: Array) -> tuple[Array, Array, Array]:
    """Normal and tangential tractions, (n,) each, of an opening and two slidings, (n,)."""
    normal_work = math.e * law.sig_max * law.delta_n
    tangential_work = math.sqrt(0.5 * math.e) * law.tau_max * law.delta_t
    ratio = tangential_work / normal_work
    relative = opening / law.delta_n
    decay = np.exp(-relative)
    by_first, by_second = (np.exp(-((d / law.delta_t) ** 2)) for d in (first, second))
    normal = normal_work / law.delta_n * decay * relative * (by_first + (1.0 - ratio) * (1.0 - by_first))
    shear = 2.0 * normal_work / law.delta_t * (ratio + ratio * relative) * decay
    return normal, shear * (first / law.delta_t) * by_first, shear * (second / law.delta_t) * by_second


def has_failed(law: CohesiveZone, opening: Array, first: Array, second: Array) -> Array:
    """Whether a zone is opened, or slid, too far, (n,)."""
    largest_opening = 4.0 * law.delta_n if law.delta_n_fail is None else law.delta_n_fail
    largest_sliding = 4.0 * law.delta_t if law.delta_t_fail is None else law.delta_t_fail
    slid = (np.abs(first) > largest_sliding) | (np.abs(second) > largest_sliding)
    return np.asarray((np.abs(opening) > largest_opening) | slid)


def dot(a: Array, b: Array) -> Array:
    """Scalar products of vectors (n, 3)."""
    return np.einsum("nc,nc->n", a, b)


@dataclass
class CohesiveZones:
    """The zones of one file in a simulation.

    Where one of the two materials is not near, a zone neither moves with it nor pulls at the other. Of several
    ranks each has those in its cells, whose nodes it stores; they migrate as particles do.

    With ``do_rotation`` a zone turns like a rigid body with its two materials, separation included, so that
    bodies that are tied may turn as a whole. Uintah takes an angle from the square of the
    separation, which is a length and depends on the deck's units.

    Attributes
    ----------
    law : the traction law.
    zones : the zones at the start of a step.
    """

    law: CohesiveZone
    zones: ZoneState
    _moved: ZoneState | None = field(default=None, repr=False)

    @property
    def records(self) -> tuple[Any, ...]:
        """All arrays of the zones, as a body has them of its particles."""
        return (self.zones,)

    @records.setter
    def records(self, records: tuple[Any, ...]) -> None:
        (self.zones,) = records

    def act(self, grid: Grid, nodal: NodalFields, dt: float, force: Array) -> None:
        """Let the zones follow the two materials, and add what they pull with to ``force`` (materials, nodes, 3).

        ``nodal`` holds velocities and masses after contact has acted on them for the first time. The force on
        a material goes to the nodes about the zone (at its old place) by weight and nodal mass.
        """
        nodes, weights = self._nodes_about(grid)
        self._moved = self._follow(grid, nodal, nodes, weights, dt)
        bottom, top = (
            weights * nodal.mass[material[:, None], nodes] for material in (self.zones.bottom, self.zones.top)
        )
        near = np.minimum(bottom.sum(axis=1), top.sum(axis=1)) > LEAST_MASS
        for material, share, sign in ((self.zones.bottom, bottom, 1.0), (self.zones.top, top, -1.0)):
            share /= share.sum(axis=1, keepdims=True)
            pull = sign * (self._moved.force * near[:, None])[:, None, :] * share[:, :, None]
            np.add.at(force, (material[:, None], nodes), pull)

    def settle(self, grid: Grid) -> None:
        """Take over the places of the last :meth:`act`; zones that left the domain are gone."""
        if self._moved is not None:
            _wrap(grid, self._moved.position)
            self.zones = keep(self._moved, _in_domain(grid, self._moved.position))
            self._moved = None

    def _nodes_about(self, grid: Grid) -> tuple[Array, Array]:
        """The eight nodes of each zone's cell, (n, 8), and their trilinear weights.

        Where the domain repeats and one rank has all of it, the nodes are those that own the values.
        """
        relative = (self.zones.position - np.array(grid.anchor)) / np.array(grid.spacing)
        cell = np.floor(relative).astype(np.int64)
        part = (relative - cell)[:, None, :]
        weights = np.where(OFFSETS, part, 1.0 - part).prod(axis=2)
        index = cell[:, None, :] + OFFSETS
        if grid.window is None:
            index = np.where(np.array(grid.periodic, bool), index % np.array(grid.cells), index)
        i, j, k = np.moveaxis(index, 2, 0)
        return grid.flat(i, j, k), weights

    def _follow(self, grid: Grid, nodal: NodalFields, nodes: Array, weights: Array, dt: float) -> ZoneState:
        """The zones at the end of the step, with their forces."""
        old = self.zones
        top, bottom = (_velocity(nodal, m, nodes, weights) for m in (old.top, old.bottom))
        top_displacement = old.top_displacement + top * dt
        bottom_displacement = old.bottom_displacement + bottom * dt
        separation = top_displacement - bottom_displacement
        normal, tangent = old.normal, old.tangent
        if self.law.do_rotation:
            angle = self._spin(grid, nodal, nodes) * dt
            normal, tangent = _turned(normal, angle), _turned(tangent, angle)
            separation = _turned(old.separation, angle) + (top - bottom) * dt
        second_tangent = np.cross(tangent, normal)
        deltas = dot(separation, normal), dot(separation, tangent), dot(separation, second_tangent)
        opens = np.linalg.norm(separation, axis=1) >= np.linalg.norm(old.separation, axis=1)
        sound = old.failed == 0
        released = np.minimum(old.failed + opens, STEPS_TO_RELEASE)
        failed = np.where(sound, has_failed(self.law, *deltas), released).astype(np.int32)
        along = zip(tractions(self.law, *deltas), (normal, tangent, second_tangent), strict=True)
        traction = sum(size[:, None] * direction for size, direction in along)
        held = np.where(sound, 1.0, 1.0 - released / STEPS_TO_RELEASE)
        return old._replace(
            position=old.position + 0.5 * (top + bottom) * dt,
            normal=normal,
            tangent=tangent,
            top_displacement=top_displacement,
            bottom_displacement=bottom_displacement,
            separation=separation,
            force=traction * (old.area * held)[:, None],
            failed=failed,
        )

    def _spin(self, grid: Grid, nodal: NodalFields, nodes: Array) -> Array:
        """Angular velocities (n, 3) with which the two materials turn about their centres at the zones.

        omega = I^-1 L with the moments of inertia I and of momentum L of the masses at the nodes, both summed
        over the two materials: the rigid motion that comes closest to theirs. Only distances along the zone
        count, since velocities across a body's edge are not known well at nodes.
        """
        places = OFFSETS * np.array(grid.spacing)
        momentum, inertia = np.zeros((len(nodes), 3)), np.zeros((len(nodes), 3, 3))
        for material in (self.zones.top, self.zones.bottom):
            mass = nodal.mass[material[:, None], nodes][:, :, None]
            velocity = nodal.velocity[material[:, None], nodes]
            arm = places - (mass * places).sum(axis=1, keepdims=True) / mass.sum(axis=1, keepdims=True)
            arm -= np.einsum("nka,na,nb->nkb", arm, self.zones.normal, self.zones.normal)
            momentum += (mass * np.cross(arm, velocity)).sum(axis=1)
            spread = np.einsum("nka,nkb->nab", mass * arm, arm)
            inertia += np.trace(spread, axis1=1, axis2=2)[:, None, None] * np.eye(3) - spread
        return np.einsum("nab,nb->na", np.linalg.pinv(inertia, hermitian=True), momentum)


def attach(simulation: Simulation, zones: Sequence[CohesiveZones]) -> None:
    """Let the zones of all files act between contact and the accelerations of a simulation, and move with it."""
    simulation.cohesive_zones += zones
    room = Workspace()

    def act(sim: Simulation, dt: float) -> None:
        pulled = sim.nodal.external_force
        forces = room.rows("forces", pulled.size, np.float64).reshape(pulled.shape)
        forces[:] = 0.0
        for tied in sim.cohesive_zones:
            tied.act(sim.grid, sim.nodal, dt, forces)
        sim.exchange.add(*forces)()
        pulled += forces

    def settle(sim: Simulation, dt: float) -> None:
        for tied in sim.cohesive_zones:
            tied.settle(sim.grid)

    simulation.after_contact.append(act)
    simulation.after_step.append(settle)


def _wrap(grid: Grid, positions: Array) -> None:
    """Bring positions (n, 3) back into the domain in the directions in which it repeats, in place."""
    for axis in np.flatnonzero(grid.periodic):
        low, high = grid.anchor[axis], grid.upper[axis]
        positions[:, axis] = low + (positions[:, axis] - low) % (high - low)
        cell = grid.cell_of(positions)[:, axis]
        positions[(cell < 0) | (cell >= grid.cells[axis]), axis] = low  # a rounding error beyond a face


def _velocity(nodal: NodalFields, material: Array, nodes: Array, weights: Array) -> Array:
    """Velocities (n, 3) of a material at the zones, over the nodes where there is any of it."""
    there = weights * (nodal.mass[material[:, None], nodes] > LEAST_MASS)
    velocity = nodal.velocity[material[:, None], nodes]
    return np.asarray((velocity * there[:, :, None]).sum(axis=1) / (there.sum(axis=1) + NO_WEIGHT)[:, None])


def _turned(vectors: Array, angle: Array) -> Array:
    """Vectors (n, 3) turned about an axis by the length of ``angle`` (n, 3): Rodrigues' formula."""
    size = np.linalg.norm(angle, axis=1, keepdims=True)
    axis = angle / (size + NO_WEIGHT)
    across, along = np.cross(axis, vectors), dot(axis, vectors)[:, None]
    return np.asarray(np.cos(size) * vectors + np.sin(size) * across + (1.0 - np.cos(size)) * along * axis)
