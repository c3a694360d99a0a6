"""Damage models: a scalar that follows plastic deformation, or failure by a criterion."""

from __future__ import annotations

from functools import singledispatch
from typing import Annotated, Any, NamedTuple

from solver.declare import family
from solver.dispatch import generic, generic_with_default
from solver.materials.constitutive import Material, NoState, Step
from solver.particles import Array, Particles, StateVariable
from solver.tensor import Tensor

DAMAGE = family(
    "damage",
    tag="damage_model",
    package="solver.materials.damage",
    key="@type",
    meaning="how a material is damaged",
)


class DamagePoint(NamedTuple):
    """A particle after its stress update."""

    stress: Tensor
    """Cauchy stress at the end of the step."""
    deformation_gradient: Tensor
    """At the end of the step."""
    plastic_strain_rate: float
    """Of the step; 0 for materials without plasticity."""
    temperature: float
    """At the start of the step."""
    volume: float
    localized: int
    """Not 0 where the particle has failed."""


class ScalarDamage(NamedTuple):
    """The state of models with a scalar damage."""

    damage: Annotated[Array, StateVariable("p.damage")]


class DamageUpdate(NamedTuple):
    """The answer of a damage model for one particle."""

    stress: Tensor
    """Cauchy stress of the damaged particle."""
    localized: int
    """New failure state."""


@generic
def update_damage(
    model: Any, state: Any, p: int, point: DamagePoint, material: Material, step: Step
) -> DamageUpdate:
    """Update the damage of particle ``p``; the model's own ``state`` arrays are updated in place."""
    raise NotImplementedError


@generic_with_default
def damages(model: Any) -> bool:
    """Whether a model changes anything: a constant, for which kernels leave out what needs it."""
    return True


@generic_with_default
def counts_strain(model: Any) -> bool:
    """Whether a model has a :func:`scalar_damage`: a constant, for which kernels of others leave out what needs it."""
    return False


@generic_with_default
def scalar_damage(model: Any, state: Any, p: int) -> float:
    """Plastic strain of particle ``p`` over that at fracture; 0 for models that do not count it."""
    return 0.0


@singledispatch
def for_constitutive_model(model: Any, constitutive_model: Any) -> Any:
    """The damage model with what it takes from the constitutive model of its material.

    Raises ValueError, with the reason, where the two make no sense together.
    """
    return model


@singledispatch
def initialize_damage(model: Any, state: Any, particles: Particles, patch: Any) -> None:
    """Set the initial damage of particles; ``patch`` holds the patch id of each, (n,)."""


def damage_state(model: Any) -> type:
    """The NamedTuple class of a damage model's state arrays (its attribute ``State``)."""
    return getattr(model, "State", NoState)
