"""Hyperelastic equation of state."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.materials.equation_of_state import isentropic_heating, mean_stress, mean_stress_slope
from solver.materials.plasticity_state import PlasticityState


@model("equation_of_state", "default_hyper")
class DefaultHyper(NamedTuple):
    """Neo-Hookean mean stress (K / 2) (J - 1/J) with the material's bulk modulus K (Simo and Hughes 1998)."""


@implements(mean_stress, DefaultHyper)
@lanewise
def _(model: DefaultHyper, state: PlasticityState, volumetric_strain: float) -> float:
    J = state.initial_density / state.density
    return 0.5 * state.bulk_modulus * (J - 1.0 / J)


@implements(mean_stress_slope, DefaultHyper)
@lanewise
def _(model: DefaultHyper, state: PlasticityState) -> float:
    J = state.initial_density / state.density
    return 0.5 * state.bulk_modulus * (1.0 + 1.0 / (J * J))


@implements(isentropic_heating, DefaultHyper)
@lanewise
def _(model: DefaultHyper, state: PlasticityState, dilatation_rate: float) -> float:
    return 0.0
