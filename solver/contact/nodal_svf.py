"""Drag between two materials that flow through each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from solver.contact.law import PRESENT_MASS, ContactLaw, ContactScene
from solver.declare import Parameter, model


@model("contact", "nodal_svf")
@dataclass(kw_only=True)
class NodalVolumeFraction(ContactLaw):
    """A force on each of two materials in proportion to the difference of their velocities.

    f_a = -f_b = myu V (v_b - v_a), with V the cell volume, times the volume fractions of both if ``use_svf``.
    Acts after the forces. (Where more than two materials exist and two are listed, Uintah takes the last of
    all for the second; here the listed ones are taken.)
    """

    myu: Annotated[float, Parameter("drag coefficient per volume", unit="kg/(m^3 s)", ge=0.0)]
    use_svf: Annotated[bool, Parameter("drag in proportion to both volume fractions")]
    mu: Annotated[float, Parameter("coefficient of friction", ignored="myu is the coefficient")] = 0.0

    def check(self, materials: int) -> None:
        """See that the law acts on two materials.

        Raises
        ------
        ValueError : if not.
        """
        super().check(materials)
        count = len(set(self.materials)) if self.materials else materials
        if count != 2:
            raise ValueError(f"nodal_svf acts on two <materials>, here it has {count}")

    def apply(self, part: int, scene: ContactScene) -> None:
        """Let the materials drag each other."""
        if part == 1:
            return
        first, second = scene.listed(self.materials)
        weight = 8.0 * scene.node_to_cell_weight
        nodal = scene.nodal
        drag = np.full(weight.shape, scene.cell_volume * self.myu)
        if self.use_svf:
            drag *= (weight * nodal.volume[first] / scene.cell_volume) * (
                weight * nodal.volume[second] / scene.cell_volume
            )
        else:
            drag[(nodal.mass[first] <= PRESENT_MASS) | (nodal.mass[second] <= PRESENT_MASS)] = 0.0
        acting = scene.owned_nodes
        difference = (nodal.velocity_star[second] - nodal.velocity_star[first])[acting]
        impulse = (drag * scene.dt / weight)[acting, None] * difference
        nodal.velocity_star[first, acting] += impulse / nodal.mass[first, acting, None]
        nodal.velocity_star[second, acting] -= impulse / nodal.mass[second, acting, None]
