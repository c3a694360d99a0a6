"""Elastic-plastic metals: hypoelastic stress, an equation of state and interchangeable plasticity."""

from __future__ import annotations

import math
from functools import cache
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, like, negation, where
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
from solver.materials.damage.no_damage import NoDamage
from solver.materials.deviatoric_stress import relax, stress_increment
from solver.materials.deviatoric_stress.hypo_elastic import HypoElasticDeviator
from solver.materials.deviatoric_stress.hypo_visco_elastic import HypoViscoElasticDeviator
from solver.materials.distribution import draw
from solver.materials.distribution.constant import Constant
from solver.materials.equation_of_state import isentropic_heating, mean_stress
from solver.materials.equation_of_state.default_hyper import DefaultHyper
from solver.materials.failure import fractures, plastic_strain_rate
from solver.materials.flow_stress import flow_stress, hardening_slope, in_step
from solver.materials.melting import melting_temperature
from solver.materials.melting.constant_melting import ConstantMelting
from solver.materials.metal_parameters import (
    BreakByStrain,
    BulkModulus,
    CheckPorosity,
    CheckStress,
    ComputeSpecificHeat,
    CriticalPorosity,
    CriticalStress,
    DamageModel,
    DeviatoricStressModel,
    DoMelting,
    EquationOfState,
    EvolveDamage,
    EvolvePorosity,
    FlowModel,
    Isothermal,
    MeanPorosity,
    MeltingTempModel,
    ModifiedEos,
    NucleatedFraction,
    NucleationSpread,
    NucleationStrain,
    PorosityDistribution,
    PorositySpread,
    ReferenceTemperature,
    ReturnAlgorithm,
    ShearModulus,
    ShearModulusModel,
    SpecificHeatModel,
    StabilityCheck,
    TaylorQuinney,
    ThermalExpansion,
    Tolerance,
    YieldCondition,
)
from solver.materials.plasticity_state import PlasticityState, at_plastic_strain, with_thermal_properties
from solver.materials.return_algorithm import PlasticReturn, PlasticTrial, return_to_yield
from solver.materials.return_algorithm.radial_return import RadialReturn
from solver.materials.shear_modulus import shear_modulus
from solver.materials.shear_modulus.constant_shear import ConstantShear
from solver.materials.specific_heat import specific_heat
from solver.materials.specific_heat.constant_specific_heat import ConstantSpecificHeat
from solver.materials.stability import is_checked, localizes, tangent_modulus
from solver.materials.stability.no_check import NoCheck
from solver.materials.yield_condition import hardening_term, yield_normal, yield_value
from solver.materials.yield_condition.gurson import Gurson
from solver.materials.yield_condition.rousselier import Rousselier
from solver.materials.yield_condition.von_mises import VonMises
from solver.particles import Array, Particles, StateVariable
from solver.tensor import (
    Tensor,
    determinant,
    deviator,
    double_dot,
    isotropic,
    norm,
    principal_values,
    put_tensor,
    rotation,
    symmetric,
    tensor_at,
    to_laboratory,
    to_material,
    trace,
)

LEAST_SHEAR_MODULUS = 1.0e-8
"""Pa: what is left where a law makes the shear modulus vanish."""

LARGEST_EXPANSION = 1.0e5
"""A particle whose volume grew by more than this factor is removed."""


class ElasticPlasticState(NamedTuple):
    """What an elastic-plastic particle remembers; Maxwell elements, if any, follow as more fields."""

    rotation: Annotated[Array, StateVariable("p.rotation", "Matrix3", 1.0)]
    """R of the polar decomposition of the deformation gradient."""
    strain_rate: Annotated[Array, StateVariable("p.strainRate")]
    plastic_strain: Annotated[Array, StateVariable("p.plasticStrain")]
    plastic_strain_rate: Annotated[Array, StateVariable("p.plasticStrainRate")]
    porosity: Annotated[Array, StateVariable("p.porosity")]
    energy: Annotated[Array, StateVariable("p.energy")]
    """Specific internal energy, J/kg."""
    alpha: Annotated[Array, StateVariable("p.alpha")]
    """Sum of sqrt(2/3) times the plastic multipliers."""


OWN_FIELDS = len(ElasticPlasticState._fields)


