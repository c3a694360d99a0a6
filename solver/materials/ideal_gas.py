"""Ideal gas carried by particles."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.lanes import where
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    initial_sound_speed,
    stress_update,
)
from solver.tensor import determinant, isotropic, trace

SHOCK_WIDTH = 2.5
"""Cells over which the artificial viscosity spreads a shock."""


@model("constitutive_model", "ideal_gas")
class IdealGas(NamedTuple):
    """Ideal gas of constant specific heat: p = (gamma - 1) rho c_v T, sigma = -(p - Pref) I.

    The work of compression heats it: dT/dt = -p (J/J_old - 1) / (rho c_v dt). Shocks are spread by the
    viscous pressure of von Neumann and Richtmyer (1950), q = rho (2.5 h tr d)^2 in compression, instead of
    the one that the deck's coefficients describe.
    """

    gamma: Annotated[float, Parameter("ratio of specific heats c_p / c_v", gt=1.0)]
    specific_heat: Annotated[float, Parameter("specific heat at constant volume", unit="J/(kg K)", gt=0.0)]
    Pref: Annotated[float, Parameter("pressure at which the stress is zero", unit="Pa")] = 101325.0


@initial_sound_speed.register
def _(model: IdealGas, density: Any, temperature: Any) -> Any:
    return np.sqrt(model.gamma * (model.gamma - 1.0) * model.specific_heat * temperature)


@implements(stress_update, IdealGas)
@lanewise
def ideal_gas_stress(
    model: IdealGas, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Pressure from density and temperature."""
    J = determinant(point.deformation_gradient)
    dilatation = J / determinant(point.deformation_gradient_old) - 1.0
    density = material.density / J
    pressure_over_density = (model.gamma - 1.0) * model.specific_heat * point.temperature
    pressure = density * pressure_over_density
    rate = trace(point.velocity_gradient)
    jump = SHOCK_WIDTH * step.length * rate
    compressed = (rate < 0.0) & step.artificial_viscosity
    viscous_pressure = where(compressed, density * jump * jump, 0.0)
    return StressUpdate(
        stress=isotropic(model.Pref - pressure),
        sound_speed=math.sqrt(model.gamma * pressure_over_density),
        strain_energy=0.0,
        heating_rate=-pressure * dilatation / (density * model.specific_heat * step.dt),
        artificial_pressure=viscous_pressure,
        localized=point.localized,
    )
