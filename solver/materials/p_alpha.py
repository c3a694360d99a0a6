"""Porous solid that is crushed to full density, after Herrmann's P-alpha model."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, like, negation, where
from solver.materials.comp_neo_hook import radial_return
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    artificial_viscosity,
    initial_sound_speed,
    initialize,
    stress_update,
)
from solver.particles import Array, Particles, StateVariable
from solver.tensor import determinant, isotropic, trace


class PAlphaState(NamedTuple):
    """What a particle remembers, each (n,) or (n, 3, 3)."""

    alpha: Annotated[Array, StateVariable("p.alpha")]
    """Ratio of the solid's density to the material's."""
    least_alpha: Annotated[Array, StateVariable("p.alphaMin")]
    """The smallest so far."""
    closing_temperature: Annotated[Array, StateVariable("p.tempAlpha1")]
    """Temperature at which the pores were closed, or that of the last step before."""
    plastic_strain: Annotated[Array, StateVariable("p.plasticStrain")]
    elastic_stretch: Annotated[Array, StateVariable("p.bElBar", "Matrix3", 1.0)]
    """Isochoric elastic left Cauchy-Green tensor."""


@model("constitutive_model", "p_alpha")
class PAlpha(NamedTuple):
    """Porous solid of distension alpha = rhoS / rho >= 1 (Herrmann, J. Appl. Phys. 40, 1969).

    Elastic p = K0 (1 - rho_0 / rho) up to Pe; then the pores are crushed along
    p = Ps - (Ps - Pe) sqrt((alpha - 1) / (alpha_P - 1)), whose work heats; unloading from there follows
    dalpha/dp = alpha^2 / Ks (1 - 1/h^2), h = 1 + (c_e - c_s) (alpha - 1) / (c_s (alpha_0 - 1)) with the sound
    speeds c_e, c_s of the porous and the solid material. Once dense, with z = rho / rhoS - 1 and E the heat
    since closing, p = Ps + Gamma_0 E + rhoS C_0^2 (1/z + 1 - Gamma_0/2) / (1/z - (S_alpha - 1))^2. In tension
    and beyond alpha_0, p = Ku (1 - rho_max / rho). To this shear_modulus adds the deviator of
    comp_neo_hook_plastic. Energy is not counted, as in Uintah.
    """

    Ps: Annotated[float, Parameter("pressure at which all pores are closed", unit="Pa", gt=0.0)]
    Pe: Annotated[float, Parameter("pressure at which crushing begins", unit="Pa", ge=0.0)]
    rhoS: Annotated[float, Parameter("density of the solid without pores", unit="kg/m^3", gt=0.0)]
    K0: Annotated[float, Parameter("bulk modulus of the porous material", unit="Pa", gt=0.0)]
    Ks: Annotated[float, Parameter("bulk modulus of the solid", unit="Pa", gt=0.0)]
    T_0: Annotated[float, Parameter("temperature at the start", unit="K", ge=0.0)]
    C_0: Annotated[float, Parameter("bulk sound speed of the solid", unit="m/s", gt=0.0)]
    Gamma_0: Annotated[float, Parameter("Grueneisen parameter of the solid", ge=0.0)]
    S_alpha: Annotated[float, Parameter("slope of shock speed over particle speed", ge=0.0)]
    Ku: Annotated[float, Parameter("bulk modulus in tension; 0 for a tenth of K0", unit="Pa", ge=0.0)] = 0.0
    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)] = 0.0
    yield_stress: Annotated[float, Parameter("yield stress in tension", unit="Pa", ge=0.0)] = 9.0e99
    hardening_modulus: Annotated[float, Parameter("slope of yield stress over strain", unit="Pa")] = 0.0

    alpha0: Annotated[
        float, Parameter("distension at the start", ignored="it is rhoS over the density of the material")
    ] = 0.0

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return PAlphaState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        found = []
        if self.Pe >= self.Ps:
            found.append(("Pe", "Pe must be less than Ps"))
        if self.Pe >= self.K0:
            found.append(("Pe", "Pe must be less than K0"))
        return found


@initial_sound_speed.register
def _(model: PAlpha, density: Any, temperature: Any) -> Any:
    return np.sqrt(model.K0 / density)


@initialize.register
def _(model: PAlpha, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    state.least_alpha[...] = model.rhoS / material.density
    state.closing_temperature[...] = model.T_0


class Compaction(NamedTuple):
    """Pressure of a porous material and what goes with it."""

    pressure: float
    sound_speed: float
    crushing: bool
    """Whether pores are being crushed for good."""


@inline
def porous_pressure(model: PAlpha, initial_density: float, alpha: float, least_alpha: float) -> Compaction:
    """Pressure for 1 <= alpha < alpha_0, loading where alpha is the smallest so far, else unloading."""
    alpha_0 = model.rhoS / initial_density
    alpha_P = alpha_0 * (1.0 - model.Pe / model.K0)
    solid_speed = math.sqrt(model.Ks / model.rhoS)
    loading = alpha <= least_alpha
    elastic = where(loading, alpha > alpha_P, (alpha >= alpha_P) & (least_alpha >= alpha_P))
    density = model.rhoS / alpha
    porous_speed = math.sqrt(model.K0 / initial_density)
    speed = solid_speed + (porous_speed - solid_speed) * (alpha - 1.0) / (alpha_0 - 1.0)
    crushed = where(elastic, 0.0, (alpha - 1.0) / (alpha_P - 1.0))
    pressure = model.Ps - (model.Ps - model.Pe) * math.sqrt(crushed)
    h = speed / solid_speed
    compliance = min(alpha * alpha / model.Ks * (1.0 - 1.0 / (h * h)), -1.0 / model.Ks)
    pressure += where(loading, 0.0, (alpha - least_alpha) / compliance)
    return Compaction(
        where(elastic, model.K0 * (1.0 - initial_density / density), pressure),
        where(elastic, math.sqrt(model.K0 / density), speed),
        loading & negation(elastic),
    )


@inline
def solid_pressure(model: PAlpha, density: float, specific_heat: float, warming: float) -> float:
    """Pressure of the dense solid, ``warming`` being its temperature above that of closing."""
    pressure = model.Ps + model.Gamma_0 * specific_heat * warming * model.rhoS
    changed = density != model.rhoS
    inverse = 1.0 / where(changed, density / model.rhoS - 1.0, 1.0)
    rise = model.rhoS * model.C_0**2 * (inverse + 1.0 - 0.5 * model.Gamma_0)
    slope = inverse - (model.S_alpha - 1.0)
    return pressure + where(changed, rise / (slope * slope), 0.0)


@implements(stress_update, PAlpha)
@lanewise
def p_alpha_stress(
    model: PAlpha, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Pressure by the state of the pores, deviator by radial return."""
    J = determinant(point.deformation_gradient)
    density = material.density / J
    alpha = model.rhoS / density
    alpha_0 = model.rhoS / material.density
    old_least = state.least_alpha[p]
    least = min(alpha, old_least)
    state.alpha[p] = alpha
    state.least_alpha[p] = least
    rate = trace(point.velocity_gradient)

    pressure, heating = like(0.0, alpha), like(0.0, alpha)
    sound_speed = like(math.sqrt(model.Ks / model.rhoS), alpha)
    old_closing_temperature = state.closing_temperature[p]
    closing_temperature = old_closing_temperature
    porous = (alpha >= 1.0) & (alpha < alpha_0)
    if anywhere(porous):
        compaction = porous_pressure(model, material.density, alpha, old_least)
        pressure = where(porous, compaction.pressure, pressure)
        sound_speed = where(porous, compaction.sound_speed, sound_speed)
        dilatation = J / determinant(point.deformation_gradient_old) - 1.0
        crushing = -pressure * dilatation / (density * material.specific_heat * step.dt)
        heating = where(porous & compaction.crushing, crushing, heating)
        closing_temperature = where(porous, point.temperature, closing_temperature)
    closed = least < 1.0
    if anywhere(closed):
        warming = point.temperature - old_closing_temperature
        solid = solid_pressure(model, density, material.specific_heat, warming)
        pressure = where(closed, solid, pressure)
        heating -= where(closed, point.temperature * model.Gamma_0 * model.rhoS * rate / density, 0.0)
        closing_temperature = where(closed, old_closing_temperature, closing_temperature)
    state.closing_temperature[p] = closing_temperature
    tension_modulus = model.Ku if model.Ku > 0.0 else 0.1 * model.K0
    tension = tension_modulus * (1.0 - min(model.rhoS, model.rhoS / least) / density)
    pressure = where((alpha > alpha_0) | (pressure < 0.0), tension, pressure)
    shear = radial_return(state, p, point, model.shear_modulus, model.yield_stress, model.hardening_modulus)
    return StressUpdate(
        stress=shear.kirchhoff / J - isotropic(pressure),
        sound_speed=sound_speed,
        strain_energy=0.0,
        heating_rate=heating,
        artificial_pressure=artificial_viscosity(step, rate, sound_speed, density),
        localized=point.localized,
    )
