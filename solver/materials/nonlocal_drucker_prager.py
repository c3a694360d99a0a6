"""Drucker and Prager's plasticity whose softening is averaged over a length."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import IntVector, Parameter, Vector, model
from solver.dispatch import implements, inline, lanewise
from solver.grid import GridIndex
from solver.lanes import anywhere, like, where
from solver.materials.constitutive import (
    Material,
    Neighbourhood,
    Point,
    Step,
    StressUpdate,
    artificial_viscosity,
    couple_particles,
    initial_sound_speed,
    initialize,
    numbers_only,
    stress_update,
)
from solver.particles import Array, Particles, StateVariable
from solver.random import musil, turns, weibull, weibull_law
from solver.tensor import (
    Tensor,
    determinant,
    deviator,
    double_dot,
    isotropic,
    put_tensor,
    rotation,
    symmetric,
    tensor_at,
    to_laboratory,
    to_material,
    trace,
)


class NonlocalState(NamedTuple):
    """What a particle remembers, each (n,); the last four hold the start of a step until its end."""

    local_hardening: Annotated[Array, StateVariable("eta")]
    nonlocal_hardening: Annotated[Array, StateVariable("eta_nl")]
    plastic_strain: Annotated[Array, StateVariable("p.plasticStrain")]
    cohesion: Annotated[Array, StateVariable("k_o_dist")]
    trial_stress: Annotated[Array, StateVariable("", "Matrix3", restart=False)]
    """(n, 3, 3) elastic prediction in the turned frame, initial stress included."""
    local_before: Annotated[Array, StateVariable("", restart=False)]
    nonlocal_before: Annotated[Array, StateVariable("", restart=False)]
    strain_before: Annotated[Array, StateVariable("", restart=False)]


@model("constitutive_model", "nonlocal_drucker_prager")
class NonlocalDruckerPrager(NamedTuple):
    """Drucker and Prager's cone with softening by the average of plastic flow over a neighbourhood.

    The stress yields at sqrt(J2) + alpha I1 = k_o + eta + eta_nl. Plastic flow goes along the unit tensor
    alpha_p I + s / (2 sqrt(J2)); its multiplier lambda hardens locally by eta' = h_local lambda', and by
    eta_nl' = h_nonlocal <lambda'>, the mean over distances up to l_nonlocal. So bands of localized shear get a
    width that the grid does not set (Bazant and Jirasek, J. Eng. Mech. 128, 2002; Burghardt, Brannon and
    Guilkey, Int. J. Plasticity 28, 2012). The multipliers of a body are found together, by Jacobi's iteration.

    The mean is taken through the nodes of the grid with Bazant's weight exp(-(k r / l_nonlocal)^2), k^3 =
    6 sqrt(pi), of the distance r. A single point answers like a body that deforms uniformly.

    In Uintah the weight has the sum of the components of the distance in place of r, so that one diagonal counts
    more than the other; particles that only their neighbours weaken feel that twice; a return may pass the tip of
    the cone; the stress does not turn with the body; there is neither artificial viscosity nor energy.
    """

    alpha: Annotated[float, Parameter("slope of the yield surface", ge=0.0)]
    alpha_p: Annotated[float, Parameter("slope of the plastic potential", ge=0.0)]
    k_o: Annotated[float, Parameter("cohesion", unit="Pa", ge=0.0)]
    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", gt=0.0)]
    l_nonlocal: Annotated[float, Parameter("length of the average", unit="m", ge=0.0)] = 0.0
    h_local: Annotated[float, Parameter("local hardening modulus", unit="Pa")] = 0.0
    h_nonlocal: Annotated[float, Parameter("non-local hardening modulus", unit="Pa")] = 0.0
    minimum_yield_stress: Annotated[
        float, Parameter("strength at which softening ends", unit="Pa", ge=0.0)
    ] = 0.0
    initial_xstress: Annotated[float, Parameter("stress in x at the start", unit="Pa")] = 0.0
    initial_ystress: Annotated[float, Parameter("stress in y at the start", unit="Pa")] = 0.0
    initial_zstress: Annotated[float, Parameter("stress in z at the start", unit="Pa")] = 0.0
    hardening_type: Annotated[int, Parameter("law of the hardening", ignored="there is one law only")] = 0
    k_o_dist: Annotated[
        str,
        Parameter(
            "cohesion of particles as 'weibull, mean, modulus, reference volume, seed' in place of k_o"
        ),
    ] = ""

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return NonlocalState

    @property
    def coupling_length(self) -> float:
        """How far from a particle the nodes of its average lie, m."""
        return self.l_nonlocal if self.h_nonlocal != 0.0 else 0.0

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        try:
            weibull_law(self.k_o_dist)
        except ValueError as problem:
            return [("k_o_dist", str(problem))]
        if resistance(self) + min(self.h_local, 0.0) + min(self.h_nonlocal, 0.0) <= 0.0:
            return [("h_nonlocal", "softening is steeper than elastic unloading: no stress would be stable")]
        return []


@initial_sound_speed.register
def _(model: NonlocalDruckerPrager, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.bulk_modulus + 4.0 * model.shear_modulus / 3.0) / density)


@initialize.register
def _(model: NonlocalDruckerPrager, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    state.cohesion[:] = model.k_o
    law = weibull_law(model.k_o_dist)
    if law is None:
        return
    for _, members, turn in turns(patch):
        draws, volume = musil(law.seed, int(turn.max()) + 1)[turn], particles.volume[members]
        state.cohesion[members] = weibull(draws, law.mean, law.modulus, volume, law.volume, law.modulus)


@inline
def flow_size(model: NonlocalDruckerPrager) -> float:
    """Norm of alpha_p I + s / (2 sqrt(J2))."""
    return math.sqrt(0.5 + 3.0 * model.alpha_p * model.alpha_p)


@inline
def resistance(model: NonlocalDruckerPrager) -> float:
    """By how much a unit of the multiplier lowers sqrt(J2) + alpha I1: (G + 9 K alpha alpha_p) / size."""
    cone = 9.0 * model.bulk_modulus * model.alpha * model.alpha_p
    return (model.shear_modulus + cone) / flow_size(model)


@inline
def loading(model: NonlocalDruckerPrager, stress: Tensor) -> float:
    """sqrt(J2) + alpha I1, to be compared with the strength."""
    s = deviator(stress)
    return math.sqrt(0.5 * double_dot(s, s)) + model.alpha * trace(stress)


@inline
def returned(model: NonlocalDruckerPrager, trial: Tensor, multiplier: float, strength: float) -> Tensor:
    """The trial stress less the elastic answer to plastic flow, at most to the tip of the cone."""
    s = deviator(trial)
    size = math.sqrt(0.5 * double_dot(s, s))
    less_shear = model.shear_modulus * multiplier / flow_size(model)
    less_mean = 3.0 * model.bulk_modulus * model.alpha_p * multiplier / flow_size(model)
    left = 1.0 - min(less_shear, size) / where(size > 0.0, size, 1.0)
    stress = left * s + isotropic(trace(trial) / 3.0 - less_mean)
    if model.alpha > 0.0:
        return where(less_shear > size, isotropic(strength / (3.0 * model.alpha)), stress)
    return stress


@inline
def initial_stress(model: NonlocalDruckerPrager) -> Tensor:
    """The stress in which the material was found."""
    x, y, z = model.initial_xstress, model.initial_ystress, model.initial_zstress
    return Tensor(x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z)


class Flow(NamedTuple):
    """Plastic multiplier of a step and what it makes of the hardening."""

    multiplier: float
    local_hardening: float
    nonlocal_hardening: float


@inline
def flow_in(
    model: NonlocalDruckerPrager, state: Any, p: int, load: float, average: float, stiffness: float
) -> Flow:
    """Flow of a particle, given <lambda'>, whose trial stress exceeds its strength by ``load``.

    ``stiffness`` divides the excess. Where the strength would fall below its minimum, hardening stays as it
    is, and the stress returns to the minimum.
    """
    local, wide, cohesion = state.local_before[p], state.nonlocal_before[p], state.cohesion[p]
    multiplier = where(load > 0.0, load / stiffness, 0.0)
    flow = Flow(multiplier, local + model.h_local * multiplier, wide + model.h_nonlocal * average)
    softened = cohesion + flow.local_hardening + flow.nonlocal_hardening < model.minimum_yield_stress
    if anywhere(softened):
        excess = loading(model, tensor_at(state.trial_stress, p)) - model.minimum_yield_stress
        flow = where(softened, Flow(excess / resistance(model), local, wide), flow)
    return flow


@inline
def commit(model: NonlocalDruckerPrager, state: Any, p: int, flow: Flow) -> Tensor:
    """Store the flow of a step, and give the stress after it in the turned frame."""
    state.local_hardening[p] = flow.local_hardening
    state.nonlocal_hardening[p] = flow.nonlocal_hardening
    state.plastic_strain[p] = state.strain_before[p] + flow.multiplier
    strength = state.cohesion[p] + flow.local_hardening + flow.nonlocal_hardening
    strength = max(strength, model.minimum_yield_stress)
    return returned(model, tensor_at(state.trial_stress, p), flow.multiplier, strength)


@implements(stress_update, NonlocalDruckerPrager)
@lanewise
def nonlocal_stress(
    model: NonlocalDruckerPrager, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Elastic prediction, and the return of a body in which all particles flow alike: <lambda'> = lambda'."""
    turned = rotation(point.deformation_gradient_old)
    d = to_material(turned, symmetric(point.velocity_gradient))
    before = to_material(turned, point.stress + initial_stress(model))
    elastic = 2.0 * model.shear_modulus * deviator(d) + isotropic(model.bulk_modulus * trace(d))
    trial = before + step.dt * elastic
    put_tensor(state.trial_stress, p, trial)
    state.local_before[p] = state.local_hardening[p]
    state.nonlocal_before[p] = state.nonlocal_hardening[p]
    state.strain_before[p] = state.plastic_strain[p]
    strength = state.cohesion[p] + state.local_hardening[p] + state.nonlocal_hardening[p]
    excess = loading(model, trial) - max(strength, model.minimum_yield_stress)
    stiffness = resistance(model) + model.h_local + model.h_nonlocal
    flow = Flow(like(0.0, excess), state.local_hardening[p], state.nonlocal_hardening[p])
    flows = excess > 0.0
    if anywhere(flows):
        flow = where(flows, flow_in(model, state, p, excess, excess / stiffness, stiffness), flow)
    turn = rotation(point.deformation_gradient)
    stress = to_laboratory(turn, commit(model, state, p, flow)) - initial_stress(model)
    modulus = model.bulk_modulus + 4.0 * model.shear_modulus / 3.0
    density = material.density / determinant(point.deformation_gradient)
    work = double_dot(symmetric(point.velocity_gradient), 0.5 * (stress + point.stress))
    return StressUpdate(
        stress=stress,
        sound_speed=math.sqrt(modulus / density),
        strain_energy=work * point.volume * step.dt,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(
            step, trace(d), math.sqrt(model.bulk_modulus / density), density
        ),
        localized=point.localized,
    )


