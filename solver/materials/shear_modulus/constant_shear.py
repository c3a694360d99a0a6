"""Constant shear modulus."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.materials.plasticity_state import PlasticityState
from solver.materials.shear_modulus import shear_modulus


@model("shear_modulus", "constant_shear")
class ConstantShear(NamedTuple):
    """The material's ``shear_modulus``, whatever the state."""


@implements(shear_modulus, ConstantShear)
@lanewise
def _(model: ConstantShear, state: PlasticityState) -> float:
    return state.shear_modulus
