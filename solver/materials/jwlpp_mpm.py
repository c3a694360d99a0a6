"""JWL++: a high explosive that burns at a rate set by its pressure."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, negation, where
from solver.materials.constitutive import (
    DELETE,
    Material,
    Point,
    Step,
    StressUpdate,
    artificial_viscosity,
    initial_sound_speed,
    initialize,
    stress_update,
)
from solver.materials.rigid import NO_WAVES
from solver.particles import Array, Particles, StateVariable
from solver.tensor import determinant, isotropic, trace

_SERIES = "deformation gradients follow the time integration of the run"


class BurnState(NamedTuple):
    """Progress of the burn, (n,)."""

    burned: Annotated[Array, StateVariable("p.progressF")]
    burned_in_step: Annotated[Array, StateVariable("p.progressdelF")]


@model("constitutive_model", "jwlpp_mpm")
class JWLppMPM(NamedTuple):
    """JWL++ of Souers, Anderson, Mercer, McGuire and Vitello (Propellants Explos. Pyrotech. 25, 2000).

    p = (1 - f) p_u + f p_b with the burned fraction f, Murnaghan's p_u = (J^-n - 1) / (n K) of the explosive
    and p_b = A exp(-R1 J) + B exp(-R2 J) + C J^-(1 + om) of its products. Above the ignition pressure
    f' = G (1 - f) p^b, by backward Euler in steps of at most max_burn_timestep_size over which J changes
    geometrically. The material bears no shear; its energy is not counted, as in Uintah.
    """

    ignition_pressure: Annotated[float, Parameter("pressure above which it burns", unit="Pa", gt=0.0)]
    murnaghan_K: Annotated[
        float, Parameter("compressibility of the explosive, 1/bulk modulus", unit="1/Pa", gt=0.0)
    ]
    murnaghan_n: Annotated[float, Parameter("pressure derivative of its bulk modulus", gt=0.0)]
    jwl_A: Annotated[float, Parameter("JWL constant A of the products", unit="Pa")]
    jwl_B: Annotated[float, Parameter("JWL constant B", unit="Pa")]
    jwl_C: Annotated[float, Parameter("JWL constant C", unit="Pa")]
    jwl_R1: Annotated[float, Parameter("JWL constant R1")]
    jwl_R2: Annotated[float, Parameter("JWL constant R2")]
    jwl_om: Annotated[float, Parameter("JWL constant omega, the Grueneisen parameter of the products")]
    reaction_G: Annotated[float, Parameter("rate constant G", unit="1/(s Pa^b)", ge=0.0)]
    reaction_b: Annotated[float, Parameter("exponent b of pressure in the rate")]
    max_burn_timestep_size: Annotated[float, Parameter("longest step of the burn", unit="s", gt=0.0)] = (
        1.0e-12
    )
    max_burned_fraction: Annotated[float, Parameter("fraction at which the burn ends", gt=0.0, le=1.0)] = 1.0
    useInitialStress: Annotated[bool, Parameter("whether particles start under initial_pressure")] = False
    initial_pressure: Annotated[float, Parameter("pressure at the start", unit="Pa")] = 0.0
    doFastStressCompute: Annotated[
        bool, Parameter("take the rate at the old pressure of each burn step instead of solving for the new")
    ] = False
    tolerance_for_Newton_iterations: Annotated[
        float, Parameter("residual (of fraction and pressure together) at which iterations end", gt=0.0)
    ] = 1.0e-3
    max_number_of_Newton_iterations: Annotated[int, Parameter("most iterations of a burn step", ge=1)] = 20
    useTaylorSeriesForDefGrad: Annotated[
        bool, Parameter("exponential series for the deformation gradient", ignored=_SERIES)
    ] = False
    num_taylor_terms: Annotated[int, Parameter("terms of that series", ignored=_SERIES)] = 10

    jwl_rho0: Annotated[
        float, Parameter("density", unit="kg/m^3", ignored="the density of the material is taken")
    ] = 0.0

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return BurnState


@initial_sound_speed.register
def _(model: JWLppMPM, density: Any, temperature: Any) -> Any:
    return np.sqrt(1.0 / (model.murnaghan_K * density))


@initialize.register
def _(model: JWLppMPM, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    """Compress the explosive to the initial pressure, J = (1 + n K p)^(-1/n)."""
    if model.useInitialStress:
        p, n = model.initial_pressure, model.murnaghan_n
        stretch = (1.0 + n * model.murnaghan_K * p) ** (-1.0 / (3.0 * n))
        particles.deformation_gradient[...] = np.eye(3) * stretch
        particles.stress[...] = np.eye(3) * -p


@inline
def explosive_pressure(model: JWLppMPM, J: float) -> float:
    """Murnaghan's equation of state of the explosive."""
    return (J**-model.murnaghan_n - 1.0) / (model.murnaghan_n * model.murnaghan_K)


@inline
def products_pressure(model: JWLppMPM, J: float) -> float:
    """The JWL equation of state of the products along their isentrope."""
    return (
        model.jwl_A * math.exp(-model.jwl_R1 * J)
        + model.jwl_B * math.exp(-model.jwl_R2 * J)
        + model.jwl_C * J ** -(1.0 + model.jwl_om)
    )


