"""The fracture strain of Johnson and Cook."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

from numpy.typing import NDArray

from solver.declare import Parameter, SubModel, model
from solver.dispatch import implements, inline, lanewise
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
from solver.tensor import Tensor, deviator, norm, trace

LARGEST_TRIAXIALITY = 1.5
"""The fit does not reach beyond this ratio of mean to equivalent stress."""


@model("damage", "johnson_cook")
class JohnsonCookDamage(NamedTuple):
    """Johnson and Cook (1985), Eng. Fract. Mech. 21, 31: D' = ep' / ep_f, with fracture at D = 1.

    ep_f = (D1 + D2 exp(D3 s)) (1 + D4 ln ep') (1 + D5 T*) with s = sigma_m / sigma_eq within +-1.5 and
    T* = (T - T_room) / (T_melt - T_room); below 1/s the middle factor is (1 + ep')^D4. Damage does not change
    the stress, and below ``critical_scalar_damage`` it is set to zero, as in Uintah.
    """

    D1: Annotated[float, Parameter("fracture strain at large tension")]
    D2: Annotated[float, Parameter("coefficient of the triaxiality")]
    D3: Annotated[float, Parameter("exponential of the triaxiality")]
    D4: Annotated[float, Parameter("strain rate coefficient")]
    D5: Annotated[float, Parameter("temperature coefficient")]
    initial_mean_scalar_damage: Annotated[float, Parameter("mean damage at the start", ge=0.0)] = 0.0
    initial_std_scalar_damage: Annotated[
        float, Parameter("standard deviation of the damage at the start", ge=0.0)
    ] = 0.0
    critical_scalar_damage: Annotated[float, Parameter("damage below which there is none", ge=0.0)] = 1.0e-10
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
def _(model: JohnsonCookDamage, constitutive_model: Any) -> JohnsonCookDamage:
    check_flows("johnson_cook", constitutive_model)
    return model


@initialize_damage.register
def _(model: JohnsonCookDamage, state: ScalarDamage, particles: Particles, patch: NDArray[Any]) -> None:
    state.damage[:] = draw(
        model.initial_scalar_damage_distrib,
        model.initial_mean_scalar_damage,
        model.initial_std_scalar_damage,
        patch,
    )


@inline
def fracture_strain(
    model: JohnsonCookDamage, stress: Tensor, plastic_strain_rate: float, homologous_temperature: float
) -> float:
    """Plastic strain at fracture under a steady stress."""
    mean, equivalent = trace(stress) / 3.0, math.sqrt(1.5) * norm(deviator(stress))
    sheared = equivalent != 0.0
    triaxiality = where(sheared, mean / where(sheared, equivalent, 1.0), 0.0)
    triaxiality = min(max(triaxiality, -LARGEST_TRIAXIALITY), LARGEST_TRIAXIALITY)
    slow = plastic_strain_rate < 1.0
    rate_factor = 1.0 + model.D4 * math.log(max(plastic_strain_rate, 1.0))
    if anywhere(slow):
        rate_factor = where(slow, (1.0 + plastic_strain_rate) ** model.D4, rate_factor)
    stress_factor = model.D1 + model.D2 * math.exp(model.D3 * triaxiality)
    return stress_factor * rate_factor * (1.0 + model.D5 * homologous_temperature)


@implements(update_damage, JohnsonCookDamage)
@lanewise
def _(
    model: JohnsonCookDamage, state: ScalarDamage, p: int, point: DamagePoint, material: Material, step: Step
) -> DamageUpdate:
    damage = state.damage[p]
    flows = point.plastic_strain_rate != 0.0
    if anywhere(flows):
        warmer = point.temperature - material.room_temperature
        homologous = warmer / (material.melt_temperature - material.room_temperature)
        strain = fracture_strain(model, point.stress, point.plastic_strain_rate, homologous)
        damage += where(flows, point.plastic_strain_rate * step.dt / strain, 0.0)
    state.damage[p] = where(damage >= model.critical_scalar_damage, damage, 0.0)
    return DamageUpdate(point.stress, point.localized)


@implements(counts_strain, JohnsonCookDamage)
def _(model: JohnsonCookDamage) -> bool:
    return True


@implements(scalar_damage, JohnsonCookDamage)
@lanewise
def _(model: JohnsonCookDamage, state: ScalarDamage, p: int) -> float:
    return state.damage[p]
