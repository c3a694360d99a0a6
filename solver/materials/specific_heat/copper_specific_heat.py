"""Specific heat of copper."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.lanes import where
from solver.materials.plasticity_state import PlasticityState
from solver.materials.specific_heat import specific_heat


@model("specific_heat", "copper_Cp")
class CopperSpecificHeat(NamedTuple):
    """Fit to data of copper (Banerjee 2012, Eq. 66).

    C_p = A_0 T^3 - B_0 T^2 + C_0 T - D_0 below the transition and A_1 T + B_1 above.
    """

    T_transition: Annotated[float, Parameter("temperature where the forms meet", unit="K", gt=0.0)] = 270.0
    A_LowT: Annotated[float, Parameter("A_0", unit="J/(kg K^4)")] = 0.0000416
    B_LowT: Annotated[float, Parameter("B_0", unit="J/(kg K^3)")] = 0.027
    C_LowT: Annotated[float, Parameter("C_0", unit="J/(kg K^2)")] = 6.21
    D_LowT: Annotated[float, Parameter("D_0", unit="J/(kg K)")] = 142.6
    A_HighT: Annotated[float, Parameter("A_1", unit="J/(kg K^2)")] = 0.1009
    B_HighT: Annotated[float, Parameter("B_1", unit="J/(kg K)")] = 358.4


@implements(specific_heat, CopperSpecificHeat)
@lanewise
def _(model: CopperSpecificHeat, state: PlasticityState) -> float:
    T = state.temperature
    cold = model.A_LowT * (T * T * T) - model.B_LowT * (T * T) + model.C_LowT * T - model.D_LowT
    return where(model.T_transition > T, cold, model.A_HighT * T + model.B_HighT)
