"""Materials that come to one concentration where they meet within a step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from solver.declare import Parameter, model
from solver.diffusion.interface import DiffusionInterface, NodalConcentration
from solver.nodal import EMPTY_MASS


@model("diffusion_interface", "simple")
@dataclass(frozen=True)
class SimpleInterface(DiffusionInterface):
    """At nodes of several materials each gets the rate (C - c) / dt towards their mean C, weighted by volume."""

    materials: Annotated[tuple[int, ...], Parameter("indices of the materials; all without", ge=0)] = ()

    def share_rate(self, nodal: NodalConcentration, dt: float) -> None:
        """Add the rates towards the mean concentration."""
        m = self.listed(len(nodal.mass))
        volume, c = nodal.volume[m], nodal.concentration[m]
        present = volume > 2.0 * EMPTY_MASS
        mean = (volume * c).sum(axis=0) / volume.sum(axis=0)
        shared = present.sum(axis=0) > 1
        nodal.rate[m] += (present & shared) * (mean - c) / dt
