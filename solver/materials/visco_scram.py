"""Visco-SCRAM: viscoelastic material with growing microcracks, for plastic-bonded explosives."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple, TypeAlias

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, everywhere, like, where
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
from solver.random import Births, drand48
from solver.tensor import (
    Tensor,
    determinant,
    deviator,
    double_dot,
    isotropic,
    norm,
    put_tensor,
    rotation,
    symmetric,
    tensor_at,
    trace,
)

ELEMENTS = 5
"""Maxwell elements in parallel."""

GROWTH_EXPONENT, GROWTH_FACTOR = 0.90564746, -2.90178468
"""ln(crack speed) = exponent * ln(effective rate) + factor, a fit to unaged PBX 9501."""

RESTING_RATE = 1.0e-8
"""Effective strain rate below which cracks rest."""

_EOS = "only the coupled gas-solid method asks the material for its equation of state"
_HEAT = "the heating uses the specific heat of the material as it is given"

ElementModulus: TypeAlias = Annotated[
    float, Parameter("shear modulus of a Maxwell element", unit="Pa", gt=0.0)
]
ElementRate: TypeAlias = Annotated[
    float, Parameter("inverse of the relaxation time of a Maxwell element", unit="1/s", ge=0.0)
]
EosSwitch: TypeAlias = Annotated[bool, Parameter("choice of an equation of state", ignored=_EOS)]
EosConstant: TypeAlias = Annotated[
    float, Parameter("constant of the Murnaghan or JWL equation of state", ignored=_EOS)
]


HotSpotConstant: TypeAlias = Annotated[
    float, Parameter("constant of the hot-spot model", ignored="only viscoSCRAM_hs computes hot spots")
]


class ViscoScramState(NamedTuple):
    """What a particle remembers."""

    volume_heating: Annotated[Array, StateVariable("p.volHeatRate")]
    """Cooling by dilatation, K/s."""
    viscous_heating: Annotated[Array, StateVariable("p.veHeatRate")]
    crack_heating: Annotated[Array, StateVariable("p.crHeatRate")]
    crack_radius: Annotated[Array, StateVariable("p.crackRad")]
    element_1: Annotated[Array, StateVariable("p.maxwellStress1", "Matrix3")]
    element_2: Annotated[Array, StateVariable("p.maxwellStress2", "Matrix3")]
    element_3: Annotated[Array, StateVariable("p.maxwellStress3", "Matrix3")]
    element_4: Annotated[Array, StateVariable("p.maxwellStress4", "Matrix3")]
    element_5: Annotated[Array, StateVariable("p.maxwellStress5", "Matrix3")]
    """Deviatoric stresses of the Maxwell elements."""
    random: Annotated[Array, StateVariable("p.rand", initial=0.5)]
    """Number of [0, 1) that scatters the moduli by 20 %."""
    deformation_rate: Annotated[Array, StateVariable("p.deformRate", "Matrix3")]


@model("constitutive_model", "visco_scram")
class ViscoScram(NamedTuple):
    """Generalised Maxwell material whose deviator also opens penny-shaped cracks of mean radius c.

    Bennett, Haberman, Johnson, Asay and Henson (J. Mech. Phys. Solids 46, 1998); heating after Hackett and
    Bennett (Int. J. Numer. Meth. Eng. 49, 2000). With s the sum of the elements' stresses s_k and G that of
    their moduli,

    s_k' = 2 G_k e' - s_k / tau_k - (G_k / G) (3 c^2 c' / a^3 s + (c/a)^3 s'),

    and sigma_m' = K tr d with K from G and the Poisson ratio. Elements and radius are integrated by one
    Runge-Kutta step of fourth order, the elements one after the other.

    With useObjectiveRate the elements' stresses are turned back by the old R and forward by the new one.
    Uintah uses the new R for both, so its stresses do not turn.
    """

    PR: Annotated[float, Parameter("Poisson ratio", gt=-1.0, lt=0.5)]
    CrackParameterA: Annotated[
        float, Parameter("crack radius a at which cracks double the compliance", unit="m", gt=0.0)
    ]
    CrackPowerValue: Annotated[float, Parameter("exponent m of slow crack growth", gt=0.0)]
    CrackMaxGrowthRate: Annotated[float, Parameter("largest crack speed", unit="m/s", ge=0.0)]
    StressIntensityF: Annotated[float, Parameter("threshold stress intensity K_0", unit="Pa m^0.5", gt=0.0)]
    CrackFriction: Annotated[float, Parameter("friction coefficient of crack faces", ge=0.0, lt=1.2)]
    InitialCrackRadius: Annotated[float, Parameter("mean crack radius at the start", unit="m", gt=0.0)]
    CrackGrowthRate: Annotated[
        float, Parameter("how much faster cracks grow in tension than in compression", ge=0.0)
    ]
    G1: ElementModulus
    G2: ElementModulus
    G3: ElementModulus
    G4: ElementModulus
    G5: ElementModulus
    RTau1: ElementRate
    RTau2: ElementRate
    RTau3: ElementRate
    RTau4: ElementRate
    RTau5: ElementRate
    Beta: Annotated[float, Parameter("volumetric thermal expansion times Gamma", unit="1/K", ignored=_HEAT)]
    Gamma: Annotated[float, Parameter("Grueneisen parameter of dilatational cooling")]
    DCp_DTemperature: Annotated[
        float, Parameter("slope of specific heat over temperature", unit="J/(kg K^2)", ignored=_HEAT)
    ]
    CoeffThermalExpansion: Annotated[float, Parameter("linear thermal expansion", unit="1/K")] = 0.0
    randomize_parameters: Annotated[bool, Parameter("scatter the moduli of particles by up to 20 %")] = False
    use_time_temperature_equation: Annotated[
        bool, Parameter("shift relaxation times with temperature (Williams, Landel and Ferry 1955)")
    ] = False
    T0: Annotated[float, Parameter("temperature of the given relaxation times", unit="K")] = 298.0
    C1: Annotated[float, Parameter("first constant of the shift")] = 6.5
    C2: Annotated[float, Parameter("second constant of the shift", unit="K")] = 120.0
    useObjectiveRate: Annotated[bool, Parameter("let stress turn with the rotation R of F = R U")] = False
    useModifiedEOS: EosSwitch = False
    useMurnahanEOS: EosSwitch = False
    useBirchMurnaghanEOS: EosSwitch = False
    useJWLEOS: EosSwitch = False
    useJWLCEOS: EosSwitch = False
    gamma: EosConstant = 0.0
    P0: EosConstant = 0.0
    bulkPrime: EosConstant = 0.0
    A: EosConstant = 0.0
    B: EosConstant = 0.0
    C: EosConstant = 0.0
    R1: EosConstant = 0.0
    R2: EosConstant = 0.0
    om: EosConstant = 0.0
    Cv: EosConstant = 0.0
    rho0: EosConstant = 0.0
    Chi: HotSpotConstant = 0.0
    delH: HotSpotConstant = 0.0
    dynamic_coeff_friction: HotSpotConstant = 0.0
    EoverR: HotSpotConstant = 0.0
    volfracHE: HotSpotConstant = 0.0
    Z: HotSpotConstant = 0.0

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return ViscoScramState

    @property
    def largest_time_step(self) -> float:
        """Beyond a microsecond the integration is unstable."""
        return 1.0e-6


@inline
def bulk_over_shear(nu: float) -> float:
    """K / G from the Poisson ratio."""
    return 2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))


@initial_sound_speed.register
def _(model: ViscoScram, density: Any, temperature: Any) -> Any:
    G = model.G1 + model.G2 + model.G3 + model.G4 + model.G5
    return np.sqrt(G * (bulk_over_shear(model.PR) + 4.0 / 3.0) / density)


@initialize.register
def _(model: ViscoScram, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    state.crack_radius[...] = model.InitialCrackRadius
    if model.randomize_parameters:
        turn = patch.numbers()[1] if isinstance(patch, Births) else np.arange(state.random.size)
        state.random[...] = drand48(int(turn.max(initial=-1)) + 1)[turn]


class CrackGrowth(NamedTuple):
    """What cracks do in a step."""

    speed: float
    """At the start of the step, m/s."""
    first: float
    second: float
    third: float
    fourth: float
    """Increments of radius of the four Runge-Kutta stages."""


@inline
def limiting_crack_speed(model: ViscoScram, effective_rate: float, tension: bool) -> float:
    """Speed that a crack approaches far above the threshold of stress intensity."""
    rests = effective_rate <= RESTING_RATE
    speed = math.exp(GROWTH_EXPONENT * math.log(where(rests, 1.0, effective_rate)) + GROWTH_FACTOR)
    speed *= where(tension, model.CrackGrowthRate, 1.0)
    return where(rests, 0.0, min(speed, model.CrackMaxGrowthRate))


@inline
def growth_speed(slow: bool, limit: float, scale: float, power: float, arrest: float, radius: float) -> float:
    """Speed of a crack of some radius, below the transition or above it."""
    speed = limit * (1.0 - arrest / radius)
    if anywhere(slow):
        speed = where(slow, limit * (scale * math.sqrt(radius)) ** power, speed)
    return speed


@inline
def crack_growth(
    model: ViscoScram, radius: float, mean_stress: float, deviator_squared: float, rate: float, dt: float
) -> CrackGrowth:
    """Growth by the stress intensity K_I, as a power of it below K' and approaching the limit speed above.

    In compression the threshold K_0 is raised by friction between the crack faces.
    """
    tension = mean_stress > 0.0
    limit = limiting_crack_speed(model, rate, tension)
    root = math.sqrt(radius)
    driving = deviator_squared + where(tension, 3.0 * mean_stress * mean_stress, 0.0)
    mu = model.CrackFriction
    rubbing = -math.sqrt(45.0 / (2.0 * (3.0 - 2.0 * mu * mu))) * mu * mean_stress * root
    friction = where(tension, 0.0, rubbing)
    intensity = math.sqrt(1.5 * math.pi * driving) * root
    K_0, m = model.StressIntensityF, model.CrackPowerValue
    threshold = K_0 * math.sqrt(1.0 + math.pi * friction * (1.0 + friction / K_0) / K_0)
    transition = threshold * math.sqrt(1.0 + 2.0 / m)
    scale = intensity / (transition * (1.0 + 0.5 * m) ** (1.0 / m) * root)
    slow = intensity < transition
    arrest = threshold * threshold * radius / where(slow, transition * transition, intensity * intensity)
    speed = growth_speed(slow, limit, scale, m, arrest, radius)
    first = speed * dt
    second = growth_speed(slow, limit, scale, m, arrest, radius + 0.5 * first) * dt
    third = growth_speed(slow, limit, scale, m, arrest, radius + 0.5 * second) * dt
    fourth = growth_speed(slow, limit, scale, m, arrest, radius + third) * dt
    return CrackGrowth(speed, first, second, third, fourth)


class Elements(NamedTuple):
    """The Maxwell elements of a particle in this step."""

    moduli: tuple[float, float, float, float, float]
    rates: tuple[float, float, float, float, float]
    """Inverse relaxation times."""
    shear_modulus: float
    """Sum of the moduli."""
    total_rate: float
    """Sum of the inverse relaxation times."""


@inline
def elements_of(model: ViscoScram, random: float, temperature: float) -> Elements:
    """Moduli scattered by the particle's random number, rates shifted by its temperature."""
    scatter = 1.0 + 0.4 * (random - 0.5)
    shift = like(1.0, temperature)
    if model.use_time_temperature_equation:
        above = temperature - model.T0
        shift = math.exp(model.C1 * above / (model.C2 + above))
    moduli = (
        model.G1 * scatter,
        model.G2 * scatter,
        model.G3 * scatter,
        model.G4 * scatter,
        model.G5 * scatter,
    )
    rates = (
        model.RTau1 * shift,
        model.RTau2 * shift,
        model.RTau3 * shift,
        model.RTau4 * shift,
        model.RTau5 * shift,
    )
    total_modulus = moduli[0] + moduli[1] + moduli[2] + moduli[3] + moduli[4]
    total_rate = rates[0] + rates[1] + rates[2] + rates[3] + rates[4]
    return Elements(moduli, rates, total_modulus, total_rate)


