"""Elastic part of the deviatoric stress of an elastic-plastic material."""

from __future__ import annotations

from typing import Any

from solver.declare import family
from solver.dispatch import generic
from solver.tensor import Tensor

DEVIATORIC_STRESS = family(
    "deviatoric_stress",
    tag="deviatoric_stress_model",
    package="solver.materials.deviatoric_stress",
    key="@type",
    meaning="elastic or viscoelastic answer of the deviatoric stress",
)


@generic
def stress_increment(
    model: Any, elements: Any, p: int, rate: Tensor, shear_modulus: float, dt: float
) -> Tensor:
    """Increment of the deviatoric stress of particle ``p`` if the step were elastic.

    ``rate`` is the deviator of the rate of deformation and ``elements`` are the stresses (n, 3, 3) of the
    Maxwell elements, if there are any, all in the frame of the material.
    """
    raise NotImplementedError


@generic
def relax(model: Any, elements: Any, p: int, melted: bool, elastic_rate: Tensor, dt: float) -> float:
    """Bring the Maxwell elements of particle ``p`` to the end of the step, unless it melted.

    ``elastic_rate`` is the deviatoric rate of deformation less its plastic part, in the frame of the
    material. Returns the power that the elements dissipate, W/m^3.
    """
    raise NotImplementedError
