"""Equations of state: the mean stress of an elastic-plastic material."""

from __future__ import annotations

from typing import Any

from solver.declare import family
from solver.dispatch import generic
from solver.materials.plasticity_state import PlasticityState

EQUATION_OF_STATE = family(
    "equation_of_state",
    tag="equation_of_state",
    package="solver.materials.equation_of_state",
    key="@type",
    meaning="pressure as a function of density and internal energy",
)


@generic
def mean_stress(model: Any, state: PlasticityState, volumetric_strain: float) -> float:
    """Mean stress at the end of the step, positive in tension.

    ``volumetric_strain`` is the step's increment tr(d) dt.
    """
    raise NotImplementedError


@generic
def mean_stress_slope(model: Any, state: PlasticityState) -> float:
    """Derivative of the mean stress by J = initial density / density at constant internal energy."""
    raise NotImplementedError


@generic
def isentropic_heating(model: Any, state: PlasticityState, dilatation_rate: float) -> float:
    """Rate of temperature by reversible change of volume, K/s."""
    raise NotImplementedError