class Burn(NamedTuple):
    """Burned fraction and pressure."""

    fraction: float
    pressure: float


@inline
def explicit_burn(model: JWLppMPM, old: Burn, p_u: float, p_b: float, dt: float) -> Burn:
    """Backward Euler for the fraction at the old pressure, then the pressure of the mixture."""
    growth = dt * model.reaction_G * old.pressure**model.reaction_b
    f = min((old.fraction + growth) / (1.0 + growth), model.max_burned_fraction)
    return Burn(f, p_u * (1.0 - f) + p_b * f)


@inline
def implicit_burn(model: JWLppMPM, burns: bool, old: Burn, p_u: float, p_b: float, dt: float) -> Burn:
    """Backward Euler for fraction and pressure together where it burns, by at least one iteration.

    The iteration is Uintah's, whose sign of the rate's derivative by pressure is opposite to Newton's; it
    converges to the same solution, though only linearly.
    """
    f, p = old.fraction, old.pressure
    goes_on = burns
    for _ in range(model.max_number_of_Newton_iterations):
        growth = model.reaction_G * p**model.reaction_b * dt
        fraction_residual = f - old.fraction - (1.0 - f) * growth
        pressure_residual = p - (1.0 - f) * p_u - f * p_b
        by_fraction = 1.0 + growth
        by_pressure = model.reaction_b * (1.0 - f) * growth / p
        scale = 1.0 / (by_fraction - by_pressure * (p_u - p_b))
        df = scale * (fraction_residual - by_pressure * pressure_residual)
        dp = scale * (by_fraction * pressure_residual - (p_u - p_b) * fraction_residual)
        f, p = where(goes_on, f - df, f), where(goes_on, p - dp, p)
        fraction_residual = f - old.fraction - (1.0 - f) * model.reaction_G * p**model.reaction_b * dt
        pressure_residual = p - (1.0 - f) * p_u - f * p_b
        residual = math.sqrt(fraction_residual * fraction_residual + pressure_residual * pressure_residual)
        goes_on = goes_on & negation(residual <= model.tolerance_for_Newton_iterations)
        if not anywhere(goes_on):
            break
    return Burn(f, p)


@inline
def burn(model: JWLppMPM, old: Burn, J_old: float, J: float, dt: float) -> Burn:
    """Fraction and pressure at the end of the step."""
    p_u, p_b = explosive_pressure(model, J), products_pressure(model, J)
    limit = model.max_burned_fraction
    unlit = Burn(old.fraction, p_u * (1.0 - old.fraction) + p_b * old.fraction)
    burns = (old.pressure > model.ignition_pressure) & (old.fraction < limit)
    if not anywhere(burns):
        return unlit
    cycles = max(1, math.ceil(dt / model.max_burn_timestep_size))
    compression = (J / J_old) ** (1.0 / cycles)
    new = old
    J_cycle = J_old
    for _ in range(cycles):
        J_cycle *= compression
        p_u_cycle, p_b_cycle = explosive_pressure(model, J_cycle), products_pressure(model, J_cycle)
        if model.doFastStressCompute:
            new = explicit_burn(model, new, p_u_cycle, p_b_cycle, dt / cycles)
        else:
            new = implicit_burn(model, burns, new, p_u_cycle, p_b_cycle, dt / cycles)
    new = where(new.fraction > limit, Burn(limit, p_u * (1.0 - limit) + p_b * limit), new)
    return where(burns, new, unlit)


@implements(stress_update, JWLppMPM)
@lanewise
def jwlpp_stress(
    model: JWLppMPM, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Burn, then the pressure of the mixture; the sound speed is that of the explosive.

    Failed particles keep their stress, inverted ones are taken out.
    """
    J = determinant(point.deformation_gradient)
    sound, possible = point.localized == 0, J > 0.0
    bears = sound & possible
    J = where(possible, J, 1.0)
    density = material.density / J
    old = Burn(state.burned[p], -trace(point.stress) / 3.0)
    new = burn(model, old, determinant(point.deformation_gradient_old), J, step.dt)
    state.burned_in_step[p] = where(bears, new.fraction - old.fraction, state.burned_in_step[p])
    state.burned[p] = where(bears, new.fraction, old.fraction)
    sound_speed = math.sqrt(J ** (1.0 - model.murnaghan_n) / (model.murnaghan_K * material.density))
    bulk_speed = math.sqrt(1.0 / (model.murnaghan_K * density))
    viscous_pressure = artificial_viscosity(step, trace(point.velocity_gradient), bulk_speed, density)
    return StressUpdate(
        stress=where(sound, isotropic(where(possible, -new.pressure, 0.0)), point.stress),
        sound_speed=where(bears, sound_speed, NO_WAVES),
        strain_energy=0.0,
        heating_rate=0.0,
        artificial_pressure=where(bears, viscous_pressure, 0.0),
        localized=where(sound & negation(possible), DELETE, point.localized),
    )
