"""Shear modulus that drops smoothly at melting."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.lanes import where
from solver.materials.plasticity_state import PlasticityState
from solver.materials.shear_modulus import shear_modulus

LEAST = 1.0e-8
"""Shear modulus of a melt, Pa."""
GAS_CONSTANT = 1.3806503e4 / 1.6605402
"""Boltzmann's constant / atomic mass unit, J/(kg K)."""
LARGEST_EXPONENT = 700.0


@model("shear_modulus", "np_shear")
class NadalLePoacShear(NamedTuple):
    """Nadal and Le Poac (2003), J. Appl. Phys. 93, 2472.

    mu = (mu_0 (1 + s p / eta^(1/3)) (1 - t) + rho k_b T / (C m)) / j with t = T / T_m, the compression
    eta = rho / rho_0 and j = 1 + exp((t - 1) / (zeta (1 - t / (1 + zeta)))); nearly nothing for t > 1 + zeta.
    """

    mu_0: Annotated[float, Parameter("shear modulus at 0 K and zero pressure", unit="Pa", gt=0.0)]
    zeta: Annotated[float, Parameter("width of the drop, in melting temperatures", gt=0.0)]
    slope_mu_p_over_mu0: Annotated[float, Parameter("s = (d mu / d p) / mu_0", unit="1/Pa")]
    C: Annotated[float, Parameter("(6 pi^2)^(2/3) f^2 / 3 of Lindemann's constant f", gt=0.0)]
    m: Annotated[float, Parameter("atomic mass", unit="u", gt=0.0)]


@implements(shear_modulus, NadalLePoacShear)
@lanewise
def _(model: NadalLePoacShear, state: PlasticityState) -> float:
    t = state.temperature / state.melt_temperature
    width = model.zeta * (1.0 - t / (1.0 + model.zeta))  # negative for t > 1 + zeta
    gone = t - 1.0 > LARGEST_EXPONENT * width
    exponent = where(gone, 0.0, (t - 1.0) / where(gone, 1.0, width))
    eta = state.density / state.initial_density
    cold = model.mu_0 * (1.0 - model.slope_mu_p_over_mu0 * state.mean_stress / eta ** (1.0 / 3.0))
    thermal = state.density * GAS_CONSTANT * state.temperature / (model.C * model.m)
    warm = max((cold * (1.0 - t) + thermal) / (1.0 + math.exp(exponent)), LEAST)
    return where(t <= 0.0, model.mu_0, where(gone, LEAST, warm))
