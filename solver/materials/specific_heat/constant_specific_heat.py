"""Constant specific heat."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.materials.plasticity_state import PlasticityState
from solver.materials.specific_heat import specific_heat


@model("specific_heat", "constant_Cp")
class ConstantSpecificHeat(NamedTuple):
    """The material's ``specific_heat``, whatever the state."""


@implements(specific_heat, ConstantSpecificHeat)
@lanewise
def _(model: ConstantSpecificHeat, state: PlasticityState) -> float:
    return state.specific_heat