@inline
def element_stresses(state: ViscoScramState) -> tuple[Array, Array, Array, Array, Array]:
    """The arrays of the elements' stresses."""
    return state.element_1, state.element_2, state.element_3, state.element_4, state.element_5


@inline
def total_stress(stresses: tuple[Array, ...], p: int) -> Tensor:
    """Sum of the elements' stresses."""
    total = tensor_at(stresses[0], p)
    for k in range(1, ELEMENTS):
        total = total + tensor_at(stresses[k], p)
    return total


@inline
def total_relaxation(stresses: tuple[Array, ...], rates: tuple[float, ...], p: int) -> Tensor:
    """Sum of the elements' stresses over their relaxation times."""
    total = tensor_at(stresses[0], p) * rates[0]
    for k in range(1, ELEMENTS):
        total = total + tensor_at(stresses[k], p) * rates[k]
    return total


@inline
def crack_stress_rate(
    model: ViscoScram, radius: float, speed: float, stress: Tensor, relaxation: Tensor, elastic_rate: Tensor
) -> Tensor:
    """Rate of stress that the cracks take off, as a whole: 3 c^2 c' / a^3 s + (c/a)^3 s'."""
    a3 = model.CrackParameterA**3
    growth = 3.0 * radius * radius * speed / a3
    opened = radius * radius * radius / a3
    return stress * growth + (elastic_rate - relaxation - stress * growth) * (opened / (1.0 + opened))


