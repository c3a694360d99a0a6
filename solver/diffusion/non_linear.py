"""Diffusion that the concentration speeds up and pressure slows down."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.diffusion import diffusivity
from solver.diffusion import parameters as of_law
from solver.dispatch import implements


@dataclass(frozen=True)
class FluxTime:
    """From when on the flux has a direction."""

    time: Annotated[float, Parameter("time of the change", unit="s")]
    flux_direction: Annotated[str, Parameter("direction from then on", choices=("in", "out", "transition"))]


@dataclass(frozen=True)
class FluxCurve:
    """Direction of the flux against time."""

    time_point: Annotated[tuple[FluxTime, ...], Parameter("a change of direction, in order of time")]

    def direction(self, time: float) -> str:
        """The direction at a time; before the first point that of the first."""
        past = [point for point in self.time_point if point.time < time]
        return (past or list(self.time_point))[-1 if past else 0].flux_direction


@model("diffusion", "non_linear1")
class NonLinearDiffusion(NamedTuple):
    """J = D grad c with D = D0 exp(tuning1 c), and exp(-tuning2 p*) where pressure counts.

    p* is tuning5 times the pressure, kept between tuning3 and tuning4. While ``diff_curve`` says that the flux
    goes out, particles keep the D that they have. The law of two-phase lithiation of silicon: Liu et al., ACS
    Nano 6 (2012).
    """

    diffusivity: of_law.Diffusivity
    max_concentration: of_law.MaxConcentration
    use_pressure: Annotated[bool, Parameter("whether pressure counts")]
    tuning1: Annotated[float, Parameter("growth of ln D with the concentration")]
    tuning2: Annotated[float, Parameter("fall of ln D with the scaled pressure")]
    tuning3: Annotated[float, Parameter("least scaled pressure")] = -math.inf
    tuning4: Annotated[float, Parameter("largest scaled pressure")] = math.inf
    tuning5: Annotated[float, Parameter("scale of the pressure", unit="1/Pa")] = 1.0
    diff_curve: Annotated[FluxCurve | None, Parameter("direction of the flux against time")] = None
    min_concentration: of_law.MinConcentration = 0.0
    tolerance: of_law.Tolerance = 1.0e-100
    initial_concentration: of_law.InitialConcentration = 0.0
    conductivity_equation: of_law.Conductivity = None

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        if self.tuning3 > self.tuning4:
            return [("tuning4", "tuning4, the largest pressure, must not be below tuning3, the least")]
        if self.diff_curve is not None and not self.diff_curve.time_point:
            return [("diff_curve", "a diff_curve needs a time_point")]
        return []


@implements(diffusivity, NonLinearDiffusion)
def _(model: NonLinearDiffusion, concentration: float, pressure: float) -> float:
    D = model.diffusivity * math.exp(model.tuning1 * concentration)
    if model.use_pressure:
        D *= math.exp(-model.tuning2 * min(max(model.tuning5 * pressure, model.tuning3), model.tuning4))
    return D
