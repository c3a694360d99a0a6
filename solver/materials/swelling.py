"""Swelling by a diffusing substance: the part of a deformation that makes no stress."""

from __future__ import annotations

import math
from typing import Annotated, TypeAlias

from solver.declare import Parameter
from solver.dispatch import inline
from solver.materials.constitutive import Point
from solver.particles import Array, StateVariable
from solver.tensor import isotropic

Expansion: TypeAlias = Annotated[
    float, Parameter("logarithmic strain in every direction by a unit of concentration")
]
Swelling: TypeAlias = Annotated[Array, StateVariable("p.swelling")]
"""Logarithmic strain in every direction by the substance, (n,)."""
ConcentrationRate: TypeAlias = Annotated[Array, StateVariable("", restart=False)]
"""Rate of the concentration, (n,), which ``solver.diffusion`` tells before the stress is asked for; else 0."""


@inline
def without_swelling(point: Point, before: float, after: float, dt: float) -> Point:
    """The particle as it would be had it not swollen, by logarithmic strains at the ends of the step."""
    return Point(
        point.stress,
        point.deformation_gradient_old * math.exp(-before),
        point.deformation_gradient * math.exp(-after),
        point.velocity_gradient - isotropic((after - before) / dt),
        point.volume_old,
        point.volume,
        point.mass,
        point.temperature,
        point.previous_temperature,
        point.localized,
    )
