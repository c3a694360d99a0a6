"""Prescribed motion of a rigid material: profiles in time, and the parameters of laws that use them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np

from solver.contact.law import NEGLIGIBLE, PRESENT_MASS, Array, ContactLaw, ContactScene, check_material
from solver.contact.vectors import cross, minus, over, plus
from solver.declare import Parameter, Vector
from solver.deferred import deferred_kernel
from solver.dispatch import inline

TRANSLATION_COLUMNS = 4
ROTATION_COLUMNS = 10
EARLIEST = -1.0e9
"""Times of a profile are later than this."""

NO_AXIS = -1
ALIGNED = 0.99
"""Cosine of the angle to a coordinate axis from which a rotation is treated as being about that axis."""


@dataclass(frozen=True)
class Profile:
    """Motion of a rigid body in time: velocity of translation and, if any, rotation about a moving point.

    Attributes
    ----------
    times : (k,) strictly increasing.
    values : (k, 3) velocities, or (k, 9) velocity, origin of rotation, angular velocity in rad per time.
    """

    times: Array
    values: Array

    def at(self, time: float) -> Array:
        """The values at a time: linear between rows, constant before the first and after the last."""
        if time <= self.times[0]:
            return self.values[0]
        if time >= self.times[-1]:
            return self.values[-1]
        after = int(np.searchsorted(self.times, time, side="left"))
        before = after - 1
        xi = (time - self.times[before]) / (self.times[after] - self.times[before])
        return xi * self.values[after] + (1.0 - xi) * self.values[before]

    def advanced(self, time: float, to_rest: bool) -> Profile:
        """The profile that at ``time`` is already at its next row or, with ``to_rest``, next row of rest.

        Rows from there on come earlier by the same amount, rows passed over are dropped; without such a row
        the profile stays as it is.
        """
        candidates = self.times > time
        if to_rest:
            candidates &= ~np.any(self.values[:, :3], axis=1)
        if not candidates.any():
            return self
        following = int(np.argmax(candidates))
        kept = np.concatenate([np.flatnonzero(self.times <= time), np.arange(following, len(self.times))])
        times = self.times[kept].copy()
        times[self.times[kept] > time] -= self.times[following] - time
        return replace(self, times=times, values=self.values[kept])


def read_profile(file: Path, rotation: bool) -> Profile:
    """Read rows ``t vx vy vz`` or, with rotation, ``t vx vy vz ox oy oz wx wy wz``; empty lines are skipped.

    Raises
    ------
    ValueError : naming file and line, when a row cannot be understood, times do not increase, or there are
        fewer than two rows.
    """
    columns = ROTATION_COLUMNS if rotation else TRANSLATION_COLUMNS
    form = "t vx vy vz ox oy oz wx wy wz" if rotation else "t vx vy vz"
    rows: list[list[float]] = []
    for number, line in enumerate(_lines(file), start=1):
        words = line.split()
        if not words:
            continue
        place = f"{file}:{number}"
        try:
            row = [float(word) for word in words]
        except ValueError:
            raise ValueError(f"{place}: not a row of numbers; each row is: {form}") from None
        if len(row) != columns:
            raise ValueError(f"{place}: {len(row)} numbers where a row has {columns}: {form}")
        if not all(map(math.isfinite, row)):
            raise ValueError(f"{place}: every number must be finite")
        if row[0] <= (rows[-1][0] if rows else EARLIEST):
            raise ValueError(f"{place}: time {row[0]:g} is not after the one before it; times must increase")
        rows.append(row)
    if len(rows) < 2:
        raise ValueError(f"{file}: a profile needs at least two rows: {form}")
    table = np.array(rows)
    return Profile(table[:, 0], table[:, 1:])


def _lines(file: Path) -> list[str]:
    try:
        return file.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        raise ValueError(f"{file}: a profile is a text file of numbers") from None


class Motion(NamedTuple):
    """The rigid motion that is imposed in one step, for kernels."""

    follows_master: bool
    """True: each node takes the master's own nodal velocity and the rest here does not matter."""
    velocity: Vector
    rotates: bool
    origin: Vector
    """A point on the axis of rotation."""
    angular_velocity: Vector
    axis: int
    """0, 1 or 2 where the axis of rotation is that of x, y or z, else NO_AXIS."""
    dt: float