@model("constitutive_model", "elastic_plastic", "elastic_plastic_hp", old_names=("hypoelastic_plastic",))
class ElasticPlastic(NamedTuple):
    """Hypoelastic-plastic metal of which every part can be exchanged (Banerjee 2012, section 3).

    The rate of deformation and the stress are turned into the frame of the material by R of F = R U. There
    the deviator follows s' = 2 mu (dev(d) - d_p) with plastic flow on the yield surface, the mean stress an
    equation of state. Plastic work, change of volume and artificial viscosity heat the particle.
    """

    bulk_modulus: BulkModulus
    shear_modulus: ShearModulus
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
    tolerance: Tolerance = 1.0e-10
    initial_material_temperature: ReferenceTemperature = 294.0
    coeff_thermal_expansion: ThermalExpansion = 0.0
    useModifiedEOS: ModifiedEos = False
    evolve_damage: EvolveDamage = True
    failure_is_checked: bool = False
    """Whether the material has an erosion algorithm, without which particles do not fail."""

    @property
    def adds_to_stress(self) -> bool:
        """The deviator of a step is added to that of the step before."""
        return True

    @property
    def State(self) -> type:  # noqa: N802 - the class attribute of other models
        """The arrays of a particle set, with those of the Maxwell elements."""
        return state_class(len(getattr(self.deviatoric_stress_model, "tau", ())))

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        found = metal_faults(self)
        viscous = isinstance(self.deviatoric_stress_model, HypoViscoElasticDeviator)
        if viscous and not isinstance(self.shear_modulus_model, ConstantShear):
            message = "the elements of hypoViscoElastic have their own, constant moduli: use constant_shear"
            found.append(("shear_modulus_model", message))
        return found


def metal_faults(model: Any) -> list[tuple[str, str]]:
    """Fields of an elastic-plastic metal that do not go together, each with what is wrong."""
    found = []
    porous = isinstance(model.yield_condition, Gurson | Rousselier)
    if porous and isinstance(model.plastic_convergence_algo, RadialReturn):
        found.append(("plastic_convergence_algo", "a yield condition with porosity needs biswajit"))
    if model.check_max_stress_failure and math.isinf(model.critical_stress):
        found.append(("critical_stress", "check_max_stress_failure needs critical_stress"))
    return found


@cache
def state_class(elements: int) -> type:
    """The state of a model with that many Maxwell elements."""
    if elements == 0:
        return ElasticPlasticState
    fields = [(name, ElasticPlasticState.__annotations__[name]) for name in ElasticPlasticState._fields]
    fields += [
        (f"element_{i}", Annotated[Array, StateVariable(f"sigmaDev{i}", "Matrix3")]) for i in range(elements)
    ]
    record = NamedTuple(f"ElasticPlasticState{elements}", fields)  # type: ignore[misc]  # made for a number
    record.__module__ = __name__
    return record


def __getattr__(name: str) -> type:
    """State classes by name, so that compiled kernels that were kept on disk find them again."""
    number = name.removeprefix("ElasticPlasticState")
    if number != name and number.isdecimal():
        return state_class(int(number))
    raise AttributeError(f"module {__name__} has no attribute {name}")


@implements(plastic_strain_rate, ElasticPlastic)
@lanewise
def _(model: ElasticPlastic, state: Any, p: int) -> float:
    rate = state.plastic_strain_rate[p]
    return where(model.evolve_damage, rate, like(0.0, rate))


@implements(fractures, ElasticPlastic)
@lanewise
def _(model: ElasticPlastic, state: Any, p: int, damage: float) -> bool:
    return breaks(model, state.porosity[p], state.plastic_strain_rate[p], damage)


@initial_sound_speed.register
def _(model: ElasticPlastic, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.bulk_modulus + 4.0 * model.shear_modulus / 3.0) / density)


