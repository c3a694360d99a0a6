"""Specific heat of steel."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.lanes import everywhere, where
from solver.materials.plasticity_state import PlasticityState
from solver.materials.specific_heat import specific_heat


@model("specific_heat", "steel_Cp")
class SteelSpecificHeat(NamedTuple):
    """Lederman, Salamon and Shacklette (1974), Phys. Rev. B 9, 2981, with its peak at the phase transition.

    With t = T / T_c - 1: C_p = A_0 + B_0 t + C_0 |t|^-n_0 below T_c and A_1 + B_1 t + C_1 t^-n_1 above. At
    T_c itself the value is that of 1 K below. The defaults are those of 4340 steel.
    """

    T_transition: Annotated[float, Parameter("temperature T_c of the phase transition", unit="K", gt=1.0)] = (
        1040.0
    )
    A_LowT: Annotated[float, Parameter("A_0", unit="J/(kg K)")] = 190.14
    B_LowT: Annotated[float, Parameter("B_0", unit="J/(kg K)")] = 273.75
    C_LowT: Annotated[float, Parameter("C_0", unit="J/(kg K)")] = 418.30
    n_LowT: Annotated[float, Parameter("n_0")] = 0.2
    A_HighT: Annotated[float, Parameter("A_1", unit="J/(kg K)")] = 465.21
    B_HighT: Annotated[float, Parameter("B_1", unit="J/(kg K)")] = 267.52
    C_HighT: Annotated[float, Parameter("C_1", unit="J/(kg K)")] = 58.16
    n_HighT: Annotated[float, Parameter("n_1")] = 0.35


@implements(specific_heat, SteelSpecificHeat)
@lanewise
def _(model: SteelSpecificHeat, state: PlasticityState) -> float:
    T = state.temperature
    T = where(model.T_transition == T, T - 1.0, T)
    t = T / model.T_transition - 1.0
    low = t < 0.0
    heat = model.A_LowT + model.B_LowT * t + model.C_LowT / abs(t) ** model.n_LowT
    if not everywhere(low):
        high = model.A_HighT + model.B_HighT * t + model.C_HighT / abs(t) ** model.n_HighT
        heat = where(low, heat, high)
    return heat
