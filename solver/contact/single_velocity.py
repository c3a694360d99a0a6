"""Perfect stick: the materials at a node share one velocity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from solver.contact.law import PRESENT_MASS, Array, ContactLaw, ContactScene
from solver.contact.vectors import over, plus, put_vector, times, vector_at
from solver.declare import Parameter, model
from solver.deferred import deferred_kernel


@model("contact", "single_velocity")
@dataclass(kw_only=True)
class SingleVelocity(ContactLaw):
    """Every listed material takes the velocity of the common centre of mass, v = sum m v / sum m.

    Source: Sulsky, Chen and Schreyer (1994), the no-slip contact that a single velocity field gives.
    """

    OneOrTwoStep: Annotated[int, Parameter("2: in both parts of a step, 1: only in the second", ge=1)] = 2
    ExcludeMaterial: Annotated[int, Parameter("nodes that hold this material are left alone")] = -999
    mu: Annotated[float, Parameter("coefficient of friction", ignored="the materials stick")] = 0.0

    def apply(self, part: int, scene: ContactScene) -> None:
        """Give the listed materials one velocity."""
        if part == 1 and self.OneOrTwoStep != 2:
            return
        scene.call(
            share_velocity,
            scene.velocity(part),
            scene.nodal.mass,
            scene.listed(self.materials),
            self.ExcludeMaterial,
            scene.owned_nodes,
        )


@deferred_kernel
def share_velocity(velocity: Array, mass: Array, listed: Array, excluded: int, owned: Array) -> None:
    """Set the ``velocity`` (M, N, 3) of the ``listed`` materials to that of their centre of mass."""
    for n in range(owned.shape[0]):
        if not owned[n] or (excluded >= 0 and mass[excluded, n] >= PRESENT_MASS):
            continue
        momentum, total = (0.0, 0.0, 0.0), 0.0
        for m in listed:
            momentum = plus(momentum, times(mass[m, n], vector_at(velocity[m], n)))
            total += mass[m, n]
        for m in listed:
            put_vector(velocity[m], n, over(momentum, total))
