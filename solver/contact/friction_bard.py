"""Coulomb friction where surfaces press on each other or approach."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

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
from solver.contact.normals import SurfaceFields, shared_nodes, surface_fields
from solver.contact.vectors import dot, length, minus, over, plus, put_vector, times, vector_at
from solver.declare import Parameter, Vector, model
from solver.deferred import deferred_kernel

COMPRESSION = -1.0e-12
"""Normal traction below which a surface counts as pressed."""


@model("contact", "friction_bard", old_names=("friction",))
@dataclass(kw_only=True)
class FrictionBard(ContactLaw):
    """Coulomb friction against the common centre of mass of the materials at a node.

    Let a material m have the velocity v_m, surface normal n and normal traction T at a node whose centre of
    mass moves with v_cm. Where T < 0 or (v_m - v_cm) . n > 0 its approach is taken away and its slip reduced
    by at most mu times the approach. Two materials with colinear normals exchange momentum and lose none.

    Source: Bardenhagen, Guilkey, Roessig, Brackbill, Witzel and Foster (2001), CMES 2, 509-522.
    """

    mu: Annotated[float, Parameter("coefficient of friction", ge=0.0)]
    volume_constraint: Annotated[
        float, Parameter("acts where the materials fill more than this share of the cell volume", ge=0.0)
    ] = 0.0
    separation_factor: Annotated[
        float,
        Parameter("acts where mean positions of materials are closer than this many cell sizes", ge=0.0),
    ] = 9.9e99
    OneOrTwoStep: Annotated[int, Parameter("2: in both parts of a step, 1: only in the second", ge=1)] = 2

    def apply(self, part: int, scene: ContactScene) -> None:
        """Stop approach and slip, within Coulomb's limit."""
        if part == 1 and self.OneOrTwoStep != 2:
            return
        scene.call(
            apply_friction,
            scene.velocity(part),
            scene.nodal.mass,
            scene.nodal.volume,
            scene.once(surface_fields),
            scene.listed(self.materials),
            scene.once(shared_nodes),
            scene.owned_nodes,
            self.mu,
            filling(scene, self.volume_constraint, per_radian=scene.axisymmetric),
            self.separation_factor * np.cbrt(scene.cell_volume),
            scene.grid.spacing,
            scene.dt,
        )


@deferred_kernel
def apply_friction(
    velocity: Array,
    mass: Array,
    volume: Array,
    surface: SurfaceFields,
    listed: Array,
    nodes: Array,
    owned: Array,
    mu: float,
    needed: Filling,
    separation: float,
    spacing: Vector,
    dt: float,
) -> None:
    """Friction at those of the nodes that are owned (N,) and filled as needed.

    A material stays as it is where its mean position is ``separation`` or more from that of the others.
    """
    for n in nodes:
        if not owned[n]:
            continue
        centre = centre_of_mass(velocity, mass, volume, listed, n)
        if same(centre.mass, 0.0) or not centre.volume > least_volume(needed, n):
            continue
        common = over(centre.momentum, centre.mass)
        moment = (0.0, 0.0, 0.0)
        for m in listed:
            moment = plus(moment, times(mass[m, n], vector_at(surface.position[m], n)))
        position = over(moment, centre.mass)
        for m in listed:
            own = mass[m, n]
            if not shares_node(own, centre.mass):
                continue
            others = centre.mass / (centre.mass - own)
            if not others * length(minus(position, vector_at(surface.position[m], n))) < separation:
                continue
            relative = minus(vector_at(velocity[m], n), common)
            normal = vector_at(surface.normal[m], n)
            if surface.traction[m, n] < COMPRESSION or dot(relative, normal) > 0.0:
                change = limited(friction_change(relative, normal, mu), own, centre.mass, spacing, dt)
                put_vector(velocity[m], n, plus(vector_at(velocity[m], n), change))
