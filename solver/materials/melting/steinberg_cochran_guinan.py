"""Melting temperature by the modified Lindemann law."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.melting import melting_temperature
from solver.materials.plasticity_state import PlasticityState


@model("melting", "scg_Tm")
class SteinbergCochranGuinanMelting(NamedTuple):
    """Steinberg, Cochran and Guinan (1980), J. Appl. Phys. 51, 1498.

    T_m = T_m0 exp(2 a (1 - 1/eta)) eta^(2 (Gamma_0 - a - 1/3)) with the compression eta = rho / rho_0.
    """

    T_m0: Annotated[float, Parameter("melting temperature at eta = 1", unit="K", gt=0.0)]
    Gamma_0: Annotated[float, Parameter("Grueneisen's gamma in the reference state")]
    a: Annotated[float, Parameter("first-order volume correction to Grueneisen's gamma")]


@implements(melting_temperature, SteinbergCochranGuinanMelting)
@lanewise
def _(model: SteinbergCochranGuinanMelting, state: PlasticityState) -> float:
    eta = state.density / state.initial_density
    power = 2.0 * (model.Gamma_0 - model.a - 1.0 / 3.0)
    return model.T_m0 * math.exp(2.0 * model.a * (1.0 - 1.0 / eta)) * eta**power