@inline
def relax(
    model: ViscoScram,
    state: Any,
    p: int,
    elements: Elements,
    strain_rate: Tensor,
    cracks: CrackGrowth,
    dt: float,
) -> None:
    """One Runge-Kutta step of each element; later elements see the new stress of earlier ones.

    With shifted relaxation times an element that relaxes within a tenth of a step bears no stress.
    """
    stresses = element_stresses(state)
    radius = state.crack_radius[p]
    G = elements.shear_modulus
    radii = (radius, radius + 0.5 * cracks.first, radius + 0.5 * cracks.second, radius + cracks.third)
    for k in range(ELEMENTS):
        modulus, rate = elements.moduli[k], elements.rates[k]
        old = tensor_at(stresses[k], p)
        relaxed = (rate * dt > 0.1) & model.use_time_temperature_equation
        if everywhere(relaxed):
            put_tensor(stresses[k], p, isotropic(0.0))
            continue
        stress = total_stress(stresses, p)
        relaxation = total_relaxation(stresses, elements.rates, p)
        stage = isotropic(0.0)
        change = isotropic(0.0)
        for i in range(4):
            trial = stage * (0.0 if i == 0 else 1.0 if i == 3 else 0.5)
            taken = crack_stress_rate(
                model,
                radii[i],
                cracks.speed,
                stress + trial * ELEMENTS,
                relaxation + trial * elements.total_rate,
                2.0 * G * strain_rate,
            )
            stage = (2.0 * modulus * strain_rate - (old + trial) * rate - taken * (modulus / G)) * dt
            change = change + stage * (1.0 / 6.0 if i in (0, 3) else 1.0 / 3.0)
        put_tensor(stresses[k], p, where(relaxed, isotropic(0.0), old + change))


