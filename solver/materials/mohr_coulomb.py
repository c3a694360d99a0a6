"""Mohr-Coulomb soil with an exact return to the yield surface."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, inline, lanewise
from solver.lanes import anywhere, where
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
from solver.spectral import compose, spectrum
from solver.tensor import (
    Tensor,
    determinant,
    double_dot,
    isotropic,
    principal_values,
    rotation,
    symmetric,
    trace,
)

YIELD_TOLERANCE = 1.0e-10
"""Overstress, over the size of the stresses, that counts as elastic."""

WAVE_MODULUS_FACTOR = 5.0
"""The modulus of the sound speed is this times (G + 0.3 K) / 3, as in Uintah."""

SOFTENING_BASE = 2.71
"""The base that Uintah takes for e in the softening law."""

_INTERNAL = "a state variable, written to archives and set by the model"


class SoilState(NamedTuple):
    """What a particle remembers, each (n,); saved under bare names as in Uintah."""

    shear_modulus: Annotated[Array, StateVariable("G")]
    bulk_modulus: Annotated[Array, StateVariable("K")]
    cohesion: Annotated[Array, StateVariable("c")]
    suction: Annotated[Array, StateVariable("Suction")]
    specific_volume: Annotated[Array, StateVariable("SpecificVol")]
    shear_strain: Annotated[Array, StateVariable("shear_strain")]
    shear_strain_rate: Annotated[Array, StateVariable("shear_strain_rate")]
    strain_xx: Annotated[Array, StateVariable("strain11")]
    strain_yy: Annotated[Array, StateVariable("strain22")]
    strain_zz: Annotated[Array, StateVariable("strain33")]
    strain_xy: Annotated[Array, StateVariable("strain12")]
    strain_yz: Annotated[Array, StateVariable("strain23")]
    strain_xz: Annotated[Array, StateVariable("strain13")]
    height: Annotated[Array, StateVariable("y")]


@model("constitutive_model", "MohrCoulomb")
class MohrCoulomb(NamedTuple):
    """Linear elasticity within the Mohr-Coulomb surface, with a dilation angle of its own for the flow.

    With principal stresses s1 >= s2 >= s3, tension positive, and k = (1 + sin Phi) / (1 - sin Phi) the
    surface is k s1 - s3 = 2 c sqrt(k). An elastic trial stress outside returns to the face, an edge or the
    apex by the regions of Clausen, Damkilde and Andersen (Int. J. Numer. Meth. Eng. 66, 2006). The cohesion
    may depend on strain rate and water content, height, strain (softening) and suction. As in Uintah stress
    does not turn with the body; here the energy is the work in the fixed frame.
    """

    G: Annotated[float, Parameter("shear modulus", unit="Pa", gt=0.0)]
    K: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    Phi: Annotated[float, Parameter("friction angle", unit="degree", gt=0.0, lt=90.0)]
    Version: Annotated[
        float,
        Parameter("11 or 12, the exact return; Uintah's explicit schemes are not offered", ge=11.0, le=12.0),
    ]
    c: Annotated[float, Parameter("cohesion", unit="Pa", ge=0.0)] = 0.0
    Psi: Annotated[float, Parameter("dilation angle", unit="degree", ge=0.0, lt=90.0)] = 0.0
    Usetransition: Annotated[float, Parameter("1: cohesion from water content and strain rate")] = 0.0
    St: Annotated[float, Parameter("sensitivity: scale of that cohesion, and intact over remoulded")] = 0.0
    A1: Annotated[float, Parameter("factor of cohesion over water content")] = 0.0
    B1: Annotated[float, Parameter("exponent of cohesion over water content")] = 0.0
    W: Annotated[float, Parameter("water content", ge=0.0)] = 0.0
    beta_rate: Annotated[float, Parameter("exponent of the shear strain rate")] = 0.0
    strain_ref: Annotated[
        float, Parameter("shear strain rate above which the rate matters", unit="1/s", ge=0.0)
    ] = 0.0
    Use_linear: Annotated[float, Parameter("1: cohesion grows linearly with height")] = 0.0
    a: Annotated[float, Parameter("slope of cohesion over height", unit="Pa/m")] = 0.0
    y_ref: Annotated[float, Parameter("height at which the cohesion is the given one", unit="m")] = 0.0
    y: Annotated[float, Parameter("height of all particles, unless n is 1", unit="m")] = 0.0
    n: Annotated[float, Parameter("1: heights are the y of the particles at the start", ge=0.0, le=1.0)] = 0.0
    Usemodul: Annotated[float, Parameter("1: moduli in proportion to the cohesion")] = 0.0
    m_modul: Annotated[float, Parameter("Young's modulus over cohesion")] = 0.0
    nuy: Annotated[float, Parameter("Poisson ratio of those moduli", gt=-1.0, lt=0.5)] = 0.0
    Use_softening: Annotated[float, Parameter("1: cohesion falls with plastic shear strain")] = 0.0
    strain_95: Annotated[float, Parameter("shear strain of 95 % of the softening", ge=0.0)] = 0.0
    Use_regular: Annotated[
        float, Parameter("1: scale shear strains beyond the elastic limit by tFE / tShear")
    ] = 0.0
    tFE: Annotated[float, Parameter("size of the cells", unit="m")] = 0.0
    tShear: Annotated[float, Parameter("width of shear bands", unit="m")] = 0.0
    UseWaterRetention: Annotated[float, Parameter("1: suction (van Genuchten 1980) adds to the cohesion")] = (
        0.0
    )
    WR_Param1: Annotated[float, Parameter("exponent m of van Genuchten")] = 0.0
    WR_Param2: Annotated[float, Parameter("exponent n of van Genuchten")] = 0.0
    WR_Param3: Annotated[float, Parameter("scale alpha of van Genuchten", unit="1/Pa")] = 0.0
    WR_Param4: Annotated[float, Parameter("a parameter", ignored="van Genuchten's law has three")] = 0.0
    PhiB: Annotated[float, Parameter("angle of cohesion over suction (Fredlund)", unit="degree")] = 0.0
    suction: Annotated[float, Parameter("suction at the start", unit="Pa", ge=0.0)] = 0.0
    SpecVol: Annotated[float, Parameter("specific volume (1 + void ratio) at the start", ge=0.0)] = 0.0
    strain11: Annotated[float, Parameter("strain at the start, xx")] = 0.0
    strain22: Annotated[float, Parameter("strain at the start, yy")] = 0.0
    strain33: Annotated[float, Parameter("strain at the start, zz")] = 0.0
    strain12: Annotated[float, Parameter("strain at the start, xy")] = 0.0
    strain23: Annotated[float, Parameter("strain at the start, yz")] = 0.0
    strain13: Annotated[float, Parameter("strain at the start, xz")] = 0.0
    shear_strain: Annotated[float, Parameter("shear strain", ignored=_INTERNAL)] = 0.0
    shear_strain_rate: Annotated[float, Parameter("shear strain rate", ignored=_INTERNAL)] = 0.0
    s_xx: Annotated[float, Parameter("stress", unit="Pa", ignored=_INTERNAL)] = 0.0
    s_yy: Annotated[float, Parameter("stress", unit="Pa", ignored=_INTERNAL)] = 0.0
    s_xy: Annotated[float, Parameter("stress", unit="Pa", ignored=_INTERNAL)] = 0.0
    Ko: Annotated[float, Parameter("ratio of stresses", ignored=_INTERNAL)] = 0.0
    beta: Annotated[float, Parameter("exponent", ignored="the exponent of the rate is <beta_rate>")] = 0.0
    n_nonlocalMC: Annotated[
        float, Parameter("weight", ignored="Uintah's nonlocal averages are switched off")
    ] = 0.0
    l_nonlocal: Annotated[
        float, Parameter("length", ignored="Uintah's nonlocal averages are switched off")
    ] = 0.0

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return SoilState


@initial_sound_speed.register
def _(model: MohrCoulomb, density: Any, temperature: Any) -> Any:
    return np.sqrt((model.K + 4.0 * model.G / 3.0) / density)


@initialize.register
def _(model: MohrCoulomb, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    state.shear_modulus[...] = model.G
    state.bulk_modulus[...] = model.K
    state.cohesion[...] = model.c
    state.suction[...] = model.suction
    state.specific_volume[...] = model.SpecVol
    state.strain_xx[...] = model.strain11
    state.strain_yy[...] = model.strain22
    state.strain_zz[...] = model.strain33
    state.strain_xy[...] = model.strain12
    state.strain_yz[...] = model.strain23
    state.strain_xz[...] = model.strain13
    state.height[...] = particles.position[:, 1] if model.n >= 1.0 else model.y


class Soil(NamedTuple):
    """Constants of a particle in this step."""

    shear_modulus: float
    bulk_modulus: float
    cohesion: float


@inline
def shear_measure(xx: float, yy: float, zz: float, xy: float, yz: float, xz: float) -> float:
    """The scalar by which Uintah measures shear strains and their rates."""
    normal = (xx - yy) ** 2 + (xx - zz) ** 2 + (yy - zz) ** 2
    return 0.5 * math.sqrt(2.0 * normal + 3.0 * (xy * xy + xz * xz + yz * yz))


@inline
def accumulate_strain(state: Any, p: int, d: Tensor, dt: float) -> None:
    """Add the step's strain, in the turned frame, and measure strain and rate."""
    state.strain_xx[p] += d.xx * dt
    state.strain_yy[p] += d.yy * dt
    state.strain_zz[p] += d.zz * dt
    state.strain_xy[p] += d.xy * dt
    state.strain_yz[p] += d.yz * dt
    state.strain_xz[p] += d.zx * dt
    state.shear_strain_rate[p] = shear_measure(d.xx, d.yy, d.zz, d.xy, d.yz, d.zx)
    state.shear_strain[p] = shear_measure(
        state.strain_xx[p],
        state.strain_yy[p],
        state.strain_zz[p],
        state.strain_xy[p],
        state.strain_yz[p],
        state.strain_xz[p],
    )


