"""Materials that share one concentration where they meet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from solver.declare import Parameter, model
from solver.diffusion.interface import Array, DiffusionInterface, NodalConcentration


@model("diffusion_interface", "common")
@dataclass(frozen=True)
class CommonInterface(DiffusionInterface):
    """At the nodes the listed materials have their mean concentration and its mean rate, weighted by mass.

    So they are like one material. Uintah weighs by the masses of all materials, the rates by the square of the
    mass, and pulls the particles to the mean at once, which leaves noise at the interface.
    """

    materials: Annotated[tuple[int, ...], Parameter("indices of the materials; all without", ge=0)] = ()

    def share_concentration(self, nodal: NodalConcentration) -> None:
        """Give the listed materials their mean concentration."""
        self._average(nodal.mass, nodal.concentration)
        self._average(nodal.mass, nodal.projected)

    def share_rate(self, nodal: NodalConcentration, dt: float) -> None:
        """Give the listed materials their mean rate."""
        self._average(nodal.mass, nodal.rate)

    def _average(self, mass: Array, values: Array) -> None:
        m = self.listed(len(mass))
        values[m] = (mass[m] * values[m]).sum(axis=0) / mass[m].sum(axis=0)
