"""Rubber of Arruda and Boyce: eight chains of limited length in a cube."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.lanes import like
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    artificial_viscosity,
    initial_sound_speed,
    stress_update,
)
from solver.tensor import determinant, deviator, isotropic, trace

SERIES = (1.0, 2.0 / 10.0, 33.0 / 525.0, 76.0 / 3500.0, 2595.0 / 336875.0)
"""Coefficients of powers of u in 2 dW/d(tr b') / G, from the series of the inverse Langevin function."""


@model("constitutive_model", "ArrudaBoyce8")
class ArrudaBoyce8(NamedTuple):
    """Eight-chain rubber of Arruda and Boyce (J. Mech. Phys. Solids 41, 1993), the series cut at u^4.

    sigma = G (1 + u/5 + 33 u^2/525 + 76 u^3/3500 + 2595 u^4/336875) dev b' / J + K/2 (J - 1/J) I with
    b' = J^(-2/3) F F^T and u = tr b' / beta^2; the chains lock as u approaches 3. The strain energy is
    G beta^2/2 times the integral of the series from 3/beta^2 to u, plus that of the volume change as in
    comp_neo_hook; Uintah counts none.
    """

    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    shear_modulus: Annotated[float, Parameter("shear modulus of long chains", unit="Pa", gt=0.0)]
    beta: Annotated[float, Parameter("stretch at which the chains lock", gt=1.0)]
    useModifiedEOS: Annotated[
        bool,
        Parameter(
            "a power law instead of the bulk modulus in expansion, beside a gas",
            ignored="only the coupled gas-solid method asks the material for its equation of state",
        ),
    ] = False


@initial_sound_speed.register
def _(model: ArrudaBoyce8, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.bulk_modulus + 4.0 * model.shear_modulus / 3.0) / density)


@implements(stress_update, ArrudaBoyce8)
@lanewise
def arruda_boyce_stress(
    model: ArrudaBoyce8, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The equation above, the series summed in powers of u."""
    K, G, beta2 = model.bulk_modulus, model.shear_modulus, model.beta * model.beta
    F = point.deformation_gradient
    J = determinant(F)
    b = (F @ F.T) * J ** (-2.0 / 3.0)
    u, u_rest = trace(b) / beta2, 3.0 / beta2
    stiffening, energy = like(0.0, u), like(0.0, u)
    power, power_at_rest = like(1.0, u), 1.0
    for k in range(len(SERIES)):
        stiffening += SERIES[k] * power
        power, power_at_rest = power * u, power_at_rest * u_rest
        energy += SERIES[k] * (power - power_at_rest) / (k + 1)
    energy = 0.5 * G * beta2 * energy + 0.5 * K * (0.5 * (J * J - 1.0) - math.log(J))
    density = material.density / J
    return StressUpdate(
        stress=deviator(b) * (G * stiffening / J) + isotropic(0.5 * K * (J - 1.0 / J)),
        sound_speed=math.sqrt((K + 4.0 * G / 3.0) / density),
        strain_energy=energy * point.volume / J,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(
            step, trace(point.velocity_gradient), math.sqrt(K / density), density
        ),
        localized=point.localized,
    )
