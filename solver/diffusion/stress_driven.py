"""Diffusion down the gradients of concentration and of pressure."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.diffusion import diffusivity, drift
from solver.diffusion import parameters as of_law
from solver.dispatch import implements


@model("diffusion", "gao_diffusion")
class StressDrivenDiffusion(NamedTuple):
    """J = D (grad c - Omega c (1 - c / c_max) / (k T) grad sigma_m): diffusing atoms avoid pressed places.

    Gao and Zhou, J. Appl. Phys. 109 (2011); Uintah once had this law, and no longer does. Equilibrium is
    c / (1 - c / c_max) = A exp(Omega sigma_m / (k T)).
    """

    diffusivity: of_law.Diffusivity
    max_concentration: of_law.MaxConcentration
    partial_atomic_vol: Annotated[float, Parameter("Omega, volume of a diffusing atom", unit="m^3")]
    boltzmann_const: Annotated[float, Parameter("Boltzmann's constant k", unit="J/K", gt=0.0)]
    operating_temp: Annotated[float, Parameter("temperature T", unit="K", gt=0.0)]
    min_concentration: of_law.MinConcentration = 0.0
    tolerance: of_law.Tolerance = 1.0e-100
    initial_concentration: of_law.InitialConcentration = 0.0


@implements(diffusivity, StressDrivenDiffusion)
def _(model: StressDrivenDiffusion, concentration: float, pressure: float) -> float:
    return model.diffusivity


@implements(drift, StressDrivenDiffusion)
def _(model: StressDrivenDiffusion, concentration: float) -> float:
    room = 1.0 - concentration / model.max_concentration
    energy = model.boltzmann_const * model.operating_temp
    return model.partial_atomic_vol * concentration * room / energy
