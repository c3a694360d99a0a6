"""Water after the equation of state of Thomsen and Hartka, with its density maximum."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    initial_sound_speed,
    stress_update,
)
from solver.tensor import determinant, isotropic


@model("constitutive_model", "TH_water")
class THWater(NamedTuple):
    """Water without viscosity: 1/rho = vo (1 - ko p + L (T - To + a p)^2), sigma = -(p - Pref) I.

    Thomsen and Hartka (Limnol. Oceanogr. 7, 1962). The work of compression heats it as that of a gas,
    dT/dt = -p (J/J_old - 1) / (rho co dt). Neither energy nor artificial viscosity, as in Uintah. Where no
    pressure gives the density (hot and strongly compressed) the answer is NaN.
    """

    a: Annotated[float, Parameter("shift of the density maximum by pressure, 2e-7", unit="K/Pa", gt=0.0)]
    b: Annotated[float, Parameter("slope of specific heat over temperature, 2.6", unit="J/(kg K^2)")]
    co: Annotated[float, Parameter("specific heat at To, 4205.7", unit="J/(kg K)", gt=0.0)]
    ko: Annotated[float, Parameter("compressibility at To, 5e-10", unit="1/Pa", gt=0.0)]
    To: Annotated[float, Parameter("temperature of the density maximum, 277", unit="K", gt=0.0)]
    L: Annotated[float, Parameter("curvature of volume over temperature, 8e-6", unit="1/K^2", gt=0.0)]
    vo: Annotated[float, Parameter("specific volume at To, 1.00008e-3", unit="m^3/kg", gt=0.0)]
    Pref: Annotated[float, Parameter("pressure at which the stress is zero", unit="Pa")] = 101325.0


@inline
def squared_sound_speed(model: THWater, pressure: Any, temperature: Any, density: Any) -> Any:
    """The isentropic slope dp/drho + p/rho^2 dp/de, for numbers or arrays."""
    a, L, ko, vo = model.a, model.L, model.ko, model.vo
    above = a * pressure + temperature - model.To
    softness = ko - 2.0 * a * L * above
    volume = 1.0 - ko * pressure + above * above * L
    by_density = volume * volume * vo / softness
    heat_capacity = (
        model.co
        + model.b * (model.To - temperature)
        + 2.0 * pressure * L * vo * (-a * pressure + model.To - 2.0 * temperature)
    )
    by_energy = 2.0 * L * above / (softness * heat_capacity)
    return by_density + by_energy * pressure / (density * density)


@initial_sound_speed.register
def _(model: THWater, density: Any, temperature: Any) -> Any:
    return np.sqrt(squared_sound_speed(model, model.Pref, temperature, density))


@implements(stress_update, THWater)
@lanewise
def th_water_stress(
    model: THWater, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Pressure as the smaller root of a quadratic, in the form without cancellation."""
    J = determinant(point.deformation_gradient)
    density = material.density / J
    T = point.temperature
    warm = T - model.To
    linear = model.ko - 2.0 * model.a * model.L * warm
    constant = 1.0 + model.L * warm * warm - 1.0 / (model.vo * density)
    root = math.sqrt(linear * linear - 4.0 * model.a * model.a * model.L * constant)
    pressure = 2.0 * constant / (linear + root)
    dilatation = J / determinant(point.deformation_gradient_old) - 1.0
    return StressUpdate(
        stress=isotropic(model.Pref - pressure),
        sound_speed=math.sqrt(squared_sound_speed(model, pressure, T, density)),
        strain_energy=0.0,
        heating_rate=-pressure * dilatation / (density * model.co * step.dt),
        artificial_pressure=0.0,
        localized=point.localized,
    )
