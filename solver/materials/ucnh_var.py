"""Compressible neo-Hookean material whose constants vary from particle to particle with their colour."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple, TypeAlias

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import generic, implements, lanewise
from solver.materials.comp_neo_hook import (
    InitialPressure,
    InitialStress,
    Isochoric,
    Plasticity,
    compress,
    elastic_shear,
    neo_hookean_update,
    radial_return,
)
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    initial_sound_speed,
    initialize,
    stress_update,
)
from solver.particles import Array, Particles, StateVariable

ParticleBulkModulus: TypeAlias = Annotated[Array, StateVariable("p.bulkModulus")]
ParticleShearModulus: TypeAlias = Annotated[Array, StateVariable("p.shearModulus")]


class Entry(NamedTuple):
    """Constants at one colour."""

    color: Annotated[float, Parameter("colour of the particles with these constants")]
    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
    yield_stress: Annotated[float, Parameter("yield stress in tension", unit="Pa", ge=0.0)]
    hardening_modulus: Annotated[float, Parameter("slope of yield stress over plastic strain", unit="Pa")]


class VariableProperties(NamedTuple):
    """Constants at two or more colours, in rising order."""

    entry: Annotated[tuple[Entry, ...], Parameter("constants at one colour")]


class VariableElasticState(NamedTuple):
    """Moduli of each particle, (n,)."""

    bulk_modulus: ParticleBulkModulus
    shear_modulus: ParticleShearModulus


class VariablePlasticState(NamedTuple):
    """Constants of each particle, (n,), and what it remembers."""

    bulk_modulus: ParticleBulkModulus
    shear_modulus: ParticleShearModulus
    yield_stress: Annotated[Array, StateVariable("p.initialYieldStress")]
    hardening_modulus: Annotated[Array, StateVariable("p.hardeningModulus")]
    plastic_strain: Annotated[Array, StateVariable("p.plasticStrain")]
    elastic_stretch: Annotated[Array, StateVariable("p.bElBar", "Matrix3", 1.0)]


@model("constitutive_model", "UCNHVar")
class UCNHVar(NamedTuple):
    """The equations of comp_neo_hook and comp_neo_hook_plastic, without thermal expansion.

    Each constant is interpolated linearly over the particle's colour between the entries and kept constant
    outside them.
    """

    variable_properties: Annotated[VariableProperties, Parameter("constants over colour")]
    usePlasticity: Plasticity = False
    useInitialStress: InitialStress = False
    initial_pressure: InitialPressure = 0.0

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return VariablePlasticState if self.usePlasticity else VariableElasticState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        colors = [entry.color for entry in self.variable_properties.entry]
        if len(colors) < 2:
            return [("variable_properties", "two or more <entry> are needed to interpolate between")]
        if sorted(set(colors)) != colors:
            return [("variable_properties", "the <color> of each <entry> must be larger than that before")]
        return []


def largest_bulk_modulus(model: UCNHVar) -> float:
    """The stiffest entry."""
    return max(entry.bulk_modulus for entry in model.variable_properties.entry)


@initial_sound_speed.register
def _(model: UCNHVar, density: Any, temperature: Any) -> Any:
    """An upper estimate, as in Uintah: the largest bulk modulus stands for the shear modulus as well."""
    return np.sqrt(7.0 / 3.0 * largest_bulk_modulus(model) / density)


@initialize.register
def _(model: UCNHVar, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    """Give each particle its constants."""
    entries = model.variable_properties.entry
    colors = [entry.color for entry in entries]
    for name in ("bulk_modulus", "shear_modulus", "yield_stress", "hardening_modulus"):
        if hasattr(state, name):
            values = [getattr(entry, name) for entry in entries]
            getattr(state, name)[...] = np.interp(particles.color, colors, values)
    if model.useInitialStress:
        compress(particles, model.initial_pressure, largest_bulk_modulus(model))


@generic
def variable_response(  # type: ignore[empty-body]  # bodies follow, one for each kind of state
    state: Any, p: int, point: Point
) -> Isochoric:
    """Deviatoric stress of particle ``p``; the kind of its state tells whether it can yield."""


@implements(variable_response, VariableElasticState)
@lanewise
def variable_elastic_response(state: Any, p: int, point: Point) -> Isochoric:
    """The response of a material that cannot yield."""
    return elastic_shear(state.shear_modulus[p], point.deformation_gradient)


@implements(variable_response, VariablePlasticState)
@lanewise
def variable_plastic_response(state: Any, p: int, point: Point) -> Isochoric:
    """The response of a material that can."""
    return radial_return(
        state, p, point, state.shear_modulus[p], state.yield_stress[p], state.hardening_modulus[p]
    )


@implements(stress_update, UCNHVar)
@lanewise
def variable_neo_hookean_stress(
    model: UCNHVar, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The neo-Hookean update with the particle's own constants."""
    shear = variable_response(state, p, point)
    return neo_hookean_update(
        state.bulk_modulus[p], state.shear_modulus[p], shear, 1.0, point, material, step
    )