@inline
def saturation(model: MohrCoulomb, suction: float) -> float:
    """Degree of saturation over suction (van Genuchten 1980)."""
    return min((1.0 / (1.0 + (model.WR_Param3 * suction) ** model.WR_Param2)) ** model.WR_Param1, 1.0)


@inline
def suction_after(model: MohrCoulomb, state: Any, p: int, volume_strain: float) -> float:
    """Suction once the pores have changed their volume around the same water; updates the specific volume."""
    old = state.specific_volume[p]
    new = old * (1.0 + volume_strain)
    water = saturation(model, state.suction[p]) * (old - 1.0) / old
    filled = min(max(water / ((new - 1.0) / new), 0.0001), 0.99999)
    root = filled ** (1.0 / model.WR_Param1)
    state.specific_volume[p] = new
    return max(((1.0 - root) / root) ** (1.0 / model.WR_Param2) / model.WR_Param3, 0.0)


@inline
def soil_of(model: MohrCoulomb, state: Any, p: int, volume_strain: float) -> Soil:
    """Cohesion and moduli by the options that are on, in Uintah's order."""
    strain, rate = state.shear_strain[p], state.shear_strain_rate[p]
    if model.Use_regular > 0.0:
        share = where(strain > state.cohesion[p] / state.shear_modulus[p], model.tFE / model.tShear, 1.0)
        strain *= share
        rate *= share
    G, K, c = model.G, model.K, model.c
    if model.Usetransition > 0.0:
        c = model.St * model.A1 * model.W**-model.B1
        c = c * where(rate > model.strain_ref, rate / model.strain_ref, 1.0) ** model.beta_rate
    if model.Use_linear > 0.0:
        c += model.a * (state.height[p] - model.y_ref)
    if model.Usemodul > 0.0:
        G = model.m_modul * c / 2.0 / (1.0 + model.nuy)
        K = model.m_modul * c / 3.0 / (1.0 - 2.0 * model.nuy)
    if model.Use_softening > 0.0:
        remoulded = 1.0 / model.St
        left = remoulded + (1.0 - remoulded) * SOFTENING_BASE ** (-3.0 * strain / model.strain_95)
        c = c * where(strain > c / G, left, 1.0)
    if model.UseWaterRetention == 1.0:
        state.suction[p] = suction_after(model, state, p, volume_strain)
        c += math.tan(math.radians(model.PhiB)) * state.suction[p]
    state.shear_modulus[p] = G
    state.bulk_modulus[p] = K
    state.cohesion[p] = c
    return Soil(G, K, c)


