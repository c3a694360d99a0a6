"""Drag between two materials that flow through each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from solver.contact.law import PRESENT_MASS, Array, ContactLaw, ContactScene
from solver.contact.vectors import minus, over, plus, put_vector, times, vector_at
from solver.declare import Parameter, model
from solver.deferred import deferred_kernel


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
        nodal = scene.nodal
        scene.call(
            drag,
            nodal.velocity_star,
            nodal.mass,
            nodal.volume,
            first,
            second,
            scene.owned_nodes,
            scene.node_to_cell_weight,
            scene.cell_volume,
            self.myu,
            self.use_svf,
            scene.dt,
        )


@deferred_kernel
def drag(
    velocity: Array,
    mass: Array,
    volume: Array,
    first: int,
    second: int,
    owned: Array,
    node_to_cell_weight: Array,
    cell_volume: float,
    myu: float,
    by_fractions: bool,
    dt: float,
) -> None:
    """Change the ``velocity`` (M, N, 3) of two materials at the owned nodes (N,)."""
    for n in range(owned.shape[0]):
        if not owned[n]:
            continue
        weight = 8.0 * node_to_cell_weight[n]
        strength = cell_volume * myu
        if by_fractions:
            strength *= (weight * volume[first, n] / cell_volume) * (weight * volume[second, n] / cell_volume)
        elif mass[first, n] <= PRESENT_MASS or mass[second, n] <= PRESENT_MASS:
            strength = 0.0
        difference = minus(vector_at(velocity[second], n), vector_at(velocity[first], n))
        impulse = times(strength * dt / weight, difference)
        put_vector(velocity[first], n, plus(vector_at(velocity[first], n), over(impulse, mass[first, n])))
        put_vector(velocity[second], n, minus(vector_at(velocity[second], n), over(impulse, mass[second, n])))