@initialize.register
def _(model: ElasticPlastic, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    left, _, right = np.linalg.svd(particles.deformation_gradient)
    state.rotation[:] = left @ right
    state.porosity[:] = draw(
        model.initial_porosity_distrib, model.initial_mean_porosity, model.initial_std_porosity, patch
    )


class Kinematics(NamedTuple):
    """Deformation of a particle in a step, in the frame of the material."""

    old_rotation: Tensor
    rotation: Tensor
    rate: Tensor
    """Rate of deformation."""
    rate_deviator: Tensor
    dilatation_rate: float
    density: float
    """At the end of the step."""


class Flow(NamedTuple):
    """Deviatoric part of a stress update, in the frame of the material."""

    stress_deviator: Tensor
    plastic: bool
    melted: bool
    plastic_strain: float
    plastic_strain_rate: float
    flow_stress: float
    multiplier: float
    plastic_increment: Tensor


@implements(stress_update, ElasticPlastic)
@lanewise
@inline
def elastic_plastic_stress(
    model: ElasticPlastic, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Stress, heating, internal energy and failure of one particle, in Uintah's order of operations."""
    J = determinant(point.deformation_gradient)
    motion = kinematics(point, tensor_at(state.rotation, p), material.density / possible_ratio(J))
    old_stress = to_material(motion.old_rotation, point.stress)
    start = plasticity_state(model, state, p, point, material, motion, trace(old_stress) / 3.0)
    elements = state[OWN_FIELDS:]
    trial = deviator(old_stress) + stress_increment(
        model.deviatoric_stress_model, elements, p, motion.rate_deviator, start.shear_modulus, step.dt
    )
    flow = deviatoric_flow(model, state, p, start, motion, old_stress, trial, start.shear_modulus, step.dt)
    elastic_rate = motion.rate_deviator - flow.plastic_increment / step.dt
    dissipation = relax(model.deviatoric_stress_model, elements, p, flow.melted, elastic_rate, step.dt)
    pressure = mean_stress(model.equation_of_state, start, motion.dilatation_rate * step.dt)
    stress = flow.stress_deviator + isotropic(pressure)
    viscous = artificial_viscosity(
        step, motion.dilatation_rate, math.sqrt(model.bulk_modulus / motion.density), motion.density
    )
    porosity = grown_porosity(model, state.porosity[p], flow, motion, step.dt)
    localized = point.localized
    if model.failure_is_checked:
        failed = (localized != 0) | fails(model, start, flow, stress, motion, porosity)
        localized = where(failed & (localized == 0), 1, localized)
        porosity = where(failed, 0.0, porosity)
    laboratory_stress = to_laboratory(motion.rotation, stress)
    sound = localized == 0
    work = where(sound, internal_work(point, motion, laboratory_stress, step.dt), 0.0)
    heat = work / point.mass
    if step.viscosity_heating:
        work_of_viscosity = viscous * (point.volume - point.volume_old) / point.mass
        heat = where(sound, heat - work_of_viscosity, 0.0)
    state.energy[p] += heat
    put_tensor(state.rotation, p, motion.rotation)
    state.strain_rate[p] = start.strain_rate
    state.plastic_strain[p] = flow.plastic_strain
    state.plastic_strain_rate[p] = flow.plastic_strain_rate
    state.alpha[p] += math.sqrt(2.0 / 3.0) * flow.multiplier
    state.porosity[p] = porosity
    answer = StressUpdate(
        stress=laboratory_stress,
        sound_speed=math.sqrt((model.bulk_modulus + 4.0 * start.shear_modulus / 3.0) / motion.density),
        strain_energy=work,
        heating_rate=heating(model, start, flow, motion, dissipation, viscous, step),
        artificial_pressure=viscous,
        localized=localized,
    )
    return without_impossible(model, J, material, answer)


@inline
def is_possible(J: float) -> bool:
    """Whether a particle can have that ratio of volumes."""
    return (J > 0.0) & (J <= LARGEST_EXPANSION)


@inline
def possible_ratio(J: float) -> float:
    """The ratio of volumes, or 1 where that is impossible: what becomes of such a particle is decided at the end."""
    return where(is_possible(J), J, 1.0)


@inline
def without_impossible(model: Any, J: float, material: Material, answer: StressUpdate) -> StressUpdate:
    """The answer, but for a particle of impossible volume, which is removed.

    As in Uintah that still holds back the next step by waves in what it became, where that is a number.
    """
    possible = is_possible(J)
    modulus = model.bulk_modulus + 4.0 * model.shear_modulus / 3.0
    c = math.sqrt(modulus * where((J > 0.0) & (math.inf > J), J, 0.0) / material.density)
    return StressUpdate(
        where(possible, answer.stress, isotropic(0.0)),
        where(possible, answer.sound_speed, c),
        where(possible, answer.strain_energy, 0.0),
        where(possible, answer.heating_rate, 0.0),
        where(possible, answer.artificial_pressure, 0.0),
        where(possible, answer.localized, DELETE),
    )


@inline
def kinematics(point: Point, old_rotation: Tensor, density: float) -> Kinematics:
    """Rate of deformation in the frame that R of the old deformation gradient turns with."""
    rate = to_material(old_rotation, symmetric(point.velocity_gradient))
    return Kinematics(
        old_rotation, rotation(point.deformation_gradient), rate, deviator(rate), trace(rate), density
    )


@inline
def plasticity_state(
    model: Any,
    state: Any,
    p: int,
    point: Point,
    material: Material,
    motion: Kinematics,
    old_mean_stress: float,
) -> PlasticityState:
    """State of the particle from its history and the new density, with properties at its temperature.

    Where a law beyond its range (far above melting, near 0 K) gives a negative shear modulus, there is next to
    none, and where it gives no positive specific heat that of the material holds.
    """
    constant = PlasticityState(
        plastic_strain=state.plastic_strain[p],
        plastic_strain_rate=state.plastic_strain_rate[p],
        strain_rate=math.sqrt(2.0 / 3.0) * norm(motion.rate),
        temperature=point.temperature,
        mean_stress=old_mean_stress,
        density=motion.density,
        initial_density=material.density,
        energy=state.energy[p],
        bulk_modulus=model.bulk_modulus,
        shear_modulus=model.shear_modulus,
        melt_temperature=material.melt_temperature,
        specific_heat=material.specific_heat,
    )
    heat = constant.specific_heat
    if model.compute_specific_heat:
        found = specific_heat(model.specific_heat_model, constant)
        heat = where(found > 0.0, found, heat)
    melt = melting_temperature(model.melting_temp_model, constant)
    at_melt = with_thermal_properties(constant, heat, melt, model.shear_modulus)
    stiffness = max(LEAST_SHEAR_MODULUS, shear_modulus(model.shear_modulus_model, at_melt))
    return with_thermal_properties(at_melt, heat, melt, stiffness)


@inline
def deviatoric_flow(
    model: Any,
    state: Any,
    p: int,
    start: PlasticityState,
    motion: Kinematics,
    old_stress: Tensor,
    trial: Tensor,
    stiffness: float,
    dt: float,
) -> Flow:
    """Deviatoric stress: none when melted, the trial inside the yield surface, else on the surface.

    ``trial`` is the deviator of an elastic step, from which plastic strain takes 2 ``stiffness`` times
    itself. The yield surface is that of the plastic strain which the old plastic strain rate leads to.
    """
    melted = (start.temperature > start.melt_temperature) & model.do_melting
    expected_strain = start.plastic_strain + start.plastic_strain_rate * dt
    expected = at_plastic_strain(start, expected_strain, start.plastic_strain_rate)
    flow_model = in_step(model.flow_model, start)
    sigma_y = flow_stress(flow_model, expected)
    stress_trace = 3.0 * start.mean_stress + motion.dilatation_rate * (2.0 * start.shear_modulus * dt)
    porosity = state.porosity[p]
    equivalent = math.sqrt(1.5) * norm(trial)
    surface = yield_value(model.yield_condition, equivalent, stress_trace, sigma_y, porosity)
    plastic = negation(melted | (surface.function < 0.0))
    flow = elastic_flow(start, trial, melted, sigma_y)
    if not anywhere(plastic):
        return flow
    plastic_trial = PlasticTrial(
        plastic,
        old_stress,
        trial,
        motion.rate_deviator,
        state.strain_rate[p],
        sigma_y,
        surface.strength,
        porosity,
        stiffness,
    )
    end = return_to_yield(model.plastic_convergence_algo, flow_model, start, plastic_trial, dt)
    return plastic_flow(flow, plastic, end)


@inline
def elastic_flow(start: PlasticityState, trial: Tensor, melted: bool, sigma_y: float) -> Flow:
    """No plastic flow: the trial deviator, or none where the material melted."""
    zero = like(0.0, sigma_y)
    return Flow(
        where(melted, isotropic(zero), trial),
        like(False, melted),
        melted,
        start.plastic_strain,
        zero,
        where(melted, 0.0, sigma_y),
        zero,
        isotropic(zero),
    )


@inline
def plastic_flow(elastic: Flow, plastic: bool, end: PlasticReturn) -> Flow:
    """The answer of a return algorithm as the flow of a step, where there is plastic flow."""
    return Flow(
        where(plastic, end.stress_deviator, elastic.stress_deviator),
        plastic,
        elastic.melted,
        where(plastic, end.plastic_strain, elastic.plastic_strain),
        where(plastic, end.plastic_strain_rate, elastic.plastic_strain_rate),
        where(plastic, end.flow_stress, elastic.flow_stress),
        where(plastic, end.multiplier, elastic.multiplier),
        where(plastic, end.plastic_increment, elastic.plastic_increment),
    )


@inline
def heating(
    model: Any,
    start: PlasticityState,
    flow: Flow,
    motion: Kinematics,
    dissipation: float,
    viscous_pressure: float,
    step: Step,
) -> float:
    """Rate of temperature by change of volume, viscous and plastic work, K/s (Banerjee 2012, Eq. 65)."""
    if model.isothermal:
        return 0.0
    to_heat = model.taylor_quinney_coeff / (motion.density * start.specific_heat)
    rate = isentropic_heating(model.equation_of_state, start, motion.dilatation_rate) + to_heat * dissipation
    if step.viscosity_heating:
        rate -= viscous_pressure * motion.dilatation_rate / motion.density / start.specific_heat
    return rate + where(flow.plastic, to_heat * flow.flow_stress * flow.plastic_strain_rate, 0.0)


@inline
def nucleation(model: Any, plastic_strain: float) -> float:
    """Porosity that nucleates per unit of plastic strain (Chu and Needleman 1980)."""
    z = (plastic_strain - model.meanstrain_nucleation) / model.stddevstrain_nucleation
    density = math.exp(-0.5 * z * z) / (model.stddevstrain_nucleation * math.sqrt(2.0 * math.pi))
    return model.frac_nucleation * density


@inline
def grown_porosity(model: Any, porosity: float, flow: Flow, motion: Kinematics, dt: float) -> float:
    """Porosity after a plastic step: growth (1 - f) tr(d) in expansion and nucleation by shear."""
    if not (model.evolve_porosity and anywhere(flow.plastic)):
        return porosity
    growth = (1.0 - porosity) * max(0.0, motion.dilatation_rate)
    shear_rate = norm(motion.rate_deviator) / math.sqrt(1.5)
    rate = nucleation(model, flow.plastic_strain) * shear_rate + growth
    return where(flow.plastic, porosity + dt * rate, porosity)


@inline
def fails(
    model: Any,
    start: PlasticityState,
    flow: Flow,
    stress: Tensor,
    motion: Kinematics,
    porosity: float,
) -> bool:
    """Whether a particle melts, reaches the critical stress or porosity, or deforms unstably.

    The porosity criterion is TEPLA-F without its strain term, f^2 / f_c^2 > 1, as in Uintah; see :func:`breaks`.
    """
    failed = flow.melted
    if model.check_max_stress_failure:
        failed = failed | (principal_values(stress).first > model.critical_stress)
    if model.check_TEPLA_failure_criterion:
        failed = failed | (flow.plastic & (porosity > model.critical_porosity))
    if is_checked(model.stability_check):
        checked = flow.plastic & negation(failed)
        if anywhere(checked):
            failed = failed | (checked & is_unstable(model, start, flow, stress, motion, porosity))
    return failed


@inline
def breaks(model: Any, porosity: float, plastic_strain_rate: float, damage: float) -> bool:
    """Whether a flowing particle breaks by TEPLA-F (Johnson and Addessio 1988; Banerjee 2012, Eq. 75).

    (f / f_c)^2 + (e_p / e_p^f)^2 > 1, where damage stands for the ratio of the strains, which it sums up over a
    path along which the strain at fracture changes.
    """
    flows = plastic_strain_rate > 0.0
    if not (model.failure_is_checked and model.check_TEPLA_failure_criterion and model.TEPLA_with_damage):
        return like(False, flows)
    voids = porosity / model.critical_porosity
    return flows & (voids * voids + damage * damage > 1.0)


@inline
def is_unstable(
    model: Any,
    start: PlasticityState,
    flow: Flow,
    stress: Tensor,
    motion: Kinematics,
    porosity: float,
) -> bool:
    """Whether the stability check finds localization with the tangent at the end of the step."""
    end = at_plastic_strain(start, flow.plastic_strain, flow.plastic_strain_rate)
    found = flow_stress(model.flow_model, end)
    strong = found > 0.0
    sigma_y = where(strong, found, 1.0)
    normal = yield_normal(model.yield_condition, stress, sigma_y, porosity)
    hardening = hardening_term(
        model.yield_condition,
        stress,
        normal,
        sigma_y,
        hardening_slope(model.flow_model, end),
        porosity,
        nucleation(model, flow.plastic_strain),
    )
    tangent = tangent_modulus(model.bulk_modulus, start.shear_modulus, normal, hardening)
    return negation(strong) | localizes(model.stability_check, stress, motion.rate, tangent)


@inline
def internal_work(point: Point, motion: Kinematics, stress: Tensor, dt: float) -> float:
    """Work of the stress in the step, J: mean stress times rate times mean volume."""
    rate = to_laboratory(motion.rotation, motion.rate)
    mean = 0.5 * (stress + point.stress)
    return double_dot(rate, mean) * 0.5 * (point.volume + point.volume_old) * dt
