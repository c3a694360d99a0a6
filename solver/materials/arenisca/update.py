"""The stress update of the Arenisca models: frames, rate dependence, and what else a particle reports."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from solver.dispatch import generic, inline
from solver.materials.arenisca.elasticity import Moduli, Pores, moduli, pores_of, stiffest
from solver.materials.arenisca.hardening import cap_position, pore_pressure
from solver.materials.arenisca.step import RockState, elastic_stress, strain_step
from solver.materials.constitutive import (
    DELETE,
    Material,
    Point,
    Step,
    StressUpdate,
    artificial_viscosity,
)
from solver.particles import Particles
from solver.random import by_patch, size_effect, weibull, weibull_law
from solver.tensor import (
    Tensor,
    determinant,
    double_dot,
    isotropic,
    norm,
    put_tensor,
    rotation,
    symmetric,
    tensor_at,
    trace,
)

SLOWEST_RATE = 1.0e-15
"""Strain rate below which the relaxation time grows no more, 1/s."""


class Bounds(NamedTuple):
    """Deformation gradients with a component or a determinant beyond these remove their particle."""

    component: float
    least_determinant: float
    largest_determinant: float


@generic
def bounds_after(model: Any) -> Bounds:  # type: ignore[empty-body]  # bodies come from the models
    """The bounds of the deformation gradient at the end of the step."""


class Frame(NamedTuple):
    """The rotation of a deformation gradient, or no rotation where it is out of bounds."""

    rotation: Tensor
    out_of_bounds: bool


@inline
def bounds_before() -> Bounds:
    """The bounds of the deformation gradient at the start of the step."""
    return Bounds(1.0e2, 1.0e-3, 1.0e5)


@inline
def largest_component(a: Tensor) -> float:
    """The largest magnitude of a component."""
    first = max(abs(a.xx), abs(a.xy), abs(a.xz))
    second = max(abs(a.yx), abs(a.yy), abs(a.yz))
    return max(first, second, abs(a.zx), abs(a.zy), abs(a.zz))


@inline
def frame(F: Tensor, bounds: Bounds) -> Frame:
    """The frame of the material; without bounds on F its polar decomposition would not converge."""
    J = determinant(F)
    within = largest_component(F) <= bounds.component
    if not (within and bounds.least_determinant <= J <= bounds.largest_determinant):
        return Frame(isotropic(1.0), True)
    return Frame(rotation(F), False)


@inline
def turn(R: Tensor, a: Tensor) -> Tensor:
    """R a R^T."""
    return (R @ a) @ R.T


@inline
def rate_dependent_stress(
    model: Any,
    pores: Pores,
    crush_limit: float,
    old_stress: Tensor,
    old: RockState,
    new: RockState,
    rate: Tensor,
    dt: float,
) -> Tensor:
    """Duvaut and Lions: the overstress relaxes over the time T1 / rate^T2 (Brannon 2007, Eqs. 6.92, 6.93).

    The trial stress has the mean of the moduli at both ends of the step.
    """
    if model.T1_rate_dependence == 0.0 or model.T2_rate_dependence == 0.0:
        return new.stress
    before = moduli(model, pores, trace(old.stress), trace(old.plastic_strain), crush_limit)
    after = moduli(model, pores, trace(new.stress), trace(new.plastic_strain), crush_limit)
    mean = Moduli(0.5 * (before.bulk + after.bulk), 0.5 * (before.shear + after.shear))
    trial = elastic_stress(old_stress, rate * dt, mean)
    speed = max(norm(rate), SLOWEST_RATE)
    elapsed = dt / (model.T1_rate_dependence * (1.0 / speed) ** model.T2_rate_dependence)
    kept = math.exp(-elapsed)
    added = (1.0 - kept) / elapsed
    overstress = ((trial - old_stress) - (new.stress - old.stress)) * added
    return new.stress + overstress + (old_stress - old.stress) * kept


@inline
def cap_model_stress(
    model: Any, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The update of a particle. Its stress turns with R of F = R U, in whose frame it is integrated.

    Where sub-steps fail the particle is removed. The strain energy is the work in the laboratory frame
    (Uintah contracts the stress there with the strain rate of the turned frame).
    """
    pores = pores_of(model)
    start = frame(point.deformation_gradient_old, bounds_before())
    end = frame(point.deformation_gradient, bounds_after(model))
    d = symmetric(point.velocity_gradient)
    R = start.rotation.T
    rate, old_stress = turn(R, d), turn(R, point.stress)
    old_static = turn(R, tensor_at(state.static_stress, p))
    crush_limit = state.crush_limit[p]
    coherence = state.peak_i1[p] / model.PEAKI1 if model.PEAKI1 > 0.0 else 1.0
    old = RockState(old_static, tensor_at(state.plastic_strain, p), state.cap[p], state.zeta[p], False)
    new = strain_step(model, pores, coherence, crush_limit, old, rate * step.dt)
    dynamic = rate_dependent_stress(model, pores, crush_limit, old_stress, old, new, rate, step.dt)
    stress = turn(end.rotation, dynamic)
    remember(model, pores, state, p, new, end.rotation, point)
    stiffness = stiffest(model)
    if model.Use_Disaggregation_Algorithm:
        stiffness = moduli(model, pores, trace(new.stress), trace(new.plastic_strain), crush_limit)
    density = point.mass / point.volume
    removed = new.failed or start.out_of_bounds or end.out_of_bounds
    return StressUpdate(
        stress=stress,
        sound_speed=math.sqrt((stiffness.bulk + 4.0 / 3.0 * stiffness.shear) / density),
        strain_energy=double_dot(d, 0.5 * (stress + point.stress)) * point.volume * step.dt,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(
            step, trace(rate), math.sqrt(stiffness.bulk / density), density
        ),
        localized=DELETE if removed else point.localized,
    )