@inline
def rotate_elements(state: Any, p: int, R: Tensor) -> None:
    """Turn the elements' stresses: s <- R s R^T."""
    stresses = element_stresses(state)
    for k in range(ELEMENTS):
        put_tensor(stresses[k], p, R @ tensor_at(stresses[k], p) @ R.T)


@inline
def heating(
    model: ViscoScram,
    state: Any,
    p: int,
    elements: Elements,
    d: Tensor,
    crack_speed: float,
    temperature: float,
    heat_capacity: float,
) -> float:
    """Rate of temperature by viscous and crack work less dilatational cooling; the parts are kept for output.

    ``heat_capacity`` is that of unit volume.
    """
    stresses = element_stresses(state)
    viscous = like(0.0, temperature)
    for k in range(ELEMENTS):
        s_k = tensor_at(stresses[k], p)
        viscous += double_dot(s_k, s_k) / (2.0 * elements.moduli[k]) * elements.rates[k]
    G = elements.shear_modulus
    radius = state.crack_radius[p]
    s = total_stress(stresses, p)
    relative = radius / model.CrackParameterA
    opened = relative * relative * relative
    growth = 3.0 * opened / radius * crack_speed
    relaxation = total_relaxation(stresses, elements.rates, p)
    stress_rate = (d * (2.0 * G) - s * growth - relaxation) * (1.0 / (1.0 + opened))
    cracking = (double_dot(s, s) * growth + double_dot(s, stress_rate) * opened) / (2.0 * G)
    state.viscous_heating[p] = viscous / heat_capacity
    state.crack_heating[p] = cracking / heat_capacity
    state.volume_heating[p] = model.Gamma * temperature * trace(d)
    return -state.volume_heating[p] + state.viscous_heating[p] + state.crack_heating[p]


