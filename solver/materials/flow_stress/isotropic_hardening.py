"""Linear isotropic hardening."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.flow_stress import flow_stress, hardening_slope, rate_slope
from solver.materials.plasticity_state import PlasticityState


@model("flow_stress", "isotropic_hardening")
class IsotropicHardening(NamedTuple):
    """Flow stress that grows linearly with plastic strain: sigma = sigma_Y + K ep (Simo and Hughes 1998)."""

    sigma_Y: Annotated[float, Parameter("initial yield stress", unit="Pa", ge=0.0)]
    K: Annotated[float, Parameter("hardening modulus", unit="Pa")]


@implements(flow_stress, IsotropicHardening)
@lanewise
def _(model: IsotropicHardening, state: PlasticityState) -> float:
    return model.sigma_Y + model.K * state.plastic_strain


@implements(hardening_slope, IsotropicHardening)
@lanewise
def _(model: IsotropicHardening, state: PlasticityState) -> float:
    return model.K


@implements(rate_slope, IsotropicHardening)
@lanewise
def _(model: IsotropicHardening, state: PlasticityState) -> float:
    return 0.0
