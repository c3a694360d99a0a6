"""Elastic-plastic material that swells by a diffusing substance."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import like
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    initial_sound_speed,
    initialize,
    stress_update,
)
from solver.materials.damage.no_damage import NoDamage
from solver.materials.deviatoric_stress.hypo_elastic import HypoElasticDeviator
from solver.materials.distribution.constant import Constant
from solver.materials.elastic_plastic import ElasticPlastic, elastic_plastic_stress, metal_faults
from solver.materials.equation_of_state.default_hyper import DefaultHyper
from solver.materials.failure import plastic_strain_rate
from solver.materials.melting.constant_melting import ConstantMelting
from solver.materials.metal_parameters import (
    BulkModulus,
    CheckStress,
    CriticalStress,
    DamageModel,
    DeviatoricStressModel,
    EquationOfState,
    FlowModel,
    MeltingTempModel,
    ModifiedEos,
    ReturnAlgorithm,
    ShearModulus,
    ShearModulusModel,
    SpecificHeatModel,
    StabilityCheck,
    ThermalExpansion,
    Tolerance,
    YieldCondition,
)
from solver.materials.return_algorithm.radial_return import RadialReturn
from solver.materials.shear_modulus.constant_shear import ConstantShear
from solver.materials.specific_heat.constant_specific_heat import ConstantSpecificHeat
from solver.materials.stability.no_check import NoCheck
from solver.materials.swelling import ConcentrationRate, Expansion, Swelling, without_swelling
from solver.materials.yield_condition.von_mises import VonMises
from solver.particles import Array, Particles, StateVariable
from solver.tensor import determinant

TEMPERATURE = 298.0
"""The temperature at which all properties are taken, K."""

_COLD = "all properties are those of 298 K, and nothing heats or melts"


class SwellingMetalState(NamedTuple):
    """What a particle remembers: the fields of an elastic-plastic metal, and the swelling."""

    rotation: Annotated[Array, StateVariable("p.rotation", "Matrix3", 1.0)]
    strain_rate: Annotated[Array, StateVariable("p.strainRate")]
    plastic_strain: Annotated[Array, StateVariable("p.plasticStrain")]
    plastic_strain_rate: Annotated[Array, StateVariable("p.plasticStrainRate")]
    porosity: Annotated[Array, StateVariable("p.porosity")]
    energy: Annotated[Array, StateVariable("p.energy")]
    alpha: Annotated[Array, StateVariable("p.alpha")]
    swelling: Swelling
    concentration_rate: ConcentrationRate


@model("constitutive_model", "rf_elastic_plastic")
class SwellingElasticPlastic(NamedTuple):
    """elastic_plastic at 298 K for what is left of the deformation without the swelling.

    F = exp(s) F_e with s' = volume_expansion_coeff c', a logarithmic strain in every direction, so that the
    volume grows by exp(3 s). c' is the rate of the concentration in the step before. Made for electrodes:
    Wang et al., Nano Letters 13 (2013). Unlike in Uintah the density of the equation of state does not
    contain the swelling either, so that a free body swells without stress whatever its equation of state.
    """

    bulk_modulus: BulkModulus
    shear_modulus: ShearModulus
    volume_expansion_coeff: Expansion
    flow_model: FlowModel
    yield_condition: YieldCondition = VonMises()
    equation_of_state: EquationOfState = DefaultHyper()
    shear_modulus_model: ShearModulusModel = ConstantShear()
    melting_temp_model: MeltingTempModel = ConstantMelting()
    specific_heat_model: SpecificHeatModel = ConstantSpecificHeat()
    deviatoric_stress_model: DeviatoricStressModel = HypoElasticDeviator()
    stability_check: StabilityCheck = NoCheck()
    damage_model: DamageModel = NoDamage()
    """Where older decks give it; today's give it beside the constitutive model."""
    plastic_convergence_algo: ReturnAlgorithm = RadialReturn()
    check_max_stress_failure: CheckStress = False
    critical_stress: CriticalStress = math.inf
    taylor_quinney_coeff: Annotated[
        float, Parameter("part of the plastic work that becomes heat", ge=0.0, le=1.0, ignored=_COLD)
    ] = 0.9
    isothermal: Annotated[bool, Parameter("leave out the material's own heating", ignored=_COLD)] = True
    do_melting: Annotated[bool, Parameter("let shear stress vanish above melting", ignored=_COLD)] = True
    evolve_porosity: Annotated[bool, Parameter("let voids grow", ignored="there are no voids")] = False
    evolve_damage: Annotated[
        bool, Parameter("let damage grow", ignored="it does where there is a damage_model")
    ] = True
    check_TEPLA_failure_criterion: Annotated[
        bool, Parameter("fail at the critical porosity", ignored="there are no voids")
    ] = False
    initial_material_temperature: Annotated[
        float, Parameter("temperature of the reference state", unit="K", ignored=_COLD)
    ] = 298.0
    tolerance: Tolerance = 1.0e-10
    coeff_thermal_expansion: ThermalExpansion = 0.0
    useModifiedEOS: ModifiedEos = False
    failure_is_checked: bool = False
    """Whether the material has an erosion algorithm, without which particles do not fail."""

    @property
    def adds_to_stress(self) -> bool:
        """The deviator of a step is added to that of the step before."""
        return True

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return SwellingMetalState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        found = metal_faults(self)
        if not isinstance(self.deviatoric_stress_model, HypoElasticDeviator):
            found.append(("deviatoric_stress_model", "a swelling material takes hypoElastic only"))
        return found


