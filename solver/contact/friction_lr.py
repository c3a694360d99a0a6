"""Coulomb friction between surfaces found by logistic regression."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, ClassVar

from solver.contact.law import Array, ContactLaw, ContactScene
from solver.contact.logistic_regression import (
    LEAST_MASS,
    TouchingSurfaces,
    overlaps,
    slide,
    touching_nodes,
    touching_surfaces,
)
from solver.contact.vectors import dot, minus, over, plus, put_vector, times, vector_at
from solver.declare import Parameter, model
from solver.deferred import deferred_kernel


@dataclass(kw_only=True)
class LogisticRegressionFriction(ContactLaw):
    """What friction laws with normals by logistic regression share."""

    needs_surface: ClassVar[bool] = True

    OneOrTwoStep: Annotated[int, Parameter("2: in both parts of a step, 1: only in the second", ge=1)] = 2

    @abstractmethod
    def friction_coefficients(self, scene: ContactScene, nodes: Array) -> Array:
        """The coefficient of friction at each of the nodes."""

    def apply(self, part: int, scene: ContactScene) -> None:
        """Stop approach and slip of overlapping bodies, within Coulomb's limit."""
        if part == 1 and self.OneOrTwoStep != 2:
            return
        surfaces = scene.once(touching_surfaces)
        nodes = scene.once(touching_nodes)
        scene.call(
            slide_apart,
            scene.velocity(part),
            scene.nodal.mass,
            surfaces,
            scene.listed(self.materials),
            nodes,
            self.friction_coefficients(scene, nodes),
        )


@model("contact", "friction_LR")
@dataclass(kw_only=True)
class FrictionLR(LogisticRegressionFriction):
    """Coulomb friction where the particles of two bodies overlap along their common normal and approach.

    At a node the alpha material (a rigid one, else that of most mass) faces each other listed material m.
    Where the most prominent particle of m reaches beyond that of alpha, and m approaches the centre of mass
    of the listed materials, m loses its approach and slip as in ``friction_bard`` and alpha takes the
    momentum lost.

    Source: Nairn, Hammerquist and Smith (2020), CMAME 362, 112859.
    """

    mu: Annotated[float, Parameter("coefficient of friction", ge=0.0)]

    def friction_coefficients(self, scene: ContactScene, nodes: Array) -> Array:
        """The same everywhere."""
        mu = scene.workspace.rows("friction coefficients", len(nodes), float)
        mu[:] = self.mu
        return mu


@deferred_kernel
def slide_apart(
    velocity: Array, mass: Array, surfaces: TouchingSurfaces, listed: Array, nodes: Array, mu: Array
) -> None:
    """Friction between alpha and the other listed materials at the given nodes; ``mu`` is per node."""
    for i in range(nodes.shape[0]):
        n = nodes[i]
        alpha = surfaces.alpha[n]
        momentum, total = (0.0, 0.0, 0.0), 0.0
        for m in listed:
            momentum = plus(momentum, times(mass[m, n], vector_at(velocity[m], n)))
            total += mass[m, n]
        common = over(momentum, total)
        outwards = times(-1.0, vector_at(surfaces.normal, n))
        for m in listed:
            relative = minus(vector_at(velocity[m], n), common)
            if m == alpha or not mass[m, n] > LEAST_MASS or not overlaps(surfaces, m, n):
                continue
            if dot(relative, outwards) > 0.0:
                change = slide(relative, outwards, mu[i])
                put_vector(velocity[m], n, plus(vector_at(velocity[m], n), change))
                taken = times(-mass[m, n] / mass[alpha, n], change)
                put_vector(velocity[alpha], n, plus(vector_at(velocity[alpha], n), taken))
