"""Hypoelastic equation of state."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.materials.equation_of_state import isentropic_heating, mean_stress, mean_stress_slope
from solver.materials.plasticity_state import PlasticityState


@model("equation_of_state", "default_hypo")
class DefaultHypo(NamedTuple):
    """Mean stress in rate form, sigma_m' = K tr(d), with the material's bulk modulus K."""


@implements(mean_stress, DefaultHypo)
@lanewise
def _(model: DefaultHypo, state: PlasticityState, volumetric_strain: float) -> float:
    return state.mean_stress + state.bulk_modulus * volumetric_strain


@implements(mean_stress_slope, DefaultHypo)
@lanewise
def _(model: DefaultHypo, state: PlasticityState) -> float:
    """K / J, from J' = J tr(d)."""
    return state.bulk_modulus * state.density / state.initial_density


@implements(isentropic_heating, DefaultHypo)
@lanewise
def _(model: DefaultHypo, state: PlasticityState, dilatation_rate: float) -> float:
    return 0.0
