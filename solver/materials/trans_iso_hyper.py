"""Rubber-like matrix with one family of fibres, elastic or with a fading memory, such as ligaments."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple, TypeAlias

import numpy as np

from solver.declare import Parameter, Vector, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, like, where
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
from solver.tensor import (
    Tensor,
    determinant,
    deviator,
    isotropic,
    principal_values,
    put_tensor,
    tensor_at,
    trace,
)

LEAST_PRESSURE = 1.0e-5
"""Mean stresses below this count as none, as in Uintah (in the deck's unit of stress)."""

GAUSS_NODES, GAUSS_WEIGHTS = (tuple(values.tolist()) for values in np.polynomial.legendre.leggauss(8))

BulkModulus: TypeAlias = Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
Mooney1: TypeAlias = Annotated[float, Parameter("Mooney constant of the matrix", unit="Pa", ge=0.0)]
Mooney2: TypeAlias = Annotated[float, Parameter("second Mooney constant of the matrix", unit="Pa", ge=0.0)]
CrimpScale: TypeAlias = Annotated[
    float, Parameter("scale of the stress of crimped fibres", unit="Pa", ge=0.0)
]
CrimpRate: TypeAlias = Annotated[float, Parameter("exponent of the uncrimping of fibres", ge=0.0)]
FiberModulus: TypeAlias = Annotated[float, Parameter("modulus of straight fibres", unit="Pa", ge=0.0)]
StraightStretch: TypeAlias = Annotated[float, Parameter("stretch at which fibres are straight", ge=1.0)]
FiberDirection: TypeAlias = Annotated[Vector, Parameter("direction of the undeformed fibres, a unit vector")]
FailureOption: TypeAlias = Annotated[
    float, Parameter("1 to let fibres and matrix fail, 0 not to", ge=0.0, le=1.0)
]
FiberLimit: TypeAlias = Annotated[float, Parameter("stretch at which fibres fail", gt=0.0)]
MatrixLimit: TypeAlias = Annotated[
    float, Parameter("half the difference of extreme squared stretches at which the matrix fails", gt=0.0)
]
ModifiedEos: TypeAlias = Annotated[
    bool,
    Parameter(
        "a power law instead of the bulk modulus in expansion, beside a gas",
        ignored="only the coupled gas-solid method asks the material for its equation of state",
    ),
]
HistoryWeight: TypeAlias = Annotated[float, Parameter("weight of a term of the relaxation function")]
RelaxationTime: TypeAlias = Annotated[
    float, Parameter("relaxation time of a term; the term is off unless positive, all are if t1 is", unit="s")
]
FiberState: TypeAlias = Annotated[Array, StateVariable("p.fiberDir", "Vector")]
StretchState: TypeAlias = Annotated[Array, StateVariable("p.stretch", initial=1.0)]
FailureState: TypeAlias = Annotated[Array, StateVariable("p.fail")]


class FiberedState(NamedTuple):
    """Fibres of a particle: direction before deformation, stretch, and what has failed.

    ``failure`` is 0 for nothing, 1 for the matrix, 2 for the fibres, 3 for both.
    """

    fiber: FiberState
    stretch: StretchState
    failure: FailureState


class ViscousFiberedState(NamedTuple):
    """The same with the elastic stress of the last step and the terms of the memory."""

    fiber: FiberState
    stretch: StretchState
    failure: FailureState
    elastic_stress: Annotated[Array, StateVariable("p.ElasticStress", "Matrix3")]
    history_1: Annotated[Array, StateVariable("p.history1", "Matrix3")]
    history_2: Annotated[Array, StateVariable("p.history2", "Matrix3")]
    history_3: Annotated[Array, StateVariable("p.history3", "Matrix3")]
    history_4: Annotated[Array, StateVariable("p.history4", "Matrix3")]
    history_5: Annotated[Array, StateVariable("p.history5", "Matrix3")]
    history_6: Annotated[Array, StateVariable("p.history6", "Matrix3")]


@model("constitutive_model", "trans_iso_hyper")
class TransIsoHyper(NamedTuple):
    """Transversely isotropic hyperelastic material.

    Weiss, Maker and Govindjee (Comput. Meth. Appl. Mech. Eng. 135, 1996): with C' = J^(-2/3) F^T F, its
    invariants I1, I2 and the fibre stretch l = sqrt(a0 . C' a0), the energy of unit initial volume is
    W = K/2 ln^2 J + c1 (I1 - 3) + c2 (I2 - 3) + W_f(l), where l dW_f/dl is 0 for l < 1,
    c3 (exp(c4 (l - 1)) - 1) while the fibres straighten and c5 l + c6 beyond fiber_stretch, c6 making it
    continuous. A failed matrix bears neither shear nor pressure, failed fibres nothing; the energy is that of
    the sound material. (Uintah's energy of the fibres is not the integral of their stress.)
    """

    bulk_modulus: BulkModulus
    c1: Mooney1
    c2: Mooney2
    c3: CrimpScale
    c4: CrimpRate
    c5: FiberModulus
    fiber_stretch: StraightStretch
    direction_of_symm: FiberDirection
    failure_option: FailureOption
    max_fiber_strain: FiberLimit
    max_matrix_strain: MatrixLimit
    useModifiedEOS: ModifiedEos = False

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return FiberedState


@model("constitutive_model", "visco_trans_iso_hyper")
class ViscoTransIsoHyper(NamedTuple):
    """The material of trans_iso_hyper with a fading memory of up to six terms.

    sigma = sigma_e + sum y_k h_k, h_k' + h_k / t_k = sigma_e', integrated exactly for a constant rate of the
    elastic stress in each step (Puso and Weiss, J. Biomech. Eng. 120, 1998). As in Uintah the memory does not
    turn with the body.
    """

    bulk_modulus: BulkModulus
    c1: Mooney1
    c2: Mooney2
    c3: CrimpScale
    c4: CrimpRate
    c5: FiberModulus
    fiber_stretch: StraightStretch
    direction_of_symm: FiberDirection
    failure_option: FailureOption
    max_fiber_strain: FiberLimit
    max_matrix_strain: MatrixLimit
    y1: HistoryWeight
    y2: HistoryWeight
    y3: HistoryWeight
    y4: HistoryWeight
    y5: HistoryWeight
    y6: HistoryWeight
    t1: RelaxationTime
    t2: RelaxationTime
    t3: RelaxationTime
    t4: RelaxationTime
    t5: RelaxationTime
    t6: RelaxationTime
    useModifiedEOS: ModifiedEos = False

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return ViscousFiberedState


Fibered: TypeAlias = TransIsoHyper | ViscoTransIsoHyper


@initial_sound_speed.register(TransIsoHyper)
@initial_sound_speed.register(ViscoTransIsoHyper)
def _(model: Fibered, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.bulk_modulus + 2.0 / 3.0 * model.c1) / density)


