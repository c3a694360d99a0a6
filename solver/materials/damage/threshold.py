"""Failure of particles whose stress or strain exceeds their own strength."""

from __future__ import annotations

import sys
from typing import Annotated, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from solver.declare import Parameter, SubModel, model
from solver.dispatch import implements, lanewise
from solver.lanes import anywhere, where
from solver.materials.constitutive import Material, Step
from solver.materials.damage import DamagePoint, DamageUpdate, initialize_damage, update_damage
from solver.materials.failure_criterion import Strength, failure
from solver.particles import Array, Particles, StateVariable
from solver.random import by_patch, gaussian, size_effect, uniform, weibull

NO_SIZE_EFFECT = sys.float_info.max
"""The exponent of a strength that does not depend on the particle's volume."""

Criterion: TypeAlias = Annotated[Any, SubModel("failure_criterion")]
Distribution: TypeAlias = Annotated[
    str,
    Parameter(
        "how the strength varies between particles", choices=("constant", "gauss", "weibull", "uniform")
    ),
]
FrictionAngle: TypeAlias = Annotated[
    float, Parameter("friction angle, for MohrCoulomb", unit="degree", ge=0.0, lt=90.0)
]
TensileCutoff: TypeAlias = Annotated[
    float,
    Parameter(
        "largest tension in cohesions, for MohrCoulomb", tag="tensile_cutoff_fraction_of_cohesion", ge=0.0
    ),
]
Seed: TypeAlias = Annotated[int, Parameter("seed of the distribution")]
Scaling: TypeAlias = Annotated[
    str, Parameter("whether strength falls with a particle's volume", choices=("none", "kayenta"))
]
ReferenceVolume: TypeAlias = Annotated[
    float, Parameter("volume of the specimens that gave the strength", unit="m^3", gt=0.0)
]
Exponent: TypeAlias = Annotated[
    float, Parameter("n of the size effect (reference volume / volume)^(1 / n)", gt=0.0)
]
Localize: TypeAlias = Annotated[bool, Parameter("whether particles fail at all")]


class ThresholdState(NamedTuple):
    """The strength of each particle, (n,)."""

    strength: Annotated[Array, StateVariable("p.epsf")]


@model("damage", "Threshold")
class Threshold(NamedTuple):
    """A particle fails when its stress or strain reaches its strength; erosion sees to the consequence.

    Strengths are drawn once, a patch after the other from its own seed: normal with ``failure_std`` its
    deviation, of Weibull with ``failure_std`` the modulus, or uniform within ``failure_std`` of the mean.
    """

    failure_criteria: Criterion
    failure_mean: Annotated[float, Parameter("mean strength: strain, or stress in Pa", gt=0.0)]
    failure_distrib: Distribution = "constant"
    failure_std: Annotated[
        float, Parameter("deviation, Weibull modulus or half range of the distribution", ge=0.0)
    ] = 0.0
    failure_seed: Seed = 0
    friction_angle: FrictionAngle = 0.0
    tensile_cutoff: TensileCutoff = 0.0
    scaling: Scaling = "none"
    reference_volume: ReferenceVolume = 1.0
    exponent: Exponent = NO_SIZE_EFFECT
    LocalizeParticles: Localize = True

    @property
    def State(self) -> type:  # noqa: N802 - the class attribute of other models
        """The arrays of a particle set."""
        return ThresholdState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        if self.failure_distrib != "constant" and self.failure_std == 0.0:
            return [("failure_std", f"a {self.failure_distrib} distribution needs failure_std")]
        return []


class Entry(NamedTuple):
    """Strength at one colour."""

    color: Annotated[float, Parameter("colour of the particles with this strength")]
    mean: Annotated[float, Parameter("mean strength: strain, or stress in Pa", gt=0.0)]
    std: Annotated[float, Parameter("deviation, Weibull modulus or half range", ge=0.0)]


class VariableProperties(NamedTuple):
    """Strengths at two or more colours, in rising order."""

    entry: Annotated[tuple[Entry, ...], Parameter("strength at one colour")]


@model("damage", "ThresholdVar")
class ThresholdVar(NamedTuple):
    """``Threshold`` with mean and deviation interpolated linearly over the particle's colour.

    Particles draw one after the other; Uintah starts its generator anew for each of them.
    """

    failure_criteria: Criterion
    variable_properties: Annotated[VariableProperties, Parameter("strength over colour")]
    failure_distrib: Distribution = "constant"
    failure_seed: Seed = 0
    friction_angle: FrictionAngle = 0.0
    tensile_cutoff: TensileCutoff = 0.0
    scaling: Scaling = "none"
    reference_volume: ReferenceVolume = 1.0
    exponent: Exponent = NO_SIZE_EFFECT
    LocalizeParticles: Localize = True

    @property
    def State(self) -> type:  # noqa: N802 - the class attribute of other models
        """The arrays of a particle set."""
        return ThresholdState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        colors = [entry.color for entry in self.variable_properties.entry]
        if len(colors) < 2 or sorted(set(colors)) != colors:
            return [("variable_properties", "give two or more <entry>, each with a larger <color>")]
        return []


def draw_strengths(
    model: Threshold | ThresholdVar, mean: Any, deviation: Any, volume: NDArray[Any], patch: NDArray[Any]
) -> NDArray[Any]:
    """Strengths (n,) of a distribution; ``mean`` and ``deviation`` are numbers or (n,)."""
    reference, exponent = 1.0, NO_SIZE_EFFECT
    if model.scaling != "none":
        reference, exponent = model.reference_volume, model.exponent
    size = (volume, reference, exponent)
    if model.failure_distrib == "gauss":
        return np.abs(gaussian(by_patch(patch, model.failure_seed, 2), mean, deviation, *size))
    if model.failure_distrib == "weibull":
        if model.scaling != "none" and exponent == NO_SIZE_EFFECT:
            size = (volume, reference, deviation)
        return weibull(by_patch(patch, model.failure_seed)[:, 0], mean, deviation, *size)
    if model.failure_distrib == "uniform":
        return uniform(by_patch(patch, model.failure_seed)[:, 0], mean, deviation) * size_effect(*size)
    return np.broadcast_to(np.asarray(mean, float), volume.shape)


@initialize_damage.register
def _(model: Threshold, state: ThresholdState, particles: Particles, patch: NDArray[Any]) -> None:
    state.strength[:] = draw_strengths(model, model.failure_mean, model.failure_std, particles.volume, patch)


@initialize_damage.register
def _(model: ThresholdVar, state: ThresholdState, particles: Particles, patch: NDArray[Any]) -> None:
    colors, means, deviations = zip(*model.variable_properties.entry, strict=True)
    mean = np.interp(particles.color, colors, means)
    deviation = np.interp(particles.color, colors, deviations)
    state.strength[:] = draw_strengths(model, mean, deviation, particles.volume, patch)


@implements(update_damage, Threshold, ThresholdVar)
@lanewise
def _(
    model: Any, state: ThresholdState, p: int, point: DamagePoint, material: Material, step: Step
) -> DamageUpdate:
    localized = point.localized
    sound = localized == 0
    if model.LocalizeParticles and anywhere(sound):
        strength = Strength(state.strength[p], model.friction_angle, model.tensile_cutoff)
        found = failure(model.failure_criteria, point.stress, point.deformation_gradient, strength)
        localized = where(sound, found, localized)
    return DamageUpdate(point.stress, localized)
