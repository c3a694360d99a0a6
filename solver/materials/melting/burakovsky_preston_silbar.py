"""Melting temperature by dislocation-mediated phase transition."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.melting import melting_temperature
from solver.materials.plasticity_state import PlasticityState


@model("melting", "bps_Tm")
class BurakovskyPrestonSilbarMelting(NamedTuple):
    """Burakovsky, Preston and Silbar (2000), J. Appl. Phys. 88, 6294.

    T_m(p) = T_m(0) (1 / eta + (G' / G_0) p / eta^(4/3)), eta = (1 + (B' / B_0) p)^(1 / B'), with
    k_b T_m(0) = kappa lambda G_0 v_WS / (8 pi ln(z - 1)) ln(alpha^2 / (4 b^2 rho_c)) and v_WS = a^3 / factor.
    """

    B0: Annotated[float, Parameter("bulk modulus at zero pressure", unit="Pa", gt=0.0)]
    dB_dp0: Annotated[float, Parameter("derivative of the bulk modulus by pressure", gt=0.0)]
    G0: Annotated[float, Parameter("shear modulus at zero pressure", unit="Pa", gt=0.0)]
    dG_dp0: Annotated[float, Parameter("derivative of the shear modulus by pressure")]
    kappa: Annotated[float, Parameter("constant of the character of dislocations")]
    z: Annotated[float, Parameter("coordination number of the lattice", gt=2.0)]
    b2rhoTm: Annotated[float, Parameter("b^2 times the critical dislocation density", gt=0.0)]
    alpha: Annotated[float, Parameter("cut-off radius of a dislocation in Burgers vectors")]
    # "lambda" is a Python keyword
    burgers_factor: Annotated[float, Parameter("b^3 / v_WS", tag="lambda")]
    a: Annotated[float, Parameter("lattice constant", unit="m", gt=0.0)]
    v_ws_a3_factor: Annotated[float, Parameter("a^3 / v_WS: atoms in a cell of the lattice", gt=0.0)]
    Boltzmann_Constant: Annotated[float, Parameter("Boltzmann's constant", unit="J/K", gt=0.0)]


@implements(melting_temperature, BurakovskyPrestonSilbarMelting)
@lanewise
def _(model: BurakovskyPrestonSilbarMelting, state: PlasticityState) -> float:
    p = -state.mean_stress
    atomic_volume = model.a**3.0 / model.v_ws_a3_factor
    stiffness = model.kappa * model.burgers_factor * atomic_volume * model.G0
    disorder = math.log(model.alpha * model.alpha / (4.0 * model.b2rhoTm))
    at_zero_pressure = stiffness / (8.0 * math.pi * math.log(model.z - 1.0)) * disorder
    eta = (1.0 + model.dB_dp0 / model.B0 * p) ** (1.0 / model.dB_dp0)
    shear = model.dG_dp0 / model.G0 * p / eta ** (1.0 / 3.0)
    return at_zero_pressure / model.Boltzmann_Constant / eta * (1.0 + shear)
