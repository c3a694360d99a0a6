"""The material of Saint Venant and Kirchhoff."""

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
from solver.tensor import determinant, double_dot, green_strain, isotropic, principal_values, trace


@model("constitutive_model", "SVK")
class SaintVenantKirchhoff(NamedTuple):
    """Hooke's law between Green's strain E and the second Piola-Kirchhoff stress.

    S = lambda tr(E) I + 2 mu E, sigma = F S F^T / J, with the energy lambda/2 tr(E)^2 + mu E : E of a unit of
    initial volume. The material weakens under strong compression (below a stretch of 1/sqrt(3) in one
    direction). Uintah's tag, which its program no longer accepts; it left the stress in the turned frame,
    counted no energy and bounded the time step by the wave of a thin rod.
    """

    YoungsModulus: Annotated[float, Parameter("Young's modulus", unit="Pa", gt=0.0)]
    PR: Annotated[float, Parameter("Poisson's ratio", gt=-1.0, lt=0.5)]


def _moduli(model: SaintVenantKirchhoff) -> tuple[float, float]:
    """Lame's constants."""
    mu = model.YoungsModulus / (2.0 * (1.0 + model.PR))
    return 2.0 * mu * model.PR / (1.0 - 2.0 * model.PR), mu


@initial_sound_speed.register
def _(model: SaintVenantKirchhoff, density: Any, temperature: Any) -> Any:
    lame, mu = _moduli(model)
    return np.sqrt((lame + 2.0 * mu) / density)


@implements(stress_update, SaintVenantKirchhoff)
@lanewise
def svk_stress(
    model: SaintVenantKirchhoff, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The equations above. The wave speed is that along the largest stretch t, t^2 M (3 t^2 - 1) / 2."""
    F = point.deformation_gradient
    J = determinant(F)
    mu = model.YoungsModulus / (2.0 * (1.0 + model.PR))
    lame = 2.0 * mu * model.PR / (1.0 - 2.0 * model.PR)
    E = green_strain(F)
    S = isotropic(lame * trace(E)) + 2.0 * mu * E
    stretch = principal_values(F @ F.T).first
    stiffening = stretch * max(1.0, 0.5 * (3.0 * stretch - 1.0))
    energy = 0.5 * lame * trace(E) ** 2 + mu * double_dot(E, E)
    density = material.density / J
    bulk_speed = math.sqrt((lame + 2.0 * mu / 3.0) / density)
    return StressUpdate(
        stress=F @ S @ F.T / J,
        sound_speed=math.sqrt((lame + 2.0 * mu) * stiffening / material.density),
        strain_energy=energy * point.volume / J,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(step, trace(point.velocity_gradient), bulk_speed, density),
        localized=point.localized,
    )
