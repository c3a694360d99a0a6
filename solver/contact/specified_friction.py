"""A rigid material with prescribed motion, and friction between it and the materials that it touches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from solver.contact.law import PRESENT_MASS, Array, ContactScene, same
from solver.contact.logistic_regression import (
    NO_ALPHA,
    TouchingSurfaces,
    overlaps,
    slide,
    touching_surfaces,
)
from solver.contact.motion import (
    Motion,
    PrescribedMotion,
    Reactions,
    add_reaction,
    counted_and_others,
    new_reactions,
    report_reactions,
    rigid_velocity,
)
from solver.contact.vectors import dot, minus, over, plus, put_vector, times, vector_at
from solver.declare import Parameter, model
from solver.deferred import deferred_kernel


@model("contact", "specified_friction")
@dataclass(kw_only=True)
class SpecifiedFriction(PrescribedMotion):
    """The master moves as prescribed; others that overlap and approach it are stopped, with Coulomb friction.

    As ``friction_LR`` with the prescribed velocity of the master in place of that of the centre of mass: the
    master gives way to nothing.
    """

    needs_surface: ClassVar[bool] = True

    mu: Annotated[float, Parameter("coefficient of friction", ge=0.0)]

    def apply(self, part: int, scene: ContactScene) -> None:
        """Move the master and let others slide on it; in part 2 add the reactions to the reductions."""
        if not self.acts_in(part, scene):
            return
        nodal = scene.nodal
        reactions = new_reactions(nodal.mass.shape[0])
        for nodes, its_reactions in counted_and_others(scene, owned_nodes(scene), reactions):
            scene.call(
                slide_on_master,
                scene.velocity(part),
                nodal.mass,
                nodal.internal_force,
                scene.once(touching_surfaces),
                nodes,
                self.acted_on(scene),
                self.master_material,
                self.ExcludeMaterial,
                self.motion(scene),
                scene.node_positions,
                self.mu,
                its_reactions,
            )
        if part == 2:
            report_reactions(scene, self.master_material, reactions)


def owned_nodes(scene: ContactScene) -> Array:
    """The indices of the patches' nodes."""
    nodes = scene.list_of_nodes("owned nodes")
    return nodes[: scene.call(list_owned, scene.owned_nodes, nodes)]


@deferred_kernel
def list_owned(owned: Array, nodes: Array) -> int:
    """List the owned nodes (N,); returns how many they are."""
    count = 0
    for n in range(owned.shape[0]):
        if owned[n]:
            nodes[count] = n
            count += 1
    return count


@deferred_kernel
def slide_on_master(
    velocity: Array,
    mass: Array,
    internal_force: Array,
    surfaces: TouchingSurfaces,
    nodes: Array,
    listed: Array,
    master: int,
    excluded: int,
    motion: Motion,
    positions: Array,
    mu: float,
    reactions: Reactions,
) -> None:
    """Impose the motion on the master, friction on what overlaps it, and add up what the master receives."""
    for n in nodes:
        position = vector_at(positions, n)
        rigid = rigid_velocity(motion, position, vector_at(velocity[master], n))
        if surfaces.alpha[n] == NO_ALPHA:
            if mass[master, n] > PRESENT_MASS:
                put_vector(velocity[master], n, rigid)
            continue
        if excluded >= 0 and mass[excluded, n] >= PRESENT_MASS:
            continue
        put_vector(velocity[master], n, rigid)
        if same(mass[master, n], 0.0):
            continue
        outwards = times(-1.0, vector_at(surfaces.normal, n))
        for m in listed:
            relative = minus(vector_at(velocity[m], n), rigid)
            if m == master or same(mass[m, n], 0.0) or not overlaps(surfaces, m, n):
                continue
            if dot(relative, outwards) > 0.0:
                change = slide(relative, outwards, mu)
                put_vector(velocity[m], n, plus(vector_at(velocity[m], n), change))
                rate = over(times(mass[m, n], change), motion.dt)
                add_reaction(reactions, m, motion, position, vector_at(internal_force[m], n), rate)
