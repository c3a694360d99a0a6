"""Brittle damage that softens stress in tension."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.lanes import anywhere, negation, where
from solver.materials.constitutive import Material, Step
from solver.materials.damage import (
    DamagePoint,
    DamageUpdate,
    for_constitutive_model,
    initialize_damage,
    update_damage,
)
from solver.materials.failure_criterion.principal_strain import largest_strain
from solver.particles import Array, Particles, StateVariable
from solver.tensor import trace

MOST_DAMAGE = 0.999


class BrittleState(NamedTuple):
    """What a brittle particle remembers, each (n,)."""

    threshold: Annotated[Array, StateVariable("p.epsf")]
    """The largest tau so far."""
    damage: Annotated[Array, StateVariable("p.damage")]
    """Negative while it is recovered."""


@model("damage", "Brittle")
class BrittleDamage(NamedTuple):
    """Cervera, Oliver and Manzoli (1996), Earthquake Eng. Struct. Dyn. 25: softening by tensile strain.

    Under tension tau = sqrt(E) e, with the largest principal strain e of Almansi, raises the damage to
    0.999 / D ((1 + D) / (1 + D exp(-C (tau - tau_0))) - 1), C = tau_0 l (1 + D) ln(1 + D) / (G_f D), at most
    by a given increment a step; l is the particle's size. The stress is (1 - damage) times what the
    constitutive model says, or, while tau falls or under compression and with recovery allowed,
    ``recoveryCoeff`` times.
    """

    brittle_damage_initial_threshold: Annotated[
        float, Parameter("tau_0 at which damage starts", unit="Pa^(1/2)", ge=0.0)
    ] = 57.0
    brittle_damage_fracture_energy: Annotated[
        float, Parameter("fracture energy G_f", unit="J/m^2", gt=0.0)
    ] = 11.2
    brittle_damage_constant_D: Annotated[float, Parameter("shape D of the softening curve", gt=0.0)] = 0.1
    brittle_damage_max_damage_increment: Annotated[
        float, Parameter("largest increment of damage in a step", gt=0.0)
    ] = 0.1
    brittle_damage_allowRecovery: Annotated[bool, Parameter("whether unloading recovers strength")] = False
    brittle_damage_recoveryCoeff: Annotated[
        float, Parameter("part of the stress that recovers", ge=0.0, le=1.0)
    ] = 1.0
    brittle_damage_printDamage: Annotated[
        bool, Parameter("whether damage is printed", ignored="save p.damage instead")
    ] = False
    youngs_modulus: float = math.nan
    """Of the material, Pa; from the moduli of the constitutive model."""

    @property
    def State(self) -> type:  # noqa: N802 - the class attribute of other models
        """The arrays of a particle set."""
        return BrittleState


@for_constitutive_model.register
def _(model: BrittleDamage, constitutive_model: Any) -> BrittleDamage:
    K, G = (getattr(constitutive_model, name, None) for name in ("bulk_modulus", "shear_modulus"))
    if K is None or G is None:
        raise ValueError("damage model Brittle needs a material with <bulk_modulus> and <shear_modulus>")
    if getattr(constitutive_model, "adds_to_stress", False):
        # the scaled stress is where the next step starts from, so that each step would scale it once more
        raise ValueError(
            "damage model Brittle scales the stress, which this material adds to in every step: "
            "use it with a material whose stress follows from its deformation, such as comp_neo_hook"
        )
    return model._replace(youngs_modulus=9.0 * K * G / (3.0 * K + G))


@initialize_damage.register
def _(model: BrittleDamage, state: BrittleState, particles: Particles, patch: NDArray[np.int64]) -> None:
    state.threshold[:] = model.brittle_damage_initial_threshold


@implements(update_damage, BrittleDamage)
@lanewise
def _(
    model: BrittleDamage, state: BrittleState, p: int, point: DamagePoint, material: Material, step: Step
) -> DamageUpdate:
    before, threshold = state.damage[p], state.threshold[p]
    damage = abs(before)
    tau = math.sqrt(model.youngs_modulus) * abs(largest_strain(point.deformation_gradient))
    grows = (trace(point.stress) >= 0.0) & (tau > threshold)
    recovers = negation(grows) & (damage > 0.0) & model.brittle_damage_allowRecovery
    if anywhere(grows):
        D, start = model.brittle_damage_constant_D, model.brittle_damage_initial_threshold
        size = point.volume ** (1.0 / 3.0)
        energy = model.brittle_damage_fracture_energy * D
        C = start * size * (1.0 + D) / energy * math.log(1.0 + D)
        grown = MOST_DAMAGE / D * ((1.0 + D) / (1.0 + D * math.exp(-C * (tau - start))) - 1.0)
        damage = where(grows, min(grown, damage + model.brittle_damage_max_damage_increment), damage)
        before = where(grows, damage, before)
        state.threshold[p] = where(grows, tau, threshold)
    state.damage[p] = where(recovers, -damage, before)
    remains = where(recovers, model.brittle_damage_recoveryCoeff, 1.0 - damage)
    return DamageUpdate(point.stress * remains, point.localized)
