"""Diffusion of two kinds of ions in an electric field."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section
from ups.grammar import known
from ups.grammar.diffusion import ConductivityEquation


@known("diffusion", "non_linear2")
class ChargedDiffusion(Section):
    """Positive and negative ions that diffuse and drift in an electric field."""

    diffusivity: Annotated[float, Parameter("diffusion coefficient", unit="m^2/s")]
    max_concentration: Annotated[float, Parameter("concentration at saturation")]
    boltzmann_const: Annotated[float, Parameter("Boltzmann's constant", unit="J/K")]
    operating_temp: Annotated[float, Parameter("temperature of the process", unit="K")]
    unit_charge: Annotated[float, Parameter("charge of a diffusing ion", unit="C")]
    min_concentration: Annotated[float, Parameter("least concentration")] = 0.0
    conc_tolerance: Annotated[float, Parameter("how far from the bounds it stops")] = 0.0
    initial_concentration: Annotated[float, Parameter("concentration at the start")] = 0.0
    init_conc: Annotated[float, Parameter("concentration at the start")] = 0.0
    ramp_time: Annotated[float, Parameter("time in which the flux grows to its value", unit="s")] = 0.0
    conductivity_equation: Annotated[
        ConductivityEquation | None, Parameter("conductivity against concentration")
    ] = None