@implements(plastic_strain_rate, SwellingElasticPlastic)
@lanewise
def _(model: SwellingElasticPlastic, state: Any, p: int) -> float:
    return state.plastic_strain_rate[p]


@initial_sound_speed.register
def _(model: SwellingElasticPlastic, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.bulk_modulus + 4.0 * model.shear_modulus / 3.0) / density)


@initialize.register
def _(
    model: SwellingElasticPlastic, state: Any, particles: Particles, material: Material, patch: Any
) -> None:
    left, _, right = np.linalg.svd(particles.deformation_gradient)
    state.rotation[:] = left @ right


@inline
def at_temperature(point: Point, temperature: float) -> Point:
    """The particle at another temperature."""
    temperature = like(temperature, point.temperature)
    return Point(
        point.stress,
        point.deformation_gradient_old,
        point.deformation_gradient,
        point.velocity_gradient,
        point.volume_old,
        point.volume,
        point.mass,
        temperature,
        temperature,
        point.localized,
    )


@implements(stress_update, SwellingElasticPlastic)
@lanewise
def swelling_metal_stress(
    model: SwellingElasticPlastic, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The stress of an elastic-plastic metal without heat and voids, for the rest of the deformation."""
    metal = ElasticPlastic(
        bulk_modulus=model.bulk_modulus,
        shear_modulus=model.shear_modulus,
        flow_model=model.flow_model,
        yield_condition=model.yield_condition,
        equation_of_state=model.equation_of_state,
        shear_modulus_model=model.shear_modulus_model,
        melting_temp_model=model.melting_temp_model,
        specific_heat_model=model.specific_heat_model,
        deviatoric_stress_model=model.deviatoric_stress_model,
        stability_check=model.stability_check,
        damage_model=model.damage_model,
        plastic_convergence_algo=model.plastic_convergence_algo,
        taylor_quinney_coeff=0.0,
        isothermal=True,
        compute_specific_heat=False,
        do_melting=False,
        evolve_porosity=False,
        initial_mean_porosity=0.0,
        initial_std_porosity=0.0,
        initial_porosity_distrib=Constant(),
        critical_porosity=1.0,
        frac_nucleation=0.0,
        meanstrain_nucleation=0.0,
        stddevstrain_nucleation=1.0,
        check_TEPLA_failure_criterion=False,
        TEPLA_with_damage=False,
        check_max_stress_failure=model.check_max_stress_failure,
        critical_stress=model.critical_stress,
        tolerance=model.tolerance,
        initial_material_temperature=TEMPERATURE,
        coeff_thermal_expansion=0.0,
        useModifiedEOS=False,
        evolve_damage=True,
        failure_is_checked=model.failure_is_checked,
    )
    before = state.swelling[p]
    after = before + model.volume_expansion_coeff * state.concentration_rate[p] * step.dt
    state.swelling[p] = after
    rest = at_temperature(without_swelling(point, before, after, step.dt), TEMPERATURE)
    new = elastic_plastic_stress(metal, state, p, rest, material, step)
    # waves run through the body as it is, swelling included
    swollen = determinant(point.deformation_gradient) / determinant(rest.deformation_gradient)
    return StressUpdate(
        new.stress,
        new.sound_speed * math.sqrt(swollen),
        new.strain_energy,
        new.heating_rate,
        new.artificial_pressure,
        new.localized,
    )
