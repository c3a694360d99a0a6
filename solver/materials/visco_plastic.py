"""Solids that creep: hypoelasticity with viscoplastic flow and failure by a largest stress or strain."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, SubModel, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, like, negation, where
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    initial_sound_speed,
    initialize,
    stress_update,
)
from solver.materials.distribution import draw
from solver.materials.distribution.constant import Constant
from solver.materials.distribution.gauss import Gauss
from solver.materials.equation_of_state import mean_stress
from solver.materials.equation_of_state.default_hyper import DefaultHyper
from solver.materials.melting.constant_melting import ConstantMelting
from solver.materials.plasticity_state import PlasticityState
from solver.materials.shear_modulus.constant_shear import ConstantShear
from solver.materials.stability.no_check import NoCheck
from solver.materials.viscoplastic_flow import (
    Elasticity,
    Hardening,
    flow,
    initial_hardening,
    overstress,
    stiffness_of,
)
from solver.materials.viscoplastic_flow.suvic_i import SuvicI
from solver.particles import Array, Particles, StateVariable
from solver.tensor import (
    Tensor,
    determinant,
    deviator,
    double_dot,
    inverse,
    isotropic,
    principal_values,
    put_tensor,
    symmetric,
    tensor_at,
    trace,
)

TAYLOR_QUINNEY = 0.9
"""Part of the inelastic work that becomes heat."""

_NO_OTHER = "suvic_i has constant moduli and does not melt"


class ViscoPlasticState(NamedTuple):
    """What a particle remembers, (n,) or (n, 3, 3)."""

    strain_rate: Annotated[Array, StateVariable("p.strainRate")]
    plastic_strain: Annotated[Array, StateVariable("p.plasticStrain")]
    failed: Annotated[Array, StateVariable("p.localized", "int")]
    strength: Annotated[Array, StateVariable("p.varf")]
    """The largest principal stress or strain, or mean stress, that the particle bears."""
    plastic_temperature: Annotated[Array, StateVariable("p.plasticTemp")]
    """Where inelastic work alone would have brought the temperature."""
    heating: Annotated[Array, StateVariable("p.plasticTempInc")]
    yield_stress: Annotated[Array, StateVariable("p.yield")]
    drag_stress: Annotated[Array, StateVariable("p.drag")]
    back_stress: Annotated[Array, StateVariable("p.backstress", "Matrix3")]


@model("constitutive_model", "visco_plastic")
class ViscoPlastic(NamedTuple):
    """sigma' = C:(d - alpha T' I - d_p) with the rate d_p of a viscoplastic flow.

    While the stress does not flow its mean follows the equation of state. Of the inelastic work 90 % heats
    the particle. As in Uintah, where the deformation gradient of the update stays the identity, stress does
    not turn with the body; the equation of state and failure by strain here see the true one.
    """

    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", gt=0.0)]
    visco_plasticity_model: Annotated[Any, SubModel("viscoplastic_flow")] = SuvicI()
    equation_of_state: Annotated[Any, SubModel("equation_of_state")] = DefaultHyper()
    coeff_thermal_expansion: Annotated[float, Parameter("linear thermal expansion", unit="1/K")] = 1.0e-5
    check_failure: Annotated[bool, Parameter("whether flowing particles fail at their strength")] = False
    failure_by_stress: Annotated[
        bool, Parameter("whether strength is a largest principal stress, not an Almansi strain")
    ] = True
    failure_by_pressure: Annotated[bool, Parameter("whether strength is a mean stress")] = False
    failure_variable_mean: Annotated[float, Parameter("mean strength")] = 1.0e30
    failure_variable_std: Annotated[float, Parameter("standard deviation of the strength", ge=0.0)] = 0.0
    failure_variable_distrib: Annotated[str, Parameter("'constant' or 'gauss'")] = "constant"
    zero_stress_upon_failure: Annotated[bool, Parameter("whether failure takes all stress")] = True
    allow_no_tension: Annotated[
        bool, Parameter("whether failure, where it does not take all stress, leaves pressure alone")
    ] = False
    tolerance: Annotated[
        float, Parameter("components of the rate of deformation below it are none", unit="1/s", ge=0.0)
    ] = 1.0e-10
    initial_material_temperature: Annotated[
        float, Parameter("start of the reported plastic temperature", unit="K")
    ] = 269.15
    remove_particles: Annotated[
        bool, Parameter("whether to remove failed particles", ignored="Uintah removes none")
    ] = False
    useModifiedEOS: Annotated[
        bool,
        Parameter(
            "another law of expansion, beside a gas", ignored="only the coupled gas-solid method has it"
        ),
    ] = False
    use_polar_decomposition_RMB: Annotated[
        bool, Parameter("how rotations are found", ignored="stress does not turn")
    ] = True
    stability_check: Annotated[
        Any, SubModel("stability"), Parameter("loss of stability", ignored="Uintah reads and never uses it")
    ] = NoCheck()
    shear_modulus_model: Annotated[
        Any, SubModel("shear_modulus"), Parameter("shear modulus", ignored=_NO_OTHER)
    ] = ConstantShear()
    melting_temp_model: Annotated[
        Any, SubModel("melting"), Parameter("melting temperature", ignored=_NO_OTHER)
    ] = ConstantMelting()

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return ViscoPlasticState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        if distribution_name(self) not in ("constant", "gauss"):
            return [("failure_variable_distrib", "it is 'constant' or 'gauss'")]
        return []


def distribution_name(model: ViscoPlastic) -> str:
    """The distribution of strength without the quotes that decks put around it."""
    return model.failure_variable_distrib.strip(" \"'")


@initial_sound_speed.register
def _(model: ViscoPlastic, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.bulk_modulus + 4.0 * model.shear_modulus / 3.0) / density)


@initialize.register
def _(model: ViscoPlastic, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    spread = Gauss() if distribution_name(model) == "gauss" else Constant()
    state.strength[:] = draw(spread, model.failure_variable_mean, model.failure_variable_std, patch)
    state.plastic_temperature[:] = model.initial_material_temperature
    start = initial_hardening(model.visco_plasticity_model)
    state.yield_stress[:] = start.yield_stress
    state.drag_stress[:] = start.drag_stress


@inline
def without_noise(a: Tensor, tolerance: float) -> Tensor:
    """A tensor whose components below a tolerance are zero."""
    return Tensor(
        where(abs(a.xx) >= tolerance, a.xx, 0.0),
        where(abs(a.xy) >= tolerance, a.xy, 0.0),
        where(abs(a.xz) >= tolerance, a.xz, 0.0),
        where(abs(a.yx) >= tolerance, a.yx, 0.0),
        where(abs(a.yy) >= tolerance, a.yy, 0.0),
        where(abs(a.yz) >= tolerance, a.yz, 0.0),
        where(abs(a.zx) >= tolerance, a.zx, 0.0),
        where(abs(a.zy) >= tolerance, a.zy, 0.0),
        where(abs(a.zz) >= tolerance, a.zz, 0.0),
    )


@inline
def load_on(model: ViscoPlastic, stress: Tensor, F: Tensor) -> float:
    """What is compared with the strength."""
    if model.failure_by_pressure:
        return trace(stress) / 3.0
    if model.failure_by_stress:
        return principal_values(stress).first
    return principal_values(0.5 * (isotropic(1.0) - inverse(F @ F.T))).first


@inline
def failed_stress(model: ViscoPlastic, stress: Tensor) -> Tensor:
    """The stress that failure leaves."""
    if model.zero_stress_upon_failure:
        return isotropic(like(0.0, stress.xx))
    if model.allow_no_tension:
        return isotropic(min(trace(stress) / 3.0, 0.0))
    return stress


@inline
def plasticity_state(
    model: ViscoPlastic, state: Any, p: int, point: Point, material: Material, density: float
) -> PlasticityState:
    """What the equation of state knows of the particle; it has no internal energy."""
    return PlasticityState(
        state.plastic_strain[p],
        0.0,
        state.strain_rate[p],
        point.temperature,
        trace(point.stress) / 3.0,
        density,
        material.density,
        0.0,
        model.bulk_modulus,
        model.shear_modulus,
        material.melt_temperature,
        material.specific_heat,
    )


@implements(stress_update, ViscoPlastic)
@lanewise
def visco_plastic_stress(
    model: ViscoPlastic, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Elastic or flowing step; failed particles and those at rest keep their stress."""
    d = without_noise(symmetric(point.velocity_gradient), model.tolerance)
    moves = (state.failed[p] != 1) & (double_dot(d, d) != 0.0)
    density = material.density / determinant(point.deformation_gradient)
    warming = (point.temperature - point.previous_temperature) / step.dt
    rate = d - isotropic(model.coeff_thermal_expansion * warming)
    state.strain_rate[p] = where(moves, math.sqrt(double_dot(rate, rate) / 1.5), 0.0)
    before = plasticity_state(model, state, p, point, material, density)
    mean = mean_stress(model.equation_of_state, before, trace(rate) * step.dt)
    elastic = (
        deviator(point.stress) + (2.0 * model.shear_modulus * step.dt) * deviator(rate) + isotropic(mean)
    )
    stress, heating = where(moves, elastic, point.stress), like(0.0, mean)
    hardening = Hardening(state.yield_stress[p], state.drag_stress[p], tensor_at(state.back_stress, p))
    flows = moves & (overstress(model.visco_plasticity_model, hardening, point.stress) > 0.0)
    if anywhere(flows):
        flowed = flowing_stress(model, state, p, flows, point, hardening, rate, step.dt)
        stress = where(flows, flowed.stress, stress)
        heating = where(flows, flowed.heat / (density * material.specific_heat), heating)
    state.heating[p] = heating * step.dt
    state.plastic_temperature[p] += heating * step.dt
    energy = double_dot(rate, 0.5 * (stress + point.stress)) * point.volume * step.dt
    sound_speed = math.sqrt((model.bulk_modulus + 4.0 * model.shear_modulus / 3.0) / density)
    return StressUpdate(
        stress=stress,
        sound_speed=where(moves, sound_speed, 0.0),
        strain_energy=where(moves & (state.failed[p] == 0), energy, 0.0),
        heating_rate=heating,
        artificial_pressure=0.0,
        localized=point.localized,
    )