@inline
def remember(model: Any, pores: Pores, state: Any, p: int, new: RockState, R: Tensor, point: Point) -> None:
    """Store what the particle remembers."""
    volume_strain = trace(new.plastic_strain)
    total = math.log(max(determinant(point.deformation_gradient), 1.0e-300))
    put_tensor(state.static_stress, p, turn(R, new.stress))
    put_tensor(state.plastic_strain, p, new.plastic_strain)
    state.cap[p] = new.cap
    state.zeta[p] = new.zeta
    state.plastic_volume_strain[p] = volume_strain
    state.elastic_volume_strain[p] = total - volume_strain
    state.pore_pressure[p] = pore_pressure(model, pores, total)


def start_state(model: Any, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    """The state of undeformed particles, under the pressure of their pore fluid."""
    pressure = model.fluid_pressure_initial
    particles.stress[...] = -pressure * np.eye(3)
    state.static_stress[...] = particles.stress
    state.pore_pressure[...] = pressure
    state.zeta[...] = -3.0 * pressure
    state.crush_limit[...] = model.p3_crush_curve
    if model.Use_Disaggregation_Algorithm:
        state.crush_limit[...] = np.log(particles.volume * material.density / particles.mass)
    pores = pores_of(model)
    limits, which = np.unique(state.crush_limit, return_inverse=True)
    state.cap[...] = np.array([cap_position(model, pores, 0.0, float(p3)) for p3 in limits])[which]
    state.peak_i1[...] = peaks(model, particles, patch)


def peaks(model: Any, particles: Particles, patch: Any) -> Any:
    """PEAKI1 of each particle, (n,), or one number for all."""
    law = weibull_law(model.PEAKI1IDIST)
    if law is None:
        return model.PEAKI1
    if law.seed == 0:
        return size_effect(particles.volume, law.volume, law.modulus) * law.mean
    draws = by_patch(patch, law.seed)[:, 0]
    return weibull(draws, law.mean, law.modulus, particles.volume, law.volume, law.modulus)
