"""Slightly compressible viscous liquid."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import where
from solver.materials.constitutive import (
    DELETE,
    Material,
    Point,
    Step,
    StressUpdate,
    artificial_viscosity,
    initial_sound_speed,
    stress_update,
)
from solver.tensor import determinant, deviator, isotropic, symmetric, trace

LARGEST_EXPANSION = 1.0e5
"""Volume ratio at which a particle of liquid is taken out."""


@model("constitutive_model", "water")
class Water(NamedTuple):
    """Barotropic Newtonian liquid: p = K (J^-gamma - 1), sigma = -p I + 2 mu dev d.

    A Tait-like equation of state (Monaghan, J. Comput. Phys. 110, 1994) with the rate of deformation d.
    Particles that turn inside out or expand beyond a factor of 10^5 are removed.
    """

    bulk_modulus: Annotated[
        float, Parameter("K; the bulk modulus at rest is gamma times it", unit="Pa", gt=0.0)
    ]
    viscosity: Annotated[float, Parameter("dynamic shear viscosity", unit="Pa s", ge=0.0)]
    gamma: Annotated[float, Parameter("exponent of density in the pressure", gt=0.0)]


@initial_sound_speed.register
def _(model: Water, density: Any, temperature: Any) -> Any:
    return np.sqrt(model.bulk_modulus / density)


@inline
def barotropic_update(
    K: float, mu: float, gamma: float, J: float, density: float, localized: int, point: Point, step: Step
) -> StressUpdate:
    """Pressure from the volume ratio J, shear from the rate of deformation."""
    power = J**-gamma
    shear = 2.0 * mu * deviator(symmetric(point.velocity_gradient))
    return StressUpdate(
        stress=isotropic(-K * (power - 1.0)) + shear,
        sound_speed=math.sqrt(gamma * power * K / density),
        strain_energy=0.0,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(
            step, trace(point.velocity_gradient), math.sqrt(K / density), density
        ),
        localized=localized,
    )


@implements(stress_update, Water)
@lanewise
def water_stress(
    model: Water, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The equation above, where the particle is sound."""
    J = determinant(point.deformation_gradient)
    possible = (J > 0.0) & (J <= LARGEST_EXPANSION)
    localized = where(possible, point.localized, DELETE)
    J = where(possible, J, 1.0)
    return barotropic_update(
        model.bulk_modulus, model.viscosity, model.gamma, J, material.density / J, localized, point, step
    )