@initialize.register(TransIsoHyper)
@initialize.register(ViscoTransIsoHyper)
def _(model: Fibered, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    state.fiber[...] = model.direction_of_symm


class FiberLaw(NamedTuple):
    """The fibres' energy at a stretch l of constant volume."""

    slope: float
    """dW_f/d(l^2)."""
    stiffness: float
    """What the fibres add to the shear modulus in the estimate of the sound speed."""
    energy: float


@inline
def fiber_law(model: Fibered, stretch: float) -> FiberLaw:
    """Slope and energy by the three ranges of stretch; the energy of crimped fibres by Gauss's rule."""
    taut = stretch >= 1.0
    if not anywhere(taut):
        none = like(0.0, stretch)
        return FiberLaw(none, none, none)
    c3, c4, c5, straight = model.c3, model.c4, model.c5, model.fiber_stretch
    c6 = c3 * (math.exp(c4 * (straight - 1.0)) - 1.0) - c5 * straight
    crimped, beyond = min(max(stretch, 1.0), straight), max(stretch, straight)
    half = 0.5 * (crimped - 1.0)
    energy = c5 * (beyond - straight) + c6 * math.log(beyond / straight)
    for k in range(len(GAUSS_NODES)):
        x = 1.0 + half * (1.0 + GAUSS_NODES[k])
        energy += half * GAUSS_WEIGHTS[k] * c3 * (math.exp(c4 * (x - 1.0)) - 1.0) / x
    rise = math.exp(c4 * (crimped - 1.0))
    straightens = stretch < straight
    slope = where(straightens, 0.5 * c3 * (rise - 1.0) / crimped**2, 0.5 * (c5 + c6 / beyond) / beyond)
    curvature = where(
        straightens,
        0.25 * c3 * (c4 * rise - (rise - 1.0) / crimped) / crimped**3,
        -0.25 * c6 / beyond**4,
    )
    stiffness = stretch**2 * (4.0 * curvature * stretch**2 - 2.0 * slope * stretch)
    return FiberLaw(slope, where(taut, stiffness, 0.0), energy)


@inline
def failure_state(model: Fibered, old: float, F: Tensor, stretch: float) -> float:
    """New failure of the matrix (1), the fibres (2) or both (3); what failed once stays failed."""
    if model.failure_option != 1.0:
        return like(0.0, stretch)
    principal = principal_values(F.T @ F)
    shear = 0.5 * (principal.first - principal.third)
    matrix = (shear > model.max_matrix_strain) | (old == 1.0) | (old == 3.0)
    fibers = (stretch > model.max_fiber_strain) | (old == 2.0) | (old == 3.0)
    return where(matrix, 1.0, 0.0) + where(fibers, 2.0, 0.0)


class ElasticResponse(NamedTuple):
    """What both materials compute from the deformation gradient."""

    stress: Tensor
    shear_modulus: float
    """Effective modulus of the sound speed, three times the usual."""
    energy: float
    """Of unit initial volume."""


@inline
def fibered_response(model: Fibered, state: Any, p: int, F: Tensor) -> ElasticResponse:
    """Elastic stress of particle ``p``; updates its fibre stretch and failure."""
    c1, c2, K = model.c1, model.c2, model.bulk_modulus
    J = determinant(F)
    b = (F @ F.T) * J ** (-2.0 / 3.0)
    b2 = b @ b
    I1 = trace(b)
    I2 = 0.5 * (I1 * I1 - trace(b2))
    a0, a1, a2 = state.fiber[p, 0], state.fiber[p, 1], state.fiber[p, 2]
    x = F.xx * a0 + F.xy * a1 + F.xz * a2
    y = F.yx * a0 + F.yy * a1 + F.yz * a2
    z = F.zx * a0 + F.zy * a1 + F.zz * a2
    fiber = Tensor(x * x, x * y, x * z, x * y, y * y, y * z, x * z, y * z, z * z)
    total_stretch = math.sqrt(trace(fiber))
    stretch = total_stretch * J ** (-1.0 / 3.0)
    law = fiber_law(model, stretch)
    failure = failure_state(model, state.failure[p], F, total_stretch)
    state.stretch[p] = total_stretch
    state.failure[p] = failure

    mean_stress = K * math.log(J) / J
    mean_stress = where(abs(mean_stress) > LEAST_PRESSURE, mean_stress, 0.0)
    matrix = b * (c1 + c2 * I1) - b2 * c2 - isotropic((c1 * I1 + 2.0 * c2 * I2) / 3.0)
    of_matrix = isotropic(mean_stress) + matrix * (2.0 / J)
    of_fibers = deviator(fiber) * (2.0 * law.slope * stretch**2 / (J * total_stretch**2))
    none = isotropic(0.0)
    stress = where((failure == 0.0) | (failure == 2.0), of_matrix, none)
    stress = stress + where((failure == 0.0) | (failure == 1.0), of_fibers, none)
    energy = 0.5 * K * math.log(J) ** 2 + c1 * (I1 - 3.0) + c2 * (I2 - 3.0) + law.energy
    return ElasticResponse(stress, 2.0 * c1 + c2 + law.stiffness, energy)


@inline
def fibered_update(
    model: Fibered, response: ElasticResponse, stress: Tensor, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The update of either material with its stress."""
    J = determinant(point.deformation_gradient)
    density = material.density / J
    K = model.bulk_modulus
    return StressUpdate(
        stress=stress,
        sound_speed=math.sqrt((K + response.shear_modulus / 3.0) / density),
        strain_energy=response.energy * point.volume / J,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(
            step, trace(point.velocity_gradient), math.sqrt(K / density), density
        ),
        localized=point.localized,
    )


@implements(stress_update, TransIsoHyper)
@lanewise
def trans_iso_hyper_stress(
    model: TransIsoHyper, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The elastic response."""
    response = fibered_response(model, state, p, point.deformation_gradient)
    return fibered_update(model, response, response.stress, point, material, step)


@implements(stress_update, ViscoTransIsoHyper)
@lanewise
def visco_trans_iso_hyper_stress(
    model: ViscoTransIsoHyper, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The elastic response and what is remembered of its changes."""
    response = fibered_response(model, state, p, point.deformation_gradient)
    stress = response.stress
    change = response.stress - tensor_at(state.elastic_stress, p)
    put_tensor(state.elastic_stress, p, response.stress)
    weights = (model.y1, model.y2, model.y3, model.y4, model.y5, model.y6)
    times = (model.t1, model.t2, model.t3, model.t4, model.t5, model.t6)
    histories = (
        state.history_1,
        state.history_2,
        state.history_3,
        state.history_4,
        state.history_5,
        state.history_6,
    )
    for k in range(6):
        if model.t1 > 0.0 and times[k] > 0.0:
            decay = math.exp(-step.dt / times[k])
            history = tensor_at(histories[k], p) * decay + change * ((1.0 - decay) * times[k] / step.dt)
            put_tensor(histories[k], p, history)
            stress = stress + history * weights[k]
    return fibered_update(model, response, stress, point, material, step)
