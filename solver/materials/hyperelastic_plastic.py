"""Hyperelastic-plastic metals: an elastic stretch that is stored, and the parts of elastic_plastic."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import where
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
from solver.materials.distribution import draw
from solver.materials.distribution.constant import Constant
from solver.materials.elastic_plastic import (
    Kinematics,
    breaks,
    deviatoric_flow,
    fails,
    grown_porosity,
    heating,
    internal_work,
    metal_faults,
    plasticity_state,
    possible_ratio,
    without_impossible,
)
from solver.materials.equation_of_state import mean_stress
from solver.materials.equation_of_state.default_hyper import DefaultHyper
from solver.materials.failure import fractures, plastic_strain_rate
from solver.materials.melting.constant_melting import ConstantMelting
from solver.materials.metal_parameters import (
    BreakByStrain,
    BulkModulus,
    CheckPorosity,
    CheckStress,
    ComputeSpecificHeat,
    CriticalPorosity,
    CriticalStress,
    DoMelting,
    EquationOfState,
    EvolvePorosity,
    FlowModel,
    Isothermal,
    MeanPorosity,
    MeltingTempModel,
    NucleatedFraction,
    NucleationSpread,
    NucleationStrain,
    PorosityDistribution,
    PorositySpread,
    ReturnAlgorithm,
    ShearModulus,
    ShearModulusModel,
    SpecificHeatModel,
    StabilityCheck,
    TaylorQuinney,
    YieldCondition,
)
from solver.materials.return_algorithm.radial_return import RadialReturn
from solver.materials.shear_modulus.constant_shear import ConstantShear
from solver.materials.specific_heat.constant_specific_heat import ConstantSpecificHeat
from solver.materials.stability.no_check import NoCheck
from solver.materials.yield_condition.von_mises import VonMises
from solver.particles import Array, Particles, StateVariable
from solver.tensor import (
    Tensor,
    determinant,
    deviator,
    inverse,
    isotropic,
    put_tensor,
    symmetric,
    tensor_at,
    trace,
)


class HyperElasticPlasticState(NamedTuple):
    """What a hyperelastic-plastic particle remembers, each (n,) or (n, 3, 3)."""

    elastic_stretch: Annotated[Array, StateVariable("p.bElBar", "Matrix3", 1.0)]
    """Isochoric elastic left Cauchy-Green tensor."""
    strain_rate: Annotated[Array, StateVariable("p.strainRate")]
    plastic_strain: Annotated[Array, StateVariable("p.plasticStrain")]
    plastic_strain_rate: Annotated[Array, StateVariable("p.plasticStrainRate")]
    porosity: Annotated[Array, StateVariable("p.porosity")]
    energy: Annotated[Array, StateVariable("p.energy")]
    """Specific internal energy, J/kg."""


@model("constitutive_model", "hyperelastic_plastic")
class HyperElasticPlastic(NamedTuple):
    """Hyperelastic-plastic metal with the exchangeable parts of elastic_plastic (Banerjee 2012, section 3).

    F is split into an elastic and an isochoric plastic part. The isochoric elastic left Cauchy-Green tensor is
    carried along by the isochoric deformation f' of a step, b = f' b_old f'^T, with the true stress
    s = mu / J dev b. Beyond the yield surface s returns along itself with the stiffness mu tr b / (3 J), and
    b keeps its trace (Simo and Hughes 1998, Box 9.1, there for the stress J s). The mean stress follows from
    an equation of state. Unlike elastic_plastic the material gives back all elastic work of a cycle of any
    strain, and its elastic stress is objective in steps of any size. Uintah once had such a material, and no
    longer does.
    """

    bulk_modulus: BulkModulus
    shear_modulus: ShearModulus
    flow_model: FlowModel
    yield_condition: YieldCondition = VonMises()
    equation_of_state: EquationOfState = DefaultHyper()
    shear_modulus_model: ShearModulusModel = ConstantShear()
    melting_temp_model: MeltingTempModel = ConstantMelting()
    specific_heat_model: SpecificHeatModel = ConstantSpecificHeat()
    stability_check: StabilityCheck = NoCheck()
    plastic_convergence_algo: ReturnAlgorithm = RadialReturn()
    taylor_quinney_coeff: TaylorQuinney = 0.9
    isothermal: Isothermal = False
    compute_specific_heat: ComputeSpecificHeat = False
    do_melting: DoMelting = True
    evolve_porosity: EvolvePorosity = True
    initial_mean_porosity: MeanPorosity = 0.002
    initial_std_porosity: PorositySpread = 0.002
    initial_porosity_distrib: PorosityDistribution = Constant()
    critical_porosity: CriticalPorosity = 0.5
    frac_nucleation: NucleatedFraction = 0.1
    meanstrain_nucleation: NucleationStrain = 0.3
    stddevstrain_nucleation: NucleationSpread = 0.1
    check_TEPLA_failure_criterion: CheckPorosity = True
    TEPLA_with_damage: BreakByStrain = False
    check_max_stress_failure: CheckStress = False
    critical_stress: CriticalStress = math.inf
    failure_is_checked: bool = False
    """Whether the material has an erosion algorithm, without which particles do not fail."""

    @property
    def State(self) -> type:  # noqa: N802 - the class attribute of other models
        """The arrays of a particle set."""
        return HyperElasticPlasticState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        return metal_faults(self)


@implements(plastic_strain_rate, HyperElasticPlastic)
@lanewise
def _(model: HyperElasticPlastic, state: Any, p: int) -> float:
    return state.plastic_strain_rate[p]


@implements(fractures, HyperElasticPlastic)
@lanewise
def _(model: HyperElasticPlastic, state: Any, p: int, damage: float) -> bool:
    return breaks(model, state.porosity[p], state.plastic_strain_rate[p], damage)


@initial_sound_speed.register
def _(model: HyperElasticPlastic, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.bulk_modulus + 4.0 * model.shear_modulus / 3.0) / density)


@initialize.register
def _(model: HyperElasticPlastic, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    state.porosity[:] = draw(
        model.initial_porosity_distrib, model.initial_mean_porosity, model.initial_std_porosity, patch
    )


@inline
def carried(stretch: Tensor, F_old: Tensor, F: Tensor) -> Tensor:
    """The isochoric elastic stretch after the isochoric deformation of a step."""
    f = F @ inverse(F_old)
    f = f * determinant(f) ** (-1.0 / 3.0)
    return f @ stretch @ f.T


@implements(stress_update, HyperElasticPlastic)
@lanewise
def hyperelastic_plastic_stress(
    model: HyperElasticPlastic, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Stress, heating, internal energy and failure of one particle, all in the fixed frame."""
    J = determinant(point.deformation_gradient)
    d = symmetric(point.velocity_gradient)
    unturned = isotropic(1.0)
    motion = Kinematics(unturned, unturned, d, deviator(d), trace(d), material.density / possible_ratio(J))
    start = plasticity_state(model, state, p, point, material, motion, trace(point.stress) / 3.0)
    stretch = carried(
        tensor_at(state.elastic_stretch, p), point.deformation_gradient_old, point.deformation_gradient
    )
    mean_stretch = trace(stretch) / 3.0
    mu = start.shear_modulus / possible_ratio(J)
    trial = mu * deviator(stretch)
    flow = deviatoric_flow(model, state, p, start, motion, point.stress, trial, mu * mean_stretch, step.dt)
    returned = flow.stress_deviator * (1.0 / mu) + isotropic(mean_stretch)
    stretch = where(flow.plastic, returned, where(flow.melted, isotropic(mean_stretch), stretch))
    stress = flow.stress_deviator + isotropic(
        mean_stress(model.equation_of_state, start, motion.dilatation_rate * step.dt)
    )
    viscous = artificial_viscosity(
        step, motion.dilatation_rate, math.sqrt(model.bulk_modulus / motion.density), motion.density
    )
    porosity = grown_porosity(model, state.porosity[p], flow, motion, step.dt)
    localized = point.localized
    if model.failure_is_checked:
        failed = (localized != 0) | fails(model, start, flow, stress, motion, porosity)
        localized = where(failed & (localized == 0), 1, localized)
        porosity = where(failed, 0.0, porosity)
    sound = localized == 0
    work = where(sound, internal_work(point, motion, stress, step.dt), 0.0)
    heat = work / point.mass
    if step.viscosity_heating:
        work_of_viscosity = viscous * (point.volume - point.volume_old) / point.mass
        heat = where(sound, heat - work_of_viscosity, 0.0)
    state.energy[p] += heat
    put_tensor(state.elastic_stretch, p, stretch)
    state.strain_rate[p] = start.strain_rate
    state.plastic_strain[p] = flow.plastic_strain
    state.plastic_strain_rate[p] = flow.plastic_strain_rate
    state.porosity[p] = porosity
    answer = StressUpdate(
        stress=stress,
        sound_speed=math.sqrt((model.bulk_modulus + 4.0 * start.shear_modulus / 3.0) / motion.density),
        strain_energy=work,
        heating_rate=heating(model, start, flow, motion, 0.0, viscous, step),
        artificial_pressure=viscous,
        localized=localized,
    )
    return without_impossible(model, J, material, answer)