@implements(stress_update, ViscoScram)
@lanewise
def visco_scram_stress(
    model: ViscoScram, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Grow the cracks, relax the elements, add the pressure; the energy is the work done in the step."""
    dt = step.dt
    elements = elements_of(model, state.random[p], point.temperature)
    G = elements.shear_modulus
    K = G * bulk_over_shear(model.PR)
    density = material.density / determinant(point.deformation_gradient)
    d = symmetric(point.velocity_gradient)
    mean_stress = trace(point.stress) / 3.0
    s_old = deviator(point.stress)
    R = isotropic(1.0)
    if model.useObjectiveRate:
        rotate_elements(state, p, rotation(point.deformation_gradient_old).T)
        s_old = total_stress(element_stresses(state), p)
        R = rotation(point.deformation_gradient)
        d = R.T @ d @ R
    expansion = model.CoeffThermalExpansion * (point.temperature - point.previous_temperature) / dt
    d = d - isotropic(expansion)
    put_tensor(state.deformation_rate, p, d)
    strain_rate = deviator(d)
    effective_rate = math.sqrt(1.5) * norm(strain_rate)
    cracks = crack_growth(
        model, state.crack_radius[p], mean_stress, double_dot(s_old, s_old), effective_rate, dt
    )
    relax(model, state, p, elements, strain_rate, cracks, dt)
    if model.useObjectiveRate:
        rotate_elements(state, p, R)
        d = R @ d @ R.T
    mean_stress += K * trace(d) * dt
    stress = total_stress(element_stresses(state), p) + isotropic(mean_stress)
    state.crack_radius[p] += (cracks.first + cracks.fourth) / 6.0 + (cracks.second + cracks.third) / 3.0
    return StressUpdate(
        stress=stress,
        sound_speed=math.sqrt((K + 4.0 * G / 3.0) / density),
        strain_energy=double_dot(d, 0.5 * (stress + point.stress)) * point.volume * dt,
        heating_rate=heating(
            model, state, p, elements, d, cracks.speed, point.temperature, density * material.specific_heat
        ),
        artificial_pressure=artificial_viscosity(
            step, trace(point.velocity_gradient), math.sqrt(K / density), density
        ),
        localized=point.localized,
    )
