"""Compressible Mooney-Rivlin rubber."""

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
from solver.tensor import determinant, isotropic, trace


@model("constitutive_model", "comp_mooney_rivlin")
class CompMooneyRivlin(NamedTuple):
    """Compressible Mooney-Rivlin rubber.

    With the invariants I1, I2, I3 of b = F F^T the strain energy of unit initial volume is
    W = C1 (I1 - 3) + C2 (I2 - 3) + C3 (I3^-2 - 1) + C4 (I3 - 1)^2, hence
    sigma = 2/J ((C1 + I1 C2) b - C2 b^2 + I3 dW/dI3 I). C3 = C1/2 + C2 leaves the undeformed state without
    stress and C4 gives it the Poisson ratio.
    """

    he_constant_1: Annotated[
        float, Parameter("Mooney constant C1; 2 (C1 + C2) is the shear modulus", unit="Pa")
    ]
    he_constant_2: Annotated[float, Parameter("Mooney constant C2", unit="Pa")]
    he_PR: Annotated[float, Parameter("Poisson ratio of small strains", gt=-1.0, lt=0.5)]

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        if self.he_constant_1 + self.he_constant_2 > 0.0:
            return []
        return [("he_constant_1", "he_constant_1 + he_constant_2, half the shear modulus, must be positive")]


@inline
def compression_constants(model: CompMooneyRivlin) -> tuple[float, float]:
    """C3 and C4."""
    C1, C2, nu = model.he_constant_1, model.he_constant_2, model.he_PR
    C4 = 0.5 * (C1 * (5.0 * nu - 2.0) + C2 * (11.0 * nu - 5.0)) / (1.0 - 2.0 * nu)
    return 0.5 * C1 + C2, C4


@initial_sound_speed.register
def _(model: CompMooneyRivlin, density: Any, temperature: Any) -> Any:
    shear_modulus = 2.0 * (model.he_constant_1 + model.he_constant_2)
    return np.sqrt(2.0 * shear_modulus * (1.0 - model.he_PR) / ((1.0 - 2.0 * model.he_PR) * density))


@implements(stress_update, CompMooneyRivlin)
@lanewise
def mooney_rivlin_stress(
    model: CompMooneyRivlin, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Stress by the derivative of the energy.

    The sound speed is an upper estimate from the second derivatives; the one that enters the artificial
    viscosity leaves out the volumetric part.
    """
    C1, C2 = model.he_constant_1, model.he_constant_2
    C3, C4 = compression_constants(model)
    F = point.deformation_gradient
    b = F @ F.T
    b2 = b @ b
    J = determinant(F)
    I1 = trace(b)
    I2 = 0.5 * (I1 * I1 - trace(b2))
    I3 = J * J
    slope = -2.0 * C3 / (I3 * I3 * I3) + 2.0 * C4 * (I3 - 1.0)
    stress = (b * (C1 + I1 * C2) - b2 * C2 + isotropic(I3 * slope)) * (2.0 / J)

    density = point.mass / point.volume
    distortional = 4.0 * (C1 + C2 * I2) / J
    volumetric = 8.0 * (2.0 * C3 / (I3 * I3 * I3) + C4 * (2.0 * I3 - 1.0))
    least_stress = min(stress.xx, stress.yy)
    least_stress = min(least_stress, stress.zz)
    energy = C1 * (I1 - 3.0) + C2 * (I2 - 3.0) + C3 * (1.0 / (I3 * I3) - 1.0)
    energy += C4 * (I3 - 1.0) * (I3 - 1.0)
    return StressUpdate(
        stress=stress,
        sound_speed=math.sqrt((distortional + volumetric - least_stress / J) / density),
        strain_energy=energy * point.volume / J,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(
            step, trace(point.velocity_gradient), math.sqrt(distortional / density), density
        ),
        localized=point.localized,
    )
