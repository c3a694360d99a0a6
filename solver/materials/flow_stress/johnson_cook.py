"""The flow stress of Johnson and Cook."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, where
from solver.materials.flow_stress import flow_stress, hardening_slope, in_step, rate_slope
from solver.materials.plasticity_state import PlasticityState


@model("flow_stress", "johnson_cook")
class JohnsonCook(NamedTuple):
    """Johnson and Cook (1983): sigma = (A + B ep^n) (1 + C ln r) (1 - T*^m).

    r is the strain rate divided by ``epdot_0`` and T* = (T - T_r) / (T_m - T_r). Below the reference rate the
    middle factor is (1 + r)^C, below the reference temperature the last one is 1 - T*, above ``T_m`` it is 0.
    As in Uintah the rate is that of the whole deformation, and ``T_m`` is this model's own: the melting
    temperature model decides only whether a particle melts.
    """

    A: Annotated[float, Parameter("yield stress at the reference rate and temperature", unit="Pa", ge=0.0)]
    B: Annotated[float, Parameter("strain hardening coefficient", unit="Pa", ge=0.0)]
    C: Annotated[float, Parameter("strain rate coefficient", ge=0.0)]
    n: Annotated[float, Parameter("strain hardening exponent", ge=0.0)]
    m: Annotated[float, Parameter("thermal softening exponent", gt=0.0)]
    epdot_0: Annotated[float, Parameter("reference strain rate", unit="1/s", gt=0.0)] = 1.0
    T_r: Annotated[float, Parameter("reference temperature", unit="K", ge=0.0)] = 298.0
    T_m: Annotated[float, Parameter("melting temperature", unit="K", gt=0.0)] = 1793.0

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        if self.T_m > self.T_r:
            return []
        return [("T_m", f"the melting temperature {self.T_m:g} K is not above the reference {self.T_r:g} K")]


@inline
def rate_factor(model: JohnsonCook, r: float) -> float:
    """The factor by which the strain rate, r in units of ``epdot_0``, raises the flow stress."""
    slow = r < 1.0
    factor = 1.0 + model.C * math.log(max(r, 1.0))
    if anywhere(slow):
        factor = where(slow, (1.0 + r) ** model.C, factor)
    return factor


@inline
def thermal_factor(model: JohnsonCook, temperature: float) -> float:
    """The factor by which temperature lowers the flow stress."""
    homologous = (temperature - model.T_r) / (model.T_m - model.T_r)
    factor = 1.0 - homologous
    if anywhere(homologous >= 0.0):
        factor = where(homologous < 0.0, factor, 1.0 - max(homologous, 0.0) ** model.m)
    return where(temperature > model.T_m, 0.0, factor)


class InStep(NamedTuple):
    """The law at the rate and temperature of a step."""

    model: JohnsonCook
    rate: float
    """Factor of the strain rate."""
    slope: float
    """Its derivative by r."""
    thermal: float
    """Factor of the temperature."""


@implements(in_step, JohnsonCook)
@lanewise
def _(model: JohnsonCook, state: PlasticityState) -> InStep:
    r = state.strain_rate / model.epdot_0
    rate = rate_factor(model, r)
    slope = where(r < 1.0, model.C * rate / (1.0 + r), model.C / max(r, 1.0))
    return InStep(model, rate, slope, thermal_factor(model, state.temperature))


@inline
def hardened(model: JohnsonCook, plastic_strain: float) -> float:
    """The flow stress at the reference rate and temperature."""
    return model.A + model.B * plastic_strain**model.n


@implements(flow_stress, InStep)
@lanewise
def _(law: InStep, state: PlasticityState) -> float:
    return hardened(law.model, state.plastic_strain) * law.rate * law.thermal


@implements(hardening_slope, InStep)
@lanewise
def _(law: InStep, state: PlasticityState) -> float:
    strained = state.plastic_strain > 0.0
    hardening = law.model.B * state.plastic_strain**law.model.n
    slope = law.model.n * hardening * (law.rate * law.thermal) / where(strained, state.plastic_strain, 1.0)
    return where(strained, slope, 0.0)


@implements(rate_slope, InStep)
@lanewise
def _(law: InStep, state: PlasticityState) -> float:
    """Slope by r, the rate in units of ``epdot_0``."""
    return hardened(law.model, state.plastic_strain) * law.thermal * law.slope


@implements(flow_stress, JohnsonCook)
@lanewise
def _(model: JohnsonCook, state: PlasticityState) -> float:
    return flow_stress(in_step(model, state), state)


@implements(hardening_slope, JohnsonCook)
@lanewise
def _(model: JohnsonCook, state: PlasticityState) -> float:
    return hardening_slope(in_step(model, state), state)


@implements(rate_slope, JohnsonCook)
@lanewise
def _(model: JohnsonCook, state: PlasticityState) -> float:
    return rate_slope(in_step(model, state), state)
