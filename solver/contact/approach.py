"""Coulomb friction where surfaces approach each other, whatever their stress."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from solver.contact.coulomb import (
    Filling,
    centre_of_mass,
    filling,
    friction_change,
    least_volume,
    limited,
    shares_node,
)
from solver.contact.law import Array, ContactLaw, ContactScene, same
from solver.contact.normals import surface_fields
from solver.contact.vectors import dot, minus, over, plus, put_vector, vector_at
from solver.declare import Parameter, Vector, model
from solver.deferred import deferred_kernel


@model("contact", "approach")
@dataclass(kw_only=True)
class ApproachContact(ContactLaw):
    """As ``friction_bard``, but only where (v_m - v_cm) . n > 0: pressed surfaces part without resistance.

    Meant for bodies in a gas, whose pressure would otherwise count as contact. Acts in both parts of a step.
    """

    mu: Annotated[float, Parameter("coefficient of friction", ge=0.0)]
    volume_constraint: Annotated[
        float, Parameter("acts where the materials fill more than this share of the cell volume", ge=0.0)
    ] = 0.0

    def apply(self, part: int, scene: ContactScene) -> None:
        """Stop approach and slip, within Coulomb's limit."""
        scene.call(
            apply_approach,
            scene.velocity(part),
            scene.nodal.mass,
            scene.nodal.volume,
            scene.once(surface_fields).normal,
            scene.listed(self.materials),
            scene.owned_nodes,
            self.mu,
            filling(scene, self.volume_constraint, per_radian=False),
            scene.grid.spacing,
            scene.dt,
        )


@deferred_kernel
def apply_approach(
    velocity: Array,
    mass: Array,
    volume: Array,
    normals: Array,
    listed: Array,
    owned: Array,
    mu: float,
    needed: Filling,
    spacing: Vector,
    dt: float,
) -> None:
    """Friction of approaching materials at each owned node (N,) that they fill as needed."""
    for n in range(owned.shape[0]):
        if not owned[n]:
            continue
        centre = centre_of_mass(velocity, mass, volume, listed, n)
        if same(centre.mass, 0.0) or not centre.volume > least_volume(needed, n):
            continue
        common = over(centre.momentum, centre.mass)
        for m in listed:
            relative = minus(vector_at(velocity[m], n), common)
            normal = vector_at(normals[m], n)
            if shares_node(mass[m, n], centre.mass) and dot(relative, normal) > 0.0:
                change = friction_change(relative, normal, mu)
                change = limited(change, mass[m, n], centre.mass, spacing, dt)
                put_vector(velocity[m], n, plus(vector_at(velocity[m], n), change))
