"""A concentration that grows at a given rate."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.diffusion import diffusivity, source
from solver.diffusion import parameters as of_law
from solver.dispatch import implements


@model("diffusion", "constant_rate")
class ConstantRate(NamedTuple):
    """c' = constant_rate everywhere, and no flux; the first time step is as short as for Fick's law with this D."""

    constant_rate: Annotated[float, Parameter("rate of the concentration", unit="1/s")]
    diffusivity: of_law.Diffusivity
    max_concentration: of_law.MaxConcentration
    min_concentration: of_law.MinConcentration = 0.0
    tolerance: of_law.Tolerance = 1.0e-100
    initial_concentration: of_law.InitialConcentration = 0.0


@implements(diffusivity, ConstantRate)
def _(model: ConstantRate, concentration: float, pressure: float) -> float:
    return 0.0


@implements(source, ConstantRate)
def _(model: ConstantRate) -> float:
    return model.constant_rate
