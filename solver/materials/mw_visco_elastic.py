"""Viscoelastic solid: a spring beside a Maxwell element."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
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
from solver.tensor import (
    determinant,
    deviator,
    double_dot,
    isotropic,
    put_tensor,
    symmetric,
    tensor_at,
    trace,
)


class StandardSolidState(NamedTuple):
    """Stresses of the spring and of the Maxwell element; pressures are positive in compression."""

    elastic_stress: Annotated[Array, StateVariable("p.stress_e", "Matrix3")]
    elastic_pressure: Annotated[Array, StateVariable("p.stress_e_v")]
    elastic_deviator: Annotated[Array, StateVariable("p.stress_e_d", "Matrix3")]
    viscous_pressure: Annotated[Array, StateVariable("p.stress_ve_v")]
    viscous_deviator: Annotated[Array, StateVariable("p.stress_ve_d", "Matrix3")]


@model("constitutive_model", "mw_visco_elastic")
class MWViscoElastic(NamedTuple):
    """Standard linear solid in rate form: a spring beside a Maxwell element.

    With the rate of deformation d, sigma = sigma_e + s - p I, sigma_e' = 2 G_e dev d + K_e tr d I,
    s' / (2 G_v) + s / eta_d = dev d and p' / (3 K_v) + p / eta_v = -tr d / 3, the Maxwell element by backward
    Euler. The rate is not objective: large rotations need another model. The energy is what the springs
    store, with the pressures of both taken together over K_e + K_v, plus what s dissipates in the step.
    (Uintah adds the dissipation of every particle that it has passed in the patch to each next one.)
    """

    e_shear_modulus: Annotated[float, Parameter("shear modulus of the spring G_e", unit="Pa", gt=0.0)]
    e_bulk_modulus: Annotated[float, Parameter("bulk modulus of the spring K_e", unit="Pa", gt=0.0)]
    ve_shear_modulus: Annotated[float, Parameter("shear modulus of the element G_v", unit="Pa", gt=0.0)]
    ve_bulk_modulus: Annotated[float, Parameter("bulk modulus of the element K_v", unit="Pa", gt=0.0)]
    ve_volumetric_viscosity: Annotated[float, Parameter("volumetric viscosity eta_v", unit="Pa s", ge=0.0)]
    ve_deviatoric_viscosity: Annotated[
        float, Parameter("deviatoric viscosity eta_d, twice the usual", unit="Pa s", gt=0.0)
    ]

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return StandardSolidState


@initial_sound_speed.register
def _(model: MWViscoElastic, density: Any, temperature: Any) -> Any:
    K = model.e_bulk_modulus + model.ve_bulk_modulus
    G = model.e_shear_modulus + model.ve_shear_modulus
    return np.sqrt((K + 4.0 * G / 3.0) / density)


@implements(stress_update, MWViscoElastic)
@lanewise
def standard_solid_stress(
    model: MWViscoElastic, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Advance spring and element; the artificial viscosity takes the density from the start of the step."""
    dt = step.dt
    G_e, K_e = model.e_shear_modulus, model.e_bulk_modulus
    G_v, K_v = model.ve_shear_modulus, model.ve_bulk_modulus
    eta_d = model.ve_deviatoric_viscosity
    d = symmetric(point.velocity_gradient)
    rate, shear_rate = trace(d), deviator(d)

    elastic = tensor_at(state.elastic_stress, p) + dt * (2.0 * G_e * shear_rate + isotropic(K_e * rate))
    elastic_deviator = tensor_at(state.elastic_deviator, p) + (2.0 * G_e * dt) * shear_rate
    elastic_pressure = state.elastic_pressure[p] - K_e * rate * dt
    memory = model.ve_volumetric_viscosity / (3.0 * K_v * dt)
    pressure = (-rate * model.ve_volumetric_viscosity / 3.0 + state.viscous_pressure[p] * memory) / (
        1.0 + memory
    )
    memory = eta_d / (2.0 * G_v * dt)
    s = (eta_d * shear_rate + tensor_at(state.viscous_deviator, p) * memory) / (1.0 + memory)

    put_tensor(state.elastic_stress, p, elastic)
    put_tensor(state.elastic_deviator, p, elastic_deviator)
    put_tensor(state.viscous_deviator, p, s)
    state.elastic_pressure[p] = elastic_pressure
    state.viscous_pressure[p] = pressure
    total_pressure = elastic_pressure + pressure
    stored = (
        double_dot(s, s) / (4.0 * G_v)
        + double_dot(elastic_deviator, elastic_deviator) / (4.0 * G_e)
        + total_pressure * total_pressure / (2.0 * (K_v + K_e))
    )
    dissipated = double_dot(s, s) / eta_d * dt
    density = material.density / determinant(point.deformation_gradient_old)
    K, G = K_e + K_v, G_e + G_v
    return StressUpdate(
        stress=elastic + s - isotropic(pressure),
        sound_speed=math.sqrt((K + 4.0 * G / 3.0) * point.volume / point.mass),
        strain_energy=(stored + dissipated) * point.volume,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(step, rate, math.sqrt(K / density), density),
        localized=point.localized,
    )
