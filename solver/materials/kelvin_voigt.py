"""Kelvin-Voigt solid: a spring beside a dashpot."""

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
    rotation,
    symmetric,
    tensor_at,
    trace,
)


class KelvinVoigtState(NamedTuple):
    """Stress of the spring, (n, 3, 3), in the frame that turns with R of F = R U."""

    elastic_stress: Annotated[Array, StateVariable("p.elasticStress", "Matrix3")]


@model("constitutive_model", "Kelvin_Voigt")
class KelvinVoigt(NamedTuple):
    """A spring and a dashpot that share the rate of deformation d.

    sigma = sigma_e + 2 eta_G dev d + eta_K tr d I, where the spring obeys sigma_e' = 2 G dev d + K tr d I in
    the frame that turns with R of F = R U. The energy is the work of the step. Uintah adds the dashpot's
    stress of every step to the spring's, takes a third of the bulk terms and leaves the old stress where it
    was when the body turns; here the equations are solved as they stand.
    """

    elastic_shear: Annotated[float, Parameter("shear modulus G of the spring", unit="Pa", gt=0.0)]
    elastic_bulk: Annotated[float, Parameter("bulk modulus K of the spring", unit="Pa", gt=0.0)]
    viscous_shear: Annotated[float, Parameter("shear viscosity eta_G", unit="Pa s", ge=0.0)]
    viscous_bulk: Annotated[float, Parameter("bulk viscosity eta_K; none if negative", unit="Pa s")] = -1.0

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return KelvinVoigtState


@initial_sound_speed.register
def _(model: KelvinVoigt, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.elastic_bulk + 4.0 * model.elastic_shear / 3.0) / density)


@implements(stress_update, KelvinVoigt)
@lanewise
def kelvin_voigt_stress(
    model: KelvinVoigt, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Advance the spring in the turned frame and add the dashpot."""
    K, G = model.elastic_bulk, model.elastic_shear
    R = rotation(point.deformation_gradient)
    d = symmetric(point.velocity_gradient)
    turned = R.T @ d @ R
    spring = tensor_at(state.elastic_stress, p)
    spring = spring + step.dt * (2.0 * G * deviator(turned) + isotropic(K * trace(turned)))
    put_tensor(state.elastic_stress, p, spring)
    dashpot = 2.0 * model.viscous_shear * deviator(d) + isotropic(max(model.viscous_bulk, 0.0) * trace(d))
    stress = R @ spring @ R.T + dashpot
    density = material.density / determinant(point.deformation_gradient)
    return StressUpdate(
        stress=stress,
        sound_speed=math.sqrt((K + 4.0 * G / 3.0) / density),
        strain_energy=double_dot(d, 0.5 * (stress + point.stress)) * point.volume * step.dt,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(step, trace(d), math.sqrt(K / density), density),
        localized=point.localized,
    )
