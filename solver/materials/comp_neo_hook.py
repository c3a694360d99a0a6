"""Compressible neo-Hookean material, elastic or with von Mises plasticity, after Simo and Hughes (1998)."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple, TypeAlias

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import generic, implements, inline, lanewise
from solver.lanes import anywhere, where
from solver.materials.constitutive import (
    Material,
    NoState,
    Point,
    Step,
    StressUpdate,
    artificial_viscosity,
    initial_sound_speed,
    initialize,
    stress_update,
)
from solver.particles import Array, Particles, StateVariable
from solver.random import by_patch, uniform
from solver.tensor import (
    Tensor,
    determinant,
    deviator,
    inverse,
    isotropic,
    norm,
    put_tensor,
    tensor_at,
    trace,
)

BulkModulus: TypeAlias = Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
ShearModulus: TypeAlias = Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
Plasticity: TypeAlias = Annotated[bool, Parameter("whether the material yields")]
YieldStress: TypeAlias = Annotated[
    float | None, Parameter("yield stress in tension, needed where the material yields", unit="Pa", ge=0.0)
]
Hardening: TypeAlias = Annotated[
    float | None,
    Parameter("slope of yield stress over plastic strain, needed where the material yields", unit="Pa"),
]
InitialStrain: TypeAlias = Annotated[float, Parameter("equivalent plastic strain at the start", ge=0.0)]
Distribution: TypeAlias = Annotated[
    str, Parameter("how the yield stress varies between particles", choices=("constant", "uniform"))
]
YieldRange: TypeAlias = Annotated[
    float, Parameter("largest deviation of the yield stress, if uniformly distributed", unit="Pa", ge=0.0)
]
YieldSeed: TypeAlias = Annotated[int, Parameter("seed of the distribution")]
InitialStress: TypeAlias = Annotated[bool, Parameter("whether particles start under initial_pressure")]
InitialPressure: TypeAlias = Annotated[
    float, Parameter("pressure at the start, compression positive", unit="Pa")
]
ModifiedEos: TypeAlias = Annotated[
    bool,
    Parameter(
        "a power law instead of the bulk modulus in expansion, beside a gas",
        ignored="only the coupled gas-solid method asks the material for its equation of state",
    ),
]
Reinitialize: TypeAlias = Annotated[
    bool,
    Parameter(
        "set stress and deformation anew at a switch of components",
        ignored="components are not switched during a run",
    ),
]
OldFailure: TypeAlias = Annotated[
    float, Parameter("constant of a failure model", ignored="the model was taken out of Uintah")
]


class PlasticState(NamedTuple):
    """What a yielding particle remembers, each (n,) or (n, 3, 3)."""

    plastic_strain: Annotated[Array, StateVariable("p.plasticStrain")]
    yield_stress: Annotated[Array, StateVariable("p.yieldStress")]
    elastic_stretch: Annotated[Array, StateVariable("p.bElBar", "Matrix3", 1.0)]
    """Isochoric elastic left Cauchy-Green tensor."""


@model("constitutive_model", "comp_neo_hook", "UCNH")
class CompNeoHook(NamedTuple):
    """Compressible neo-Hookean elasticity, by default without plasticity.

    With J = det F and b' = J^(-2/3) F F^T the strain energy of unit initial volume is
    W = K/2 ((J^2 - 1)/2 - ln J) + G/2 (tr b' - 3), hence sigma = K/2 (J - 1/J) I + G/J dev b'
    (Simo and Hughes, Computational Inelasticity, 1998, Box 9.1). Thermal expansion of the material shifts the
    pressure by K/2 (J_T - 1/J_T), J_T = (1 + alpha (T - T_room))^3. Inverted particles (J <= 0) answer NaN.
    """

    bulk_modulus: BulkModulus
    shear_modulus: ShearModulus
    usePlasticity: Plasticity = False
    yield_stress: YieldStress = None
    hardening_modulus: Hardening = None
    alpha: InitialStrain = 0.0
    yield_distrib: Distribution = "constant"
    yield_range: YieldRange = 0.0
    yield_seed: YieldSeed = 0
    useInitialStress: InitialStress = False
    initial_pressure: InitialPressure = 0.0
    useModifiedEOS: ModifiedEos = False
    reinitializeCMData: Reinitialize = False
    strain_limit: OldFailure = 0.0
    reduction_factor: OldFailure = 0.0

    @property
    def State(self) -> type:  # noqa: N802 - the class attribute of other models, here decided by usePlasticity
        """The arrays of a particle set: none without plasticity."""
        return PlasticState if self.usePlasticity else NoState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        return plasticity_faults(self)


@model("constitutive_model", "comp_neo_hook_plastic")
class CompNeoHookPlastic(NamedTuple):
    """Compressible neo-Hookean elasticity with von Mises plasticity and linear isotropic hardening.

    The elastic part is that of comp_neo_hook with J^(-2/3) F F^T replaced by the isochoric elastic left
    Cauchy-Green tensor b'_e. It is carried along by the isochoric part f' of the step's deformation,
    b'_e = f' b'_e,old f'^T, and brought back radially to |s| = sqrt(2/3) (sigma_Y + H ep), s = G dev b'_e
    (Simo and Hughes, Computational Inelasticity, 1998, Box 9.1).
    """

    bulk_modulus: BulkModulus
    shear_modulus: ShearModulus
    usePlasticity: Plasticity = True
    yield_stress: YieldStress = None
    hardening_modulus: Hardening = None
    alpha: InitialStrain = 0.0
    yield_distrib: Distribution = "constant"
    yield_range: YieldRange = 0.0
    yield_seed: YieldSeed = 0
    useInitialStress: InitialStress = False
    initial_pressure: InitialPressure = 0.0
    useModifiedEOS: ModifiedEos = False
    reinitializeCMData: Reinitialize = False
    strain_limit: OldFailure = 0.0
    reduction_factor: OldFailure = 0.0

    @property
    def State(self) -> type:  # noqa: N802 - the class attribute of other models, here decided by usePlasticity
        """The arrays of a particle set: none without plasticity."""
        return PlasticState if self.usePlasticity else NoState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        return plasticity_faults(self)


NeoHookean: TypeAlias = CompNeoHook | CompNeoHookPlastic


def plasticity_faults(model: NeoHookean) -> list[tuple[str, str]]:
    """What a material that yields lacks: (field, message)."""
    if not model.usePlasticity:
        return []
    missing = [name for name in ("yield_stress", "hardening_modulus") if getattr(model, name) is None]
    return [(name, f"a material with usePlasticity needs <{name}>") for name in missing]


@initial_sound_speed.register(CompNeoHook)
@initial_sound_speed.register(CompNeoHookPlastic)
def _(model: NeoHookean, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.bulk_modulus + 4.0 * model.shear_modulus / 3.0) / density)


def compress(particles: Particles, pressure: float, bulk_modulus: float) -> None:
    """Bring undeformed particles to a pressure p: J - 1/J = -2 p / K, and the stress that belongs to it.

    Uintah starts the stress with the opposite sign (tension for a positive initial_pressure) and turns it
    round in the first step, since the deformation gradient is a compression; here both agree from the start.
    """
    ratio = pressure / bulk_modulus
    particles.deformation_gradient[...] = np.eye(3) * np.cbrt(math.hypot(1.0, ratio) - ratio)
    particles.stress[...] = np.eye(3) * -pressure


@initialize.register(CompNeoHook)
@initialize.register(CompNeoHookPlastic)
def _(model: NeoHookean, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    """Draw yield stresses, and compress the particles to the initial pressure."""
    if model.useInitialStress:
        compress(particles, model.initial_pressure, model.bulk_modulus)
    if model.usePlasticity:
        state.plastic_strain[...] = model.alpha
        state.yield_stress[...] = model.yield_stress
        if model.yield_distrib == "uniform":
            draws = by_patch(patch, model.yield_seed)[:, 0]
            state.yield_stress[...] = uniform(draws, state.yield_stress, model.yield_range)


class Isochoric(NamedTuple):
    """The shape-changing part of the response."""

    kirchhoff: Tensor
    """Deviatoric Kirchhoff stress s."""
    stretch_trace: float
    """Trace of the isochoric elastic left Cauchy-Green tensor."""


@generic
def isochoric_response(  # type: ignore[empty-body]  # bodies follow, one for each kind of state
    state: Any, model: NeoHookean, p: int, point: Point
) -> Isochoric:
    """Deviatoric stress of particle ``p``; the kind of its state tells whether it can yield."""


@inline
def elastic_shear(shear_modulus: float, F: Tensor) -> Isochoric:
    """Deviatoric stress s = G dev(J^(-2/3) F F^T)."""
    stretch = (F @ F.T) * determinant(F) ** (-2.0 / 3.0)
    return Isochoric(shear_modulus * deviator(stretch), trace(stretch))


@inline
def radial_return(
    state: Any, p: int, point: Point, shear_modulus: float, yield_stress: float, hardening_modulus: float
) -> Isochoric:
    """Return to the yield surface in the space of Kirchhoff stresses.

    Updates ``state.plastic_strain`` and ``state.elastic_stretch``; ``yield_stress`` is that without strain.
    """
    G, H = shear_modulus, hardening_modulus
    increment = point.deformation_gradient @ inverse(point.deformation_gradient_old)
    increment = increment * determinant(increment) ** (-1.0 / 3.0)
    stretch = increment @ tensor_at(state.elastic_stretch, p) @ increment.T
    mean_stretch = trace(stretch) / 3.0
    s = G * deviator(stretch)
    size = norm(s)
    overstress = size - math.sqrt(2.0 / 3.0) * (H * state.plastic_strain[p] + yield_stress)
    yields = overstress > 0.0
    if anywhere(yields):
        mean_modulus = G * mean_stretch
        slip = overstress / (2.0 * mean_modulus) / (1.0 + H / (3.0 * mean_modulus))
        s = where(yields, s - s * (2.0 * mean_modulus * slip / size), s)
        stretch = where(yields, s / G + isotropic(mean_stretch), stretch)
        state.plastic_strain[p] += where(yields, math.sqrt(2.0 / 3.0) * slip, 0.0)
    put_tensor(state.elastic_stretch, p, stretch)
    return Isochoric(s, trace(stretch))


@implements(isochoric_response, NoState)
@lanewise
def elastic_response(state: Any, model: NeoHookean, p: int, point: Point) -> Isochoric:
    """The response of a material that cannot yield."""
    return elastic_shear(model.shear_modulus, point.deformation_gradient)


@implements(isochoric_response, PlasticState)
@lanewise
def plastic_response(state: Any, model: Any, p: int, point: Point) -> Isochoric:
    """The response of a material that can, each particle at its own yield stress."""
    return radial_return(state, p, point, model.shear_modulus, state.yield_stress[p], model.hardening_modulus)


@inline
def thermal_jacobian(material: Material, temperature: float) -> float:
    """Volume ratio of free thermal expansion from the room temperature."""
    stretch = 1.0 + material.thermal_expansion * (temperature - material.room_temperature)
    return stretch * stretch * stretch


@inline
def neo_hookean_energy(J: float, stretch_trace: float, bulk_modulus: float, shear_modulus: float) -> float:
    """Stored energy of unit initial volume."""
    volumetric = 0.5 * bulk_modulus * (0.5 * (J * J - 1.0) - math.log(J))
    return volumetric + 0.5 * shear_modulus * (stretch_trace - 3.0)


@inline
def neo_hookean_update(
    K: float, G: float, shear: Isochoric, J_thermal: float, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Stress from pressure and deviator, with all that follows from it; failed particles count no energy."""
    J = determinant(point.deformation_gradient)
    mean_stress = 0.5 * K * ((J - 1.0 / J) - (J_thermal - 1.0 / J_thermal))
    density = material.density / J
    energy = neo_hookean_energy(J, shear.stretch_trace, K, G) * point.volume / J
    return StressUpdate(
        stress=isotropic(mean_stress) + shear.kirchhoff / J,
        sound_speed=math.sqrt((K + 4.0 * G / 3.0) / density),
        strain_energy=where(point.localized == 0, energy, 0.0),
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(
            step, trace(point.velocity_gradient), math.sqrt(K / density), density
        ),
        localized=point.localized,
    )


@implements(stress_update, CompNeoHook, CompNeoHookPlastic)
@lanewise
def neo_hookean_stress(
    model: NeoHookean, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The equations above, with the thermal expansion of the material."""
    shear = isochoric_response(state, model, p, point)
    J_thermal = thermal_jacobian(material, point.temperature)
    return neo_hookean_update(
        model.bulk_modulus, model.shear_modulus, shear, J_thermal, point, material, step
    )
