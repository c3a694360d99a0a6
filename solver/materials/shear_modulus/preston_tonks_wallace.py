"""Shear modulus of the Preston-Tonks-Wallace model."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.plasticity_state import PlasticityState
from solver.materials.shear_modulus import shear_modulus


@model("shear_modulus", "ptw_shear")
class PrestonTonksWallaceShear(NamedTuple):
    """Preston and Wallace (1992), Solid State Comm. 81, 277, with the pressure dependence of Steinberg et al.

    mu = mu_0 (1 + s p / eta^(1/3)) (1 - alphap T / T_m) with the compression eta = rho / rho_0.
    """

    mu_0: Annotated[float, Parameter("shear modulus at 0 K and zero pressure", unit="Pa", gt=0.0)]
    alpha: Annotated[float, Parameter("thermal coefficient", ignored="alphap takes its place")]
    alphap: Annotated[float, Parameter("thermal softening in units of the melting temperature")]
    slope_mu_p_over_mu0: Annotated[float, Parameter("s = (d mu / d p) / mu_0", unit="1/Pa")]


@implements(shear_modulus, PrestonTonksWallaceShear)
@lanewise
def _(model: PrestonTonksWallaceShear, state: PlasticityState) -> float:
    eta = state.density / state.initial_density
    compressed = 1.0 - model.slope_mu_p_over_mu0 * state.mean_stress / eta ** (1.0 / 3.0)
    return model.mu_0 * compressed * (1.0 - model.alphap * state.temperature / state.melt_temperature)
