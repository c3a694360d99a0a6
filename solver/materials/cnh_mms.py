"""Compressible neo-Hookean material of the method of manufactured solutions."""

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
from solver.tensor import determinant, isotropic, trace


@model("constitutive_model", "cnh_mms")
class CnhMms(NamedTuple):
    """Neo-Hookean material sigma = (lambda ln J I + G (b - I)) / J with lambda = K - 2 G / 3.

    The form for which manufactured solutions are derived (Kamojjala, Brannon, Sadeghirad and Guilkey, Eng.
    Comput. 31, 2015). Its energy is not counted, as in Uintah.
    """

    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
    useModifiedEOS: Annotated[
        bool,
        Parameter(
            "a power law instead of the bulk modulus in expansion, beside a gas",
            ignored="only the coupled gas-solid method asks the material for its equation of state",
        ),
    ] = False


@initial_sound_speed.register
def _(model: CnhMms, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.bulk_modulus + 4.0 * model.shear_modulus / 3.0) / density)


@implements(stress_update, CnhMms)
@lanewise
def cnh_mms_stress(
    model: CnhMms, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The equation above."""
    K, G = model.bulk_modulus, model.shear_modulus
    F = point.deformation_gradient
    J = determinant(F)
    density = material.density / J
    shear = (F @ F.T - isotropic(1.0)) * G
    return StressUpdate(
        stress=(isotropic((K - 2.0 * G / 3.0) * math.log(J)) + shear) / J,
        sound_speed=math.sqrt((K + 4.0 * G / 3.0) / density),
        strain_energy=0.0,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(
            step, trace(point.velocity_gradient), math.sqrt(K / density), density
        ),
        localized=point.localized,
    )
