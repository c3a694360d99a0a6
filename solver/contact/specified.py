"""A rigid material whose motion is imposed on the materials that it touches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from solver.contact.law import Array, ContactScene
from solver.contact.motion import (
    Motion,
    PrescribedMotion,
    Profile,
    Reactions,
    add_reaction,
    counted_and_others,
    new_reactions,
    report_reactions,
    rigid_velocity,
)
from solver.contact.normals import surface_fields
from solver.contact.vectors import dot, minus, over, put_vector, times, vector_at
from solver.declare import IntVector, Parameter, Vector, model
from solver.deferred import deferred_kernel
from solver.dispatch import inline

FACES = ("xminus", "xplus", "yminus", "yplus", "zminus", "zplus")
NEXT_ENTRY, ZERO_VELOCITY = "GoToNextEntry", "GoToZeroVelocity"
NEVER = 9.0e98


@model("contact", "specified", "rigid", "specified_velocity")
@dataclass(kw_only=True)
class Specified(PrescribedMotion):
    """Where the master has mass, listed materials take its velocity in the chosen directions.

    v_k <- u_k for the directions k with ``direction`` 1, u being the prescribed velocity of the master. The
    master itself takes all of u after the forces. With ``normal_only`` another material loses, after the
    forces, no more than the part of v - u that goes against the master's surface normal n:
    if (v - u) . n < 0, v <- v - ((v - u) . n) n. (In Uintah that holds for the master too, which then does
    not follow a profile.)

    A ``condition`` lets the force on a face of the domain (one of ``boundary_traction_faces``) change the
    motion once: when a component exceeds ``conditionValue``, the profile goes on from its next row or from
    its next row of rest. (Uintah looks for the row of rest from the start of the file, so that a profile that
    begins with rest starts anew; here it is the next one.)
    """

    direction: Annotated[IntVector, Parameter("1 in the directions that are imposed, else 0", ge=0, le=1)] = (
        0,
        0,
        1,
    )
    volume_constraint: Annotated[
        float, Parameter("acts where the materials fill more than this share of the cell volume", ge=0.0)
    ] = 0.0
    normal_only: Annotated[bool, Parameter("others may slide along the master and part from it")] = False
    condition: Annotated[str, Parameter("face whose force changes the motion", choices=FACES)] = ""
    conditionValue: Annotated[float, Parameter("force on that face that changes it", unit="N")] = 9.0e99
    conditionAction: Annotated[
        str, Parameter("where the profile goes on", choices=(NEXT_ENTRY, ZERO_VELOCITY))
    ] = ""
    mu: Annotated[float, Parameter("coefficient of friction", ignored="see specified_friction")] = 0.0

    condition_met_at: float | None = None
    """Time at which the condition was met: a state of the run, which a checkpoint has to keep."""

    @property
    def never_alpha(self) -> tuple[int, ...]:
        """The master."""
        return (self.master_material,)

    @property
    def profile_in_force(self) -> Profile | None:
        """The profile, changed if its condition was met."""
        if self.profile is None or self.condition_met_at is None:
            return self.profile
        return self.profile.advanced(self.condition_met_at, to_rest=self.conditionAction == ZERO_VELOCITY)

    def apply(self, part: int, scene: ContactScene) -> None:
        """Impose the motion, and in part 2 add the reactions to the reductions."""
        if not self.acts_in(part, scene):
            return
        nodal = scene.nodal
        nodes = self.master_nodes(scene)
        if part == 1:
            scene.call(
                impose_velocity,
                nodal.velocity,
                nodes,
                self.acted_on(scene),
                self.master_material,
                self.motion(scene),
                scene.node_positions,
                self.direction,
            )
            return
        self.watch_condition(scene)
        reactions = new_reactions(nodal.mass.shape[0])
        for part_of_nodes, its_reactions in counted_and_others(scene, self.filled(scene, nodes), reactions):
            scene.call(
                impose_velocity_star,
                nodal.velocity_star,
                nodal.mass,
                nodal.internal_force,
                part_of_nodes,
                self.acted_on(scene),
                self.master_material,
                self.motion(scene),
                scene.node_positions,
                self.direction,
                self.normals(scene),
                its_reactions,
            )
        report_reactions(scene, self.master_material, reactions)

    def normals(self, scene: ContactScene) -> Array:
        """(N, 3) surface normals of the master, or nothing where they do not matter."""
        if not self.normal_only:
            return np.zeros((0, 3))
        return scene.once(surface_fields).normal[self.master_material]

    def filled(self, scene: ContactScene, nodes: Array) -> Array:
        """Those of the nodes that all materials together fill beyond the constraint."""
        filled = scene.list_of_nodes("filled nodes")
        count = scene.call(
            list_filled,
            nodes,
            scene.nodal.volume,
            scene.node_to_cell_weight,
            scene.cell_volume,
            self.volume_constraint,
            filled,
        )
        return filled[:count]

    def watch_condition(self, scene: ContactScene) -> None:
        """Note the time when the force on the watched face, in the step before, first exceeds its limit."""
        if self.condition_met_at is not None or self.conditionValue >= NEVER or scene.time <= scene.dt:
            return
        force = scene.face_forces.get(self.condition, (0.0, 0.0, 0.0))
        if max(abs(component) for component in force) > self.conditionValue:
            self.condition_met_at = scene.time


@deferred_kernel
def list_filled(
    nodes: Array,
    volume: Array,
    node_to_cell_weight: Array,
    cell_volume: float,
    share: float,
    filled: Array,
) -> int:
    """List the nodes at which the volumes (M, N) are more than a share of a cell; returns how many they are."""
    count = 0
    for n in nodes:
        total = 0.0
        for m in range(volume.shape[0]):
            total += volume[m, n]
        if total * 8.0 * node_to_cell_weight[n] / cell_volume > share:
            filled[count] = n
            count += 1
    return count


@deferred_kernel
def impose_velocity(
    velocity: Array,
    nodes: Array,
    listed: Array,
    master: int,
    motion: Motion,
    positions: Array,
    direction: IntVector,
) -> None:
    """Part 1: give the listed materials the chosen components of the master's velocity."""
    for n in nodes:
        rigid = rigid_velocity(motion, vector_at(positions, n), vector_at(velocity[master], n))
        for m in listed:
            put_vector(velocity[m], n, chosen_components(rigid, vector_at(velocity[m], n), direction, False))


