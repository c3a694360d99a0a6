"""Specific heat as a rational function of reduced temperature."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.plasticity_state import PlasticityState
from solver.materials.specific_heat import specific_heat


@model("specific_heat", "cubic_Cp")
class CubicSpecificHeat(NamedTuple):
    """Sewell and Menikoff (2003), Complete equation of state for beta-HMX.

    C_v = t^3 / (c0 + c1 t + c2 t^2 + c3 t^3) with t = T / theta and, in K,
    theta = (rho / rho_0)^a exp(b (rho / rho_0 - 1)), and beta^2 T K / rho more for constant pressure.
    (Uintah reads this model as ``constant_Cp``.)
    """

    c0: Annotated[float, Parameter("c0", unit="kg K/J")]
    c1: Annotated[float, Parameter("c1", unit="kg K/J")]
    c2: Annotated[float, Parameter("c2", unit="kg K/J")]
    c3: Annotated[float, Parameter("c3", unit="kg K/J")]
    a: Annotated[float, Parameter("power of the density in the Debye temperature")] = 1.0
    b: Annotated[float, Parameter("exponential of the density in the Debye temperature")] = 1.0
    beta: Annotated[float, Parameter("coefficient of volumetric thermal expansion", unit="1/K")] = 0.0


@implements(specific_heat, CubicSpecificHeat)
@lanewise
def _(model: CubicSpecificHeat, state: PlasticityState) -> float:
    eta = state.density / state.initial_density
    t = state.temperature / (eta**model.a * math.exp(model.b * (eta - 1.0)))
    at_constant_volume = t * t * t / (model.c0 + t * (model.c1 + t * (model.c2 + t * model.c3)))
    expansion = model.beta * model.beta * state.temperature * state.bulk_modulus / state.density
    return at_constant_volume + expansion
