"""Melting temperature as a function of pressure and density."""

from __future__ import annotations

from typing import Any

from solver.declare import family
from solver.dispatch import generic
from solver.materials.plasticity_state import PlasticityState

MELTING = family(
    "melting",
    tag="melting_temp_model",
    package="solver.materials.melting",
    key="@type",
    meaning="melting temperature as a function of pressure and density",
)


@generic
def melting_temperature(model: Any, state: PlasticityState) -> float:
    """Melting temperature; ``state.melt_temperature`` holds the material's constant."""
    raise NotImplementedError