class Triple(NamedTuple):
    """A vector of principal stresses, tension positive, largest first."""

    x: float
    y: float
    z: float


@inline
def dot(a: Triple, b: Triple) -> float:
    """Scalar product."""
    return a.x * b.x + a.y * b.y + a.z * b.z


@inline
def cross(a: Triple, b: Triple) -> Triple:
    """Vector product."""
    return Triple(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@inline
def return_direction(soil: Soil, normal: Triple, flow: Triple) -> Triple:
    """De b / (a . De b): stress taken off for a unit of overstress of the plane a with the flow b."""
    lame = soil.bulk_modulus - 2.0 / 3.0 * soil.shear_modulus
    volume = lame * (flow.x + flow.y + flow.z)
    G = soil.shear_modulus
    elastic = Triple(volume + 2.0 * G * flow.x, volume + 2.0 * G * flow.y, volume + 2.0 * G * flow.z)
    size = dot(normal, elastic)
    return Triple(elastic.x / size, elastic.y / size, elastic.z / size)


@inline
def return_to_surface(soil: Soil, sin_phi: float, sin_psi: float, s: Triple) -> Triple:
    """Stress on the face, an edge or the apex that belongs to a trial stress outside."""
    k = (1.0 + sin_phi) / (1.0 - sin_phi)
    m = (1.0 + sin_psi) / (1.0 - sin_psi)
    peak = 2.0 * soil.cohesion * math.sqrt(k) / (k - 1.0)
    above = Triple(s.x - peak, s.y - peak, s.z - peak)
    face = return_direction(soil, Triple(k, 0.0, -1.0), Triple(m, 0.0, -1.0))
    compressed = return_direction(soil, Triple(0.0, k, -1.0), Triple(0.0, m, -1.0))
    extended = return_direction(soil, Triple(k, -1.0, 0.0), Triple(m, -1.0, 0.0))
    first_edge, second_edge = Triple(1.0, 1.0, k), Triple(1.0, k, k)
    normal = cross(face, compressed)
    first = dot(normal, above) / dot(normal, first_edge)
    normal = cross(face, extended)
    second = dot(normal, above) / dot(normal, second_edge)
    excess = k * s.x - s.z - 2.0 * soil.cohesion * math.sqrt(k)
    on_face = Triple(s.x - excess * face.x, s.y - excess * face.y, s.z - excess * face.z)
    on_first_edge = Triple(peak + first, peak + first, peak + first * k)
    on_second_edge = Triple(peak + second, peak + second * k, peak + second * k)
    beyond_second = dot(cross(face, second_edge), above) > 0.0
    beyond_first = dot(cross(face, first_edge), above) < 0.0
    beyond_both = (first > 0.0) & (second > 0.0)
    returned = where(beyond_second, on_second_edge, on_face)
    returned = where(beyond_first, on_first_edge, returned)
    return where(beyond_both, Triple(peak, peak, peak), returned)


@inline
def plastic_stress(model: MohrCoulomb, soil: Soil, trial: Tensor) -> Tensor:
    """The trial stress, returned to the surface if it lies outside."""
    sin_phi, cos_phi = math.sin(math.radians(model.Phi)), math.cos(math.radians(model.Phi))
    largest, _, least = principal_values(trial)
    overstress = (largest - least) + (largest + least) * sin_phi - 2.0 * soil.cohesion * cos_phi
    outside = overstress > YIELD_TOLERANCE * (abs(largest) + abs(least) + 2.0 * soil.cohesion)
    if not anywhere(outside):
        return trial
    sin_psi = math.sin(math.radians(model.Psi))
    s = spectrum(trial)
    returned = return_to_surface(soil, sin_phi, sin_psi, Triple(s.first, s.second, s.third))
    return where(outside, compose(returned.x, returned.y, returned.z, s.axes), trial)


@implements(stress_update, MohrCoulomb)
@lanewise
def mohr_coulomb_stress(
    model: MohrCoulomb, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Elastic trial and return; the energy is the work done in the step."""
    d = symmetric(point.velocity_gradient)
    R = rotation(point.deformation_gradient)
    accumulate_strain(state, p, R.T @ d @ R, step.dt)
    soil = soil_of(model, state, p, trace(d) * step.dt)
    lame = soil.bulk_modulus - 2.0 / 3.0 * soil.shear_modulus
    increment = isotropic(lame * trace(d)) + 2.0 * soil.shear_modulus * d
    stress = plastic_stress(model, soil, point.stress + increment * step.dt)
    density = material.density / determinant(point.deformation_gradient)
    wave_modulus = WAVE_MODULUS_FACTOR * (soil.shear_modulus + 0.3 * soil.bulk_modulus) / 3.0
    return StressUpdate(
        stress=stress,
        sound_speed=math.sqrt(wave_modulus / density),
        strain_energy=double_dot(d, 0.5 * (stress + point.stress)) * point.volume * step.dt,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(step, trace(d), math.sqrt(model.K / density), density),
        localized=point.localized,
    )