@couple_particles.register
def _(model: NonlocalDruckerPrager, state: Any, particles: Particles, neighbourhood: Neighbourhood) -> float:
    """The stresses with <lambda'> taken over the neighbourhood; nothing changes without such hardening."""
    if model.h_nonlocal == 0.0:
        return 0.0
    from solver.materials.kernels.nonlocal_average import find_multipliers, half_power

    before = half_power(particles)
    find_multipliers(numbers_only(model), state, particles, neighbourhood)
    return (half_power(particles) - before) * neighbourhood.dt


WEIGHT = (6.0 * math.sqrt(math.pi)) ** (1.0 / 3.0)
"""k of the weight exp(-(k r / l_nonlocal)^2)."""


@inline
def place_in(i: int, first: int, nodes: int, repeat: int) -> int:
    """Where node ``i`` of a direction is stored, or its image where nodes repeat; -1 where neither is."""
    at = (i % repeat if repeat > 0 else i) - first
    return at if 0 <= at < nodes else -1


@inline
def mean_around(
    model: NonlocalDruckerPrager,
    grid: GridIndex,
    repeats: IntVector,
    at: Vector,
    weights: Any,
    flows: Any,
    own: float,
) -> float:
    """<lambda'> at a place: the weighted mean over the nodes within l_nonlocal, of the sums (N,) of S and lambda S.

    ``own`` is the answer where the length is less than half a cell.
    """
    reach, h = model.l_nonlocal, grid.spacing
    if min(h[0], h[1], h[2]) > 2.0 * reach:
        return own
    qx, qy, qz = (
        (at[0] - grid.anchor[0]) / h[0],
        (at[1] - grid.anchor[1]) / h[1],
        (at[2] - grid.anchor[2]) / h[2],
    )
    lx, ly, lz = reach / h[0], reach / h[1], reach / h[2]
    total = weight = 0.0
    for k in range(math.floor(qz - lz), math.ceil(qz + lz) + 1):
        w = place_in(k, grid.first[2], grid.nodes[2], repeats[2])
        for j in range(math.floor(qy - ly), math.ceil(qy + ly) + 1):
            v = place_in(j, grid.first[1], grid.nodes[1], repeats[1])
            if w < 0 or v < 0:
                continue
            for i in range(math.floor(qx - lx), math.ceil(qx + lx) + 1):
                u = place_in(i, grid.first[0], grid.nodes[0], repeats[0])
                if u < 0:
                    continue
                node = u + grid.nodes[0] * (v + grid.nodes[1] * w)
                r2 = ((qx - i) / lx) ** 2 + ((qy - j) / ly) ** 2 + ((qz - k) / lz) ** 2
                share = math.exp(-WEIGHT * WEIGHT * r2) * weights[node]
                weight += share
                if weights[node] > 1.0e-10:
                    total += share * flows[node] / weights[node]
    return total / weight
