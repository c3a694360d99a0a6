"""Shear modulus linear in pressure and temperature."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.plasticity_state import PlasticityState
from solver.materials.shear_modulus import shear_modulus

REFERENCE_TEMPERATURE = 300.0
"""K."""


@model("shear_modulus", "scg_shear")
class SteinbergCochranGuinanShear(NamedTuple):
    """Steinberg, Cochran and Guinan (1980), J. Appl. Phys. 51, 1498.

    mu = mu_0 (1 + A p / eta^(1/3) - B (T - 300 K)) with the compression eta = rho / rho_0.
    """

    mu_0: Annotated[float, Parameter("shear modulus at 300 K and zero pressure", unit="Pa", gt=0.0)]
    A: Annotated[float, Parameter("pressure coefficient, (d mu / d p) / mu_0", unit="1/Pa")]
    B: Annotated[float, Parameter("thermal coefficient, -(d mu / d T) / mu_0", unit="1/K")]


@implements(shear_modulus, SteinbergCochranGuinanShear)
@lanewise
def _(model: SteinbergCochranGuinanShear, state: PlasticityState) -> float:
    eta = state.density / state.initial_density
    pressure = -state.mean_stress
    warmer = state.temperature - REFERENCE_TEMPERATURE
    return model.mu_0 * (1.0 + model.A * pressure / eta ** (1.0 / 3.0) - model.B * warmer)
