"""Constant melting temperature."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.materials.melting import melting_temperature
from solver.materials.plasticity_state import PlasticityState


@model("melting", "constant_Tm")
class ConstantMelting(NamedTuple):
    """The material's ``melt_temp``, whatever the state."""


@implements(melting_temperature, ConstantMelting)
@lanewise
def _(model: ConstantMelting, state: PlasticityState) -> float:
    return state.melt_temperature
