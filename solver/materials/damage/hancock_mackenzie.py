"""The fracture strain of Hancock and MacKenzie."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

from numpy.typing import NDArray

from solver.declare import Parameter, SubModel, model
from solver.dispatch import implements, lanewise
from solver.lanes import anywhere, where
from solver.materials.constitutive import Material, Step
from solver.materials.damage import (
    DamagePoint,
    DamageUpdate,
    ScalarDamage,
    counts_strain,
    for_constitutive_model,
    initialize_damage,
    scalar_damage,
    update_damage,
)
from solver.materials.distribution import draw
from solver.materials.distribution.constant import Constant
from solver.materials.failure import check_flows
from solver.particles import Particles
from solver.tensor import deviator, norm, trace

LARGEST_EXPONENT = 700.0


@model("damage", "hancock_mackenzie")
class HancockMacKenzieDamage(NamedTuple):
    """Hancock and MacKenzie (1976), J. Mech. Phys. Solids 24, 147: damage grows in tension.

    D' = ep' exp(1.5 sigma_m / sigma_eq) / 1.65 for a positive mean stress, else none, with fracture at D = 1.
    Damage does not change the stress.
    """

    initial_mean_scalar_damage: Annotated[float, Parameter("mean damage at the start", ge=0.0)] = 0.0
    initial_std_scalar_damage: Annotated[
        float, Parameter("standard deviation of the damage at the start", ge=0.0)
    ] = 0.0
    critical_scalar_damage: Annotated[
        float, Parameter("damage at fracture", ignored="damage does not change the stress")
    ] = 1.0
    initial_scalar_damage_distrib: Annotated[
        Any,
        SubModel("distribution"),
        Parameter("spread of initial damage", tag="initial_scalar_damage_distrib"),
    ] = Constant()

    @property
    def State(self) -> type:  # noqa: N802 - the class attribute of other models
        """The arrays of a particle set."""
        return ScalarDamage


@for_constitutive_model.register
def _(model: HancockMacKenzieDamage, constitutive_model: Any) -> HancockMacKenzieDamage:
    check_flows("hancock_mackenzie", constitutive_model)
    return model


@initialize_damage.register
def _(model: HancockMacKenzieDamage, state: ScalarDamage, particles: Particles, patch: NDArray[Any]) -> None:
    state.damage[:] = draw(
        model.initial_scalar_damage_distrib,
        model.initial_mean_scalar_damage,
        model.initial_std_scalar_damage,
        patch,
    )


@implements(update_damage, HancockMacKenzieDamage)
@lanewise
def _(
    model: HancockMacKenzieDamage,
    state: ScalarDamage,
    p: int,
    point: DamagePoint,
    material: Material,
    step: Step,
) -> DamageUpdate:
    mean, equivalent = trace(point.stress) / 3.0, math.sqrt(1.5) * norm(deviator(point.stress))
    grows = (mean > 0.0) & (equivalent > 0.0) & (point.plastic_strain_rate != 0.0)
    if anywhere(grows):
        exponent = min(1.5 * mean / where(grows, equivalent, 1.0), LARGEST_EXPONENT)
        growth = point.plastic_strain_rate * step.dt * math.exp(exponent) / 1.65
        state.damage[p] += where(grows, growth, 0.0)
    return DamageUpdate(point.stress, point.localized)


@implements(counts_strain, HancockMacKenzieDamage)
def _(model: HancockMacKenzieDamage) -> bool:
    return True


@implements(scalar_damage, HancockMacKenzieDamage)
@lanewise
def _(model: HancockMacKenzieDamage, state: ScalarDamage, p: int) -> float:
    return state.damage[p]