@inline
def rotation_velocity(motion: Motion, position: Vector) -> Vector:
    """Mean velocity over the step of a point that turns with the body.

    About a coordinate axis it is (x(theta + omega dt) - x(theta)) / dt, so that points stay on their circle;
    about any other it is omega x r.
    """
    r = minus(position, motion.origin)
    if motion.axis == NO_AXIS:
        return cross(motion.angular_velocity, r)
    b, c = (motion.axis + 1) % 3, (motion.axis + 2) % 3
    angle = math.atan2(r[c], r[b]) + motion.angular_velocity[motion.axis] * motion.dt
    radius = math.sqrt(r[b] * r[b] + r[c] * r[c])
    turned_b = radius * math.cos(angle) + motion.origin[b] - position[b]
    turned_c = radius * math.sin(angle) + motion.origin[c] - position[c]
    if motion.axis == 0:
        moved = (0.0, turned_b, turned_c)
    elif motion.axis == 1:
        moved = (turned_c, 0.0, turned_b)
    else:
        moved = (turned_b, turned_c, 0.0)
    return over(moved, motion.dt)


@inline
def rigid_velocity(motion: Motion, position: Vector, master_velocity: Vector) -> Vector:
    """The velocity that the motion prescribes at a node."""
    if motion.follows_master:
        return master_velocity
    if motion.rotates:
        return plus(rotation_velocity(motion, position), motion.velocity)
    return motion.velocity


def _vector(values: Array) -> Vector:
    return (float(values[0]), float(values[1]), float(values[2]))


def _axis_of(angular_velocity: Vector) -> int:
    speed = math.sqrt(sum(w * w for w in angular_velocity))
    for axis, component in enumerate(angular_velocity):
        if speed > 0.0 and abs(component / speed) > ALIGNED:
            return axis
    return NO_AXIS


@dataclass(kw_only=True)
class PrescribedMotion(ContactLaw):
    """What laws with a rigid master material share: how it moves.

    Until ``stop_time`` the master moves by the profile of ``filename`` or, without one, with the velocity it
    has; then with ``velocity_after_stop``. The master is always one of the materials acted on, and as in
    Uintah it is the only one where the deck lists none.
    """

    filename: Annotated[
        str, Parameter("file of rows t vx vy vz [ox oy oz wx wy wz] that prescribes the motion of the master")
    ] = ""
    master_material: Annotated[int, Parameter("index of the material that leads; it becomes rigid", ge=0)] = 0
    stop_time: Annotated[float, Parameter("when velocity_after_stop takes over", unit="s")] = math.inf
    velocity_after_stop: Annotated[Vector, Parameter("velocity after stop_time", unit="m/s")] = (
        0.0,
        0.0,
        0.0,
    )
    include_rotation: Annotated[bool, Parameter("the file gives origin and angular velocity too")] = False
    OneOrTwoStep: Annotated[
        int,
        Parameter("2: in both parts of a step, 1: only in the second; always 2 with XPIC2", ge=1),
    ] = 1
    ExcludeMaterial: Annotated[int, Parameter("nodes that hold this material are left alone")] = -999

    profile: Profile | None = None
    """What :meth:`load` read; not a tag of the deck."""

    def load(self, open_file: Callable[[str], Path]) -> None:
        """Read ``filename``, if given; ``open_file`` finds the path of a name in the deck.

        Raises
        ------
        ValueError : naming file and line, if the file is no profile.
        """
        if self.filename:
            self.profile = read_profile(open_file(self.filename), self.include_rotation)

    def check(self, materials: int) -> None:
        """See that the master and the excluded material exist.

        Raises
        ------
        ValueError : if one does not.
        """
        super().check(materials)
        check_material("master_material", self.master_material, materials)

    @property
    def made_rigid(self) -> tuple[int, ...]:
        """The master."""
        return (self.master_material,)

    def acts_in(self, part: int, scene: ContactScene) -> bool:
        """Whether the law acts in a part of the step."""
        return part == 2 or scene.xpic2 or self.OneOrTwoStep == 2

    def acted_on(self, scene: ContactScene) -> Array:
        """Indices of the materials acted on, the master among them."""
        return scene.listed((*self.materials, self.master_material))

    def master_nodes(self, scene: ContactScene) -> Array:
        """Indices of the patches' nodes that hold mass of the master and none of the excluded material."""
        nodes = scene.list_of_nodes("nodes of the master")
        count = scene.call(
            list_master_nodes,
            scene.nodal.mass,
            self.master_material,
            self.ExcludeMaterial,
            scene.owned_nodes,
            nodes,
        )
        return nodes[:count]

    def motion(self, scene: ContactScene) -> Motion:
        """The rigid motion of this step."""
        velocity = origin = angular_velocity = (0.0, 0.0, 0.0)
        stopped = scene.time > self.stop_time
        if stopped:
            velocity = self.velocity_after_stop
        elif (profile := self.profile_in_force) is not None:
            values = profile.at(scene.time)
            velocity = _vector(values[0:3])
            if self.include_rotation:
                origin, angular_velocity = _vector(values[3:6]), _vector(values[6:9])
        return Motion(
            follows_master=not stopped and self.profile is None,
            velocity=velocity,
            rotates=self.include_rotation,
            origin=origin,
            angular_velocity=angular_velocity,
            axis=_axis_of(angular_velocity),
            dt=scene.dt,
        )

    @property
    def profile_in_force(self) -> Profile | None:
        """The profile as it now is; a law whose profile depends on what happens in the run overrides this."""
        return self.profile


