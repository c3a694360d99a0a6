"""Coulomb friction by logistic regression, with a coefficient that varies over the master's surface."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np

from solver.contact.friction_lr import LogisticRegressionFriction
from solver.contact.law import Array, ContactScene, check_material
from solver.contact.particle_shapes import ParticleShapes, particle_shapes, shape_of
from solver.declare import Parameter, model
from solver.deferred import deferred_kernel
from solver.interpolation.shape import MOST_NODES
from solver.scratch import scratch_numbers, scratch_rows


class FrictionEntry(NamedTuple):
    """One row of a table of friction coefficients."""

    color: Annotated[float, Parameter("colour of the master's particles")]
    mu: Annotated[float, Parameter("coefficient of friction there", ge=0.0)]


@dataclass(kw_only=True)
class VariableFriction:
    """A table of friction coefficients over colour."""

    entry: Annotated[tuple[FrictionEntry, ...], Parameter("rows, by increasing colour")] = ()


@model("contact", "friction_LRVar")
@dataclass(kw_only=True)
class FrictionLRVar(LogisticRegressionFriction):
    """As ``friction_LR``, with mu from the colour of the master's particles around the node.

    Between rows of the table mu is linear, before the first and after the last it is constant. (Uintah goes
    on with the first slope before the first row.)
    """

    variable_friction: Annotated[VariableFriction, Parameter("coefficient of friction over colour")]
    master_material: Annotated[int, Parameter("index of the material whose colour counts", ge=0)]
    mu: Annotated[float, Parameter("coefficient of friction", ignored="variable_friction has it")] = 0.0

    def check(self, materials: int) -> None:
        """See that the master is one of the materials and the table has two rows of increasing colour.

        Raises
        ------
        ValueError : if not.
        """
        super().check(materials)
        check_material("master_material", self.master_material, materials)
        if self.materials and self.master_material not in self.materials:
            raise ValueError(f"<master_material> {self.master_material} must be one of <materials>")
        colors = [row.color for row in self.variable_friction.entry]
        if len(colors) < 2:
            raise ValueError("<variable_friction> needs at least two <entry>")
        if any(after <= before for before, after in pairwise(colors)):
            raise ValueError("<variable_friction>: the colors of its entries must increase")

    def friction_coefficients(self, scene: ContactScene, nodes: Array) -> Array:
        """The table's coefficients at the nodal colours of the master."""
        color = scene.workspace.zeros("color at nodes", len(scene.owned_nodes), float)
        particles = scene.particles[self.master_material]
        shapes = particle_shapes(scene, self.master_material)
        scene.call(add_weighted, shapes, particles.color, particles.mass, color)
        scene.exchange.add(color)()
        mean = scene.workspace.rows("mean color", len(nodes), float)
        scene.call(divide_at, nodes, color, scene.nodal.mass[self.master_material], mean)
        table = np.array(self.variable_friction.entry)
        return np.interp(mean, table[:, 0], table[:, 1])


@deferred_kernel
def divide_at(nodes: Array, sums: Array, mass: Array, means: Array) -> None:
    """Enter for each of the k nodes the sum there over the mass there (N,)."""
    for i in range(nodes.shape[0]):
        means[i] = sums[nodes[i]] / mass[nodes[i]]


@deferred_kernel
def add_weighted(shapes: ParticleShapes, values: Array, mass: Array, nodal: Array) -> None:
    """Sum S times mass times a value per particle (n,) at the nodes (N,)."""
    nodes, weights, gradients = (
        scratch_numbers(MOST_NODES, np.int64),
        scratch_numbers(MOST_NODES, np.float64),
        scratch_rows(MOST_NODES, 3),
    )
    for p in range(values.shape[0]):
        weighted = values[p] * mass[p]
        for k in range(shape_of(shapes, p, nodes, weights, gradients)):
            nodal[shapes.images.node[nodes[k]]] += weighted * weights[k]
