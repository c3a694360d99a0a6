"""Shear modulus that falls with temperature."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.lanes import where
from solver.materials.plasticity_state import PlasticityState
from solver.materials.shear_modulus import shear_modulus

COLDEST = 700.0
"""T_0 / T beyond which the modulus is that at 0 K."""


@model("shear_modulus", "mts_shear")
class MechanicalThresholdShear(NamedTuple):
    """Varshni (1970), Phys. Rev. B 2, 3952; Chen and Gray (1996): mu = mu_0 - D / (exp(T_0 / T) - 1)."""

    mu_0: Annotated[float, Parameter("shear modulus at 0 K", unit="Pa", gt=0.0)]
    D: Annotated[float, Parameter("thermal coefficient", unit="Pa", ge=0.0)]
    T_0: Annotated[float, Parameter("characteristic temperature", unit="K", gt=0.0)]


@implements(shear_modulus, MechanicalThresholdShear)
@lanewise
def _(model: MechanicalThresholdShear, state: PlasticityState) -> float:
    cold = state.temperature * COLDEST < model.T_0
    T = where(cold, model.T_0, state.temperature)
    return model.mu_0 - where(cold, 0.0, model.D / (math.exp(model.T_0 / T) - 1.0))