@deferred_kernel
def impose_velocity_star(
    velocity: Array,
    mass: Array,
    internal_force: Array,
    nodes: Array,
    listed: Array,
    master: int,
    motion: Motion,
    positions: Array,
    direction: IntVector,
    normal: Array,
    reactions: Reactions,
) -> None:
    """Part 2: impose the velocity after the forces and add up what the master receives for it.

    ``normal`` (N, 3) holds the master's surface normals, or nothing where the chosen directions are imposed.
    """
    for n in nodes:
        position = vector_at(positions, n)
        rigid = rigid_velocity(motion, position, vector_at(velocity[master], n))
        for m in listed:
            old = vector_at(velocity[m], n)
            if normal.shape[0] > 0 and m != master:
                approach = min(0.0, dot(vector_at(normal, n), minus(old, rigid)))
                new = minus(old, times(approach, vector_at(normal, n)))
            else:
                new = chosen_components(rigid, old, direction, m == master)
            put_vector(velocity[m], n, new)
            rate = times(mass[m, n], over(minus(new, old), motion.dt))
            add_reaction(reactions, m, motion, position, vector_at(internal_force[m], n), rate)


@inline
def chosen_components(rigid: Vector, old: Vector, direction: IntVector, every: bool) -> Vector:
    """The components of ``rigid`` in the chosen directions and those of ``old`` in the others."""
    return (
        rigid[0] if every or direction[0] else old[0],
        rigid[1] if every or direction[1] else old[1],
        rigid[2] if every or direction[2] else old[2],
    )