@deferred_kernel
def list_master_nodes(mass: Array, master: int, excluded: int, owned: Array, nodes: Array) -> int:
    """List the owned nodes (N,) that hold mass of the master alone; returns how many they are."""
    count = 0
    for n in range(owned.shape[0]):
        if owned[n] and mass[master, n] > NEGLIGIBLE and (excluded < 0 or mass[excluded, n] < PRESENT_MASS):
            nodes[count] = n
            count += 1
    return count


class Reactions(NamedTuple):
    """What a rigid master takes from the materials it acts on."""

    force: Array
    """(M, 3) minus the internal force at the nodes acted on, per material."""
    torque: Array
    """(M, 3) its moment about the origin of rotation; zero without rotation."""
    transmitted: Array
    """(3,) minus the rate of momentum that the law gives."""


def new_reactions(materials: int) -> Reactions:
    """Zeros."""
    return Reactions(np.zeros((materials, 3)), np.zeros((materials, 3)), np.zeros(3))


def counted_and_others(
    scene: ContactScene, nodes: Array, reactions: Reactions
) -> list[tuple[Array, Reactions]]:
    """Nodes whose reactions count, and copies that other ranks count, each with where its reactions go."""
    parted = scene.list_of_nodes("counted nodes and others")[: len(nodes)]
    counted = scene.call(part_nodes, nodes, scene.exchange.counted, parted)
    return [(parted[:counted], reactions), (parted[counted:], new_reactions(len(reactions.force)))]


@deferred_kernel
def part_nodes(nodes: Array, counted: Array, parted: Array) -> int:
    """Enter first the nodes that are counted (N,), then the others, both in order; returns how many are counted."""
    count = 0
    for n in nodes:
        if counted[n]:
            parted[count] = n
            count += 1
    following = count
    for n in nodes:
        if not counted[n]:
            parted[following] = n
            following += 1
    return count


@inline
def add_reaction(
    reactions: Reactions,
    m: int,
    motion: Motion,
    position: Vector,
    internal_force: Vector,
    impulse_rate: Vector,
) -> None:
    """Add what one node passes on; ``impulse_rate`` is nodal mass times change of velocity over dt."""
    moment = (0.0, 0.0, 0.0)
    if motion.rotates:
        moment = cross(minus(position, motion.origin), internal_force)
    for axis in range(3):
        reactions.force[m, axis] -= internal_force[axis]
        reactions.torque[m, axis] -= moment[axis]
        reactions.transmitted[axis] -= impulse_rate[axis]


def report_reactions(scene: ContactScene, master: int, reactions: Reactions) -> None:
    """Enter RigidReactionForce, RigidReactionTorque and SumTransmittedForce in the reductions of the step.

    The master's entry, and that of -1, is the sum over the other materials.
    """
    count = len(reactions.force)
    others = [m for m in range(count) if m != master]
    reactions.force[master] = reactions.force[others].sum(axis=0)
    reactions.torque[master] += reactions.torque[others].sum(axis=0)
    transmitted = np.zeros((count, 3))
    transmitted[master] = reactions.transmitted
    for label, values in (
        ("RigidReactionForce", reactions.force),
        ("RigidReactionTorque", reactions.torque),
        ("SumTransmittedForce", transmitted),
    ):
        scene.add_reduction(label, -1, values[master])
        if count > 1:
            for m in range(count):
                scene.add_reduction(label, m, values[m])
