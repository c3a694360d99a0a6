"""Melting temperature linear in pressure or in specific volume."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.melting import melting_temperature
from solver.materials.plasticity_state import PlasticityState

NOT_GIVEN = -999.0
"""Value of a coefficient that the deck leaves out."""


@model("melting", "linear_Tm")
class LinearMelting(NamedTuple):
    """Linear melting law: T_m = T_m0 + b p, or T_m = T_m0 (1 + a (1 - J)).

    The form in pressure holds where ``b``, or ``a`` and ``K_T`` (b = a T_m0 / K_T), are given; the form in
    volume, of Kraut and Kennedy, where ``a`` is, or where Lindemann's law gives a = 2 (Gamma_0 - 1/3)
    (Poirier 1991).
    """

    T_m0: Annotated[float, Parameter("melting temperature at zero pressure", unit="K", gt=0.0)]
    a: Annotated[float, Parameter("coefficient of the compression 1 - J")] = NOT_GIVEN
    b: Annotated[float, Parameter("coefficient of the pressure", unit="K/Pa")] = NOT_GIVEN
    Gamma_0: Annotated[float, Parameter("Grueneisen's gamma in the reference state")] = NOT_GIVEN
    K_T: Annotated[float, Parameter("isothermal bulk modulus", unit="Pa")] = NOT_GIVEN

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        if self.a == NOT_GIVEN and self.b == NOT_GIVEN and self.Gamma_0 == NOT_GIVEN:
            return [("a", "give a, b or Gamma_0, without which the law has no slope")]
        return []


@implements(melting_temperature, LinearMelting)
@lanewise
def _(model: LinearMelting, state: PlasticityState) -> float:
    pressure = -state.mean_stress
    if model.a != NOT_GIVEN and model.K_T != NOT_GIVEN:
        return model.T_m0 * (1.0 + model.a * pressure / model.K_T)
    if model.b != NOT_GIVEN:
        return model.T_m0 + model.b * pressure
    compression = 1.0 - state.initial_density / state.density
    if model.a != NOT_GIVEN:
        return model.T_m0 * (1.0 + model.a * compression)
    if model.Gamma_0 != NOT_GIVEN:
        return model.T_m0 * (1.0 + 2.0 * (model.Gamma_0 - 1.0 / 3.0) * compression)
    return model.T_m0
