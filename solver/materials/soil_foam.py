"""Soil or foam that is crushed along a table of pressure over volume strain."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple, TypeAlias

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, like, where
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    artificial_viscosity,
    initial_sound_speed,
    stress_update,
)
from solver.particles import Array, StateVariable
from solver.tensor import determinant, deviator, double_dot, isotropic, symmetric, trace

Strain: TypeAlias = Annotated[
    float, Parameter("logarithmic volume strain of a point of the table, negative in compression")
]
Pressure: TypeAlias = Annotated[float, Parameter("pressure of a point of the table", unit="Pa")]


class SoilFoamState(NamedTuple):
    """What a particle remembers, each (n,)."""

    least_strain: Annotated[Array, StateVariable("p.sv_minLabel")]
    """The smallest (most compressed) volume strain so far."""
    pressure_there: Annotated[Array, StateVariable("p.p_sv_minLabel")]


@model("constitutive_model", "soil_foam")
class SoilFoam(NamedTuple):
    """Crushable soil and foam after Krieg (Sandia SC-DR-72-0883, 1972), material 5 of LS-DYNA.

    Under new compression the pressure follows the table, else it unloads with the bulk modulus from the most
    compressed state; it is never less than pc. Shear is elastic up to J2 = a0 + a1 p + a2 p^2, and scaled
    back beyond. The rate is not objective: large rotations need another model. The sound speed takes the
    density of the start of the step.
    """

    elastic_shear: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
    bulk: Annotated[float, Parameter("bulk modulus of unloading", unit="Pa", gt=0.0)]
    a0: Annotated[float, Parameter("constant term of the yield surface", unit="Pa^2")]
    a1: Annotated[float, Parameter("linear term of the yield surface", unit="Pa")]
    a2: Annotated[float, Parameter("quadratic term of the yield surface")]
    pc: Annotated[float, Parameter("least pressure, negative for strength in tension", unit="Pa", le=0.0)]
    eps0: Strain
    eps1: Strain
    eps2: Strain
    eps3: Strain
    eps4: Strain
    eps5: Strain
    eps6: Strain
    eps7: Strain
    eps8: Strain
    eps9: Strain
    p0: Pressure
    p1: Pressure
    p2: Pressure
    p3: Pressure
    p4: Pressure
    p5: Pressure
    p6: Pressure
    p7: Pressure
    p8: Pressure
    p9: Pressure

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return SoilFoamState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        if self.eps1 >= self.eps0:
            return [("eps1", "the table must begin with a compression: eps1 less than eps0")]
        return []


@initial_sound_speed.register
def _(model: SoilFoam, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.bulk + 4.0 * model.elastic_shear / 3.0) / density)


class TablePoint(NamedTuple):
    """Pressure on the table and its slope over volume strain."""

    pressure: float
    slope: float


@inline
def crush_curve(model: SoilFoam, strain: float) -> TablePoint:
    """Linear interpolation in the falling part of the table, continued beyond its ends."""
    strains = (
        model.eps0,
        model.eps1,
        model.eps2,
        model.eps3,
        model.eps4,
        model.eps5,
        model.eps6,
        model.eps7,
        model.eps8,
        model.eps9,
    )
    pressures = (
        model.p0,
        model.p1,
        model.p2,
        model.p3,
        model.p4,
        model.p5,
        model.p6,
        model.p7,
        model.p8,
        model.p9,
    )
    slope = like((pressures[1] - pressures[0]) / (strains[1] - strains[0]), strain)
    pressure = pressures[0] + slope * (strain - strains[0])
    for i in range(1, 9):
        if strains[i + 1] < strains[i]:
            beyond = strain < strains[i]
            steepness = (pressures[i + 1] - pressures[i]) / (strains[i + 1] - strains[i])
            slope = where(beyond, steepness, slope)
            pressure = where(beyond, pressures[i] + steepness * (strain - strains[i]), pressure)
    return TablePoint(pressure, slope)


@implements(stress_update, SoilFoam)
@lanewise
def soil_foam_stress(
    model: SoilFoam, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Pressure by the table or by unloading, shear by scaling back; the energy is the work of the step."""
    G, K = model.elastic_shear, model.bulk
    d = symmetric(point.velocity_gradient)
    strain = math.log(point.volume * material.density / point.mass)
    least, pressure_there = state.least_strain[p], state.pressure_there[p]
    pressure = pressure_there - K * (strain - least)
    stiffness = like(K, strain)
    crushes = strain <= least
    if anywhere(crushes):
        crushed = crush_curve(model, strain)
        pressure = where(crushes, crushed.pressure, pressure)
        stiffness = where(crushes, -crushed.slope, stiffness)
        state.least_strain[p] = where(crushes, strain, least)
        state.pressure_there[p] = where(crushes, pressure, pressure_there)
    pressure = max(pressure, model.pc)
    s = deviator(point.stress) + (2.0 * G * step.dt) * deviator(d)
    second_invariant = 0.5 * double_dot(s, s)
    limit = max(model.a0 + (model.a1 + model.a2 * pressure) * pressure, 0.0)
    s = s * where(second_invariant >= limit, math.sqrt(limit / (second_invariant + 1.0e-10)), 1.0)
    stress = s - isotropic(pressure)
    density = material.density / determinant(point.deformation_gradient_old)
    return StressUpdate(
        stress=stress,
        sound_speed=math.sqrt((stiffness + 4.0 * G / 3.0) / density),
        strain_energy=double_dot(d, 0.5 * (stress + point.stress)) * point.volume * step.dt,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(step, trace(d), math.sqrt(K / density), density),
        localized=point.localized,
    )
