"""High explosive lit at times that the speed of the detonation prescribes."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, Vector, model
from solver.dispatch import implements, lanewise
from solver.lanes import anywhere, where
from solver.materials.constitutive import (
    DELETE,
    Material,
    Point,
    Step,
    StressUpdate,
    artificial_viscosity,
    initial_sound_speed,
    initialize,
    stress_update,
)
from solver.particles import Array, Particles, StateVariable
from solver.tensor import determinant, isotropic, trace

BURN_WIDTH = 1.5
"""Particle sizes that the detonation crosses while a particle burns."""

COMPLETE = 0.96
"""Burned fraction that counts as all."""


class ProgramBurnState(NamedTuple):
    """Burned fraction and time of arrival of the detonation, (n,)."""

    burned: Annotated[Array, StateVariable("p.progressF")]
    arrival: Annotated[Array, StateVariable("p.lightingTime")]


@model("constitutive_model", "program_burn")
class ProgramBurn(NamedTuple):
    """Programmed burn: p = (1 - f) p_u + f p_b with the equations of state of jwlpp_mpm.

    The detonation runs from a point, or from a plane, with the speed D from the time T0 on; f rises linearly
    while it crosses 1.5 particle sizes. The time of its arrival is that at the particle's first position
    (Uintah takes the present one, which differs only where a particle moves before it burns). The material
    bears no shear; its energy is not counted, as in Uintah.
    """

    K: Annotated[float, Parameter("compressibility of the explosive, 1/bulk modulus", unit="1/Pa", gt=0.0)]
    n: Annotated[float, Parameter("pressure derivative of its bulk modulus", gt=0.0)]
    A: Annotated[float, Parameter("JWL constant A of the products", unit="Pa")]
    B: Annotated[float, Parameter("JWL constant B", unit="Pa")]
    C: Annotated[float, Parameter("JWL constant C", unit="Pa")]
    R1: Annotated[float, Parameter("JWL constant R1")]
    R2: Annotated[float, Parameter("JWL constant R2")]
    om: Annotated[float, Parameter("JWL constant omega, the Grueneisen parameter of the products")]
    rho0: Annotated[float, Parameter("density of the explosive", unit="kg/m^3", gt=0.0)]
    starting_location: Annotated[
        Vector, Parameter("where the detonation begins, a point of the plane", unit="m")
    ]
    D: Annotated[float, Parameter("speed of the detonation", unit="m/s", gt=0.0)]
    direction_if_plane: Annotated[
        Vector, Parameter("normal of the plane where it begins; zero for a point")
    ] = (0.0, 0.0, 0.0)
    T0: Annotated[float, Parameter("time at which the detonation begins", unit="s")] = 0.0

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return ProgramBurnState


@initial_sound_speed.register
def _(model: ProgramBurn, density: Any, temperature: Any) -> Any:
    return np.sqrt((density / model.rho0) ** (model.n - 1.0) / (model.K * model.rho0))


@initialize.register
def _(model: ProgramBurn, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    """Distances from the point or the plane, as times."""
    path = particles.position - np.array(model.starting_location)
    normal = np.array(model.direction_if_plane)
    size = np.linalg.norm(normal)
    distance = np.abs(path @ normal) / size if size > 0.0 else np.linalg.norm(path, axis=1)
    state.arrival[...] = model.T0 + distance / model.D


@implements(stress_update, ProgramBurn)
@lanewise
def program_burn_stress(
    model: ProgramBurn, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Pressure of the mixture; sound speed of the explosive, or of the products once it burns."""
    J = determinant(point.deformation_gradient)
    possible = J > 0.0
    localized = where(possible, point.localized, DELETE)
    J = where(possible, J, 1.0)
    duration = BURN_WIDTH * (point.mass / model.rho0) ** (1.0 / 3.0) / model.D
    f = max(step.time - state.arrival[p], 0.0) / duration
    f = where(f > COMPLETE, 1.0, f)
    state.burned[p] = f
    density = model.rho0 / J
    pressure = (J**-model.n - 1.0) / (model.n * model.K)
    slope = (density / model.rho0) ** (model.n - 1.0) / (model.K * model.rho0)
    burns = f > 0.0
    if anywhere(burns):
        first = model.A * math.exp(-model.R1 * J)
        second = model.B * math.exp(-model.R2 * J)
        third = model.C * J ** -(1.0 + model.om)
        pressure = where(burns, pressure * (1.0 - f) + (first + second + third) * f, pressure)
        products = (model.R1 * first + model.R2 * second) * model.rho0 / (density * density)
        slope = where(burns, products + (1.0 + model.om) * third / density, slope)
    return StressUpdate(
        stress=isotropic(-pressure),
        sound_speed=math.sqrt(slope),
        strain_energy=0.0,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(
            step, trace(point.velocity_gradient), math.sqrt(1.0 / (model.K * density)), density
        ),
        localized=localized,
    )
