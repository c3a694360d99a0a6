"""Shear modulus as a function of temperature, pressure and density."""

from __future__ import annotations

from typing import Any

from solver.declare import family
from solver.dispatch import generic
from solver.materials.plasticity_state import PlasticityState

SHEAR_MODULUS = family(
    "shear_modulus",
    tag="shear_modulus_model",
    package="solver.materials.shear_modulus",
    key="@type",
    meaning="shear modulus as a function of temperature, pressure and density",
)


@generic
def shear_modulus(model: Any, state: PlasticityState) -> float:
    """Shear modulus; ``state.shear_modulus`` holds the material's constant."""
    raise NotImplementedError
