"""Specific heat as a function of temperature and density."""

from __future__ import annotations

from typing import Any

from solver.declare import family
from solver.dispatch import generic
from solver.materials.plasticity_state import PlasticityState

SPECIFIC_HEAT = family(
    "specific_heat",
    tag="specific_heat_model",
    package="solver.materials.specific_heat",
    key="@type",
    meaning="specific heat as a function of temperature and density",
)


@generic
def specific_heat(model: Any, state: PlasticityState) -> float:
    """Specific heat, J/(kg K); ``state.specific_heat`` holds the material's constant."""
    raise NotImplementedError
