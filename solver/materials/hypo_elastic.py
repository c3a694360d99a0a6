"""Hypoelastic material: the stress rate is linear in the rate of deformation."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    artificial_viscosity,
    initial_sound_speed,
    stress_update,
)
from solver.tensor import determinant, deviator, double_dot, isotropic, symmetric, trace


@model("constitutive_model", "hypo_elastic")
class HypoElastic(NamedTuple):
    """Small-strain elasticity in rate form.

    sigma' = 2 G dev(d) + K tr(d) I with d the rate of deformation less thermal expansion, which also is what
    the artificial viscosity sees. As in Uintah the rate is not objective: large rotations need another model.
    A negative alpha (contraction on heating) works here; Uintah ignores it.
    """

    G: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
    K: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    alpha: Annotated[float, Parameter("coefficient of linear thermal expansion", unit="1/K")] = 0.0
    useModifiedEOS: Annotated[
        bool, Parameter("choice of an equation of state", ignored="this material has but one")
    ] = False


@initial_sound_speed.register
def _(model: HypoElastic, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.K + 4.0 / 3.0 * model.G) / density)


@implements(stress_update, HypoElastic)
@lanewise
@inline
def hypo_elastic_stress(
    model: HypoElastic, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Add the step's increment to the stress; the energy is the work done in the step."""
    expansion = model.alpha * (point.temperature - point.previous_temperature) / step.dt
    d = symmetric(point.velocity_gradient) - isotropic(expansion)
    stress = point.stress + step.dt * (2.0 * model.G * deviator(d) + isotropic(model.K * trace(d)))
    density = material.density / determinant(point.deformation_gradient)
    mean_stress = 0.5 * (stress + point.stress)
    return StressUpdate(
        stress=stress,
        sound_speed=math.sqrt((model.K + 4.0 / 3.0 * model.G) / density),
        strain_energy=double_dot(d, mean_stress) * point.volume * step.dt,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(step, trace(d), math.sqrt(model.K / density), density),
        localized=point.localized,
    )