class Flowed(NamedTuple):
    """A step of flow."""

    stress: Tensor
    heat: float
    """From inelastic work, W/m^3."""


@inline
def flowing_stress(
    model: ViscoPlastic,
    state: Any,
    p: int,
    flows: bool,
    point: Point,
    hardening: Hardening,
    rate: Tensor,
    dt: float,
) -> Flowed:
    """Stress after a step, where it ``flows``; a particle that fails in it keeps the hardening of its start."""
    elasticity = Elasticity(model.bulk_modulus, model.shear_modulus)
    found = flow(model.visco_plasticity_model, hardening, point.stress, rate, elasticity, dt)
    stress = point.stress + stiffness_of(elasticity, rate - found.rate * found.direction) * dt
    s = deviator(stress)
    state.plastic_strain[p] += where(flows, found.rate * dt, 0.0)
    heat = TAYLOR_QUINNEY * math.sqrt(1.5 * double_dot(s, s)) * found.rate
    hardens = flows
    if model.check_failure:
        breaks = load_on(model, stress, point.deformation_gradient) > state.strength[p]
        state.failed[p] = where(flows & breaks, 1, state.failed[p])
        stress = where(breaks, failed_stress(model, stress), stress)
        hardens = flows & negation(breaks)
    new = where(hardens, found.hardening, hardening)
    state.yield_stress[p] = new.yield_stress
    state.drag_stress[p] = new.drag_stress
    put_tensor(state.back_stress, p, new.back_stress)
    return Flowed(stress, heat)
