"""Modified Cam clay with Borja's pressure-dependent elasticity, at finite strain."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple, TypeAlias

import numpy as np

from solver.declare import Parameter, model
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
from solver.particles import Array, Particles, StateVariable
from solver.spectral import compose, spectrum
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

MOST_ITERATIONS = 60
MOST_HALVINGS = 19
TOLERANCE = 1.0e-13
"""Sum of the residuals: strains, and the yield function over the square of the preconsolidation."""


class CamClayState(NamedTuple):
    """What a particle remembers."""

    elastic_strain: Annotated[Array, StateVariable("p.elasticStrain", "Matrix3")]
    """(n, 3, 3) logarithmic elastic strain, 1/2 ln b_e, in the laboratory frame."""
    preconsolidation: Annotated[Array, StateVariable("p.p_c")]
    """(n,) pc, negative."""
    multiplier: Annotated[Array, StateVariable("p.deltaGamma")]
    """(n,) sum of the plastic multipliers, 1/Pa."""


ReferencePressure: TypeAlias = Annotated[
    float, Parameter("reference pressure, negative in compression", unit="Pa", lt=0.0)
]
Coupling: TypeAlias = Annotated[float, Parameter("coupling of shear and pressure", ge=0.0)]
Unloading: TypeAlias = Annotated[float, Parameter("slope of unloading, of strain over ln(p)", gt=0.0)]
ReferenceStrain: TypeAlias = Annotated[float, Parameter("elastic volume strain at the reference pressure")]


class BorjaPressure(NamedTuple):
    """Mean stress p = p0 (1 + 3 alpha e_s^2 / (2 kappa)) exp(-(e_v - e_v0) / kappa)."""

    type: Annotated[str, Parameter("the model", choices=("borja_pressure",), attribute=True)]
    p0: ReferencePressure
    alpha: Coupling
    kappatilde: Unloading
    epse_v0: ReferenceStrain


class BorjaShear(NamedTuple):
    """Shear stress q = 3 (mu0 - alpha p0 exp(-(e_v - e_v0) / kappa)) e_s."""

    type: Annotated[str, Parameter("the model", choices=("borja_shear_modulus",), attribute=True)]
    mu0: Annotated[float, Parameter("shear modulus without pressure", unit="Pa", ge=0.0)]
    p0: ReferencePressure
    alpha: Coupling
    kappatilde: Unloading
    epse_v0: ReferenceStrain


class CamClayYield(NamedTuple):
    """The ellipse q^2 / M^2 + p (p - pc) = 0."""

    type: Annotated[str, Parameter("the model", choices=("camclay_yield_function",), attribute=True)]
    M: Annotated[float, Parameter("slope of the critical state line, q / p", gt=0.0)]


class Consolidation(NamedTuple):
    """Preconsolidation pc' = -pc e_vp' / (lambda - kappa), with the plastic volume strain e_vp."""

    type: Annotated[str, Parameter("the model", choices=("borja_consolidation_pressure",), attribute=True)]
    pc0: Annotated[float, Parameter("at the start, negative", unit="Pa", lt=0.0)]
    lambdatilde: Annotated[float, Parameter("slope of loading, of strain over ln(p)", gt=0.0)]
    kappatilde: Unloading


@model("constitutive_model", "camclay")
class CamClay(NamedTuple):
    """Modified Cam clay (Roscoe and Burland 1968) after Borja and Tamagnini.

    With the invariants e_v, e_s of the logarithmic elastic strain e = 1/2 ln b_e, and p, q of the Kirchhoff
    stress tau = J sigma, positive in tension: elasticity from the energy

        psi = -kappa p0 exp(-(e_v - e_v0) / kappa) + 3/2 mu(e_v) e_s^2,

    associated flow on the ellipse, and an implicit return in (e_v, e_s, multiplier). Borja and Tamagnini,
    Comput. Methods Appl. Mech. Engrg. 155 (1998). The start is free of strain, not of stress. Uintah's tag, which
    its program no longer accepts; there strains were integrated from rates, with p and q of the Cauchy stress.
    """

    pressure_model: Annotated[BorjaPressure, Parameter("law of the mean stress")]
    elastic_shear_modulus_model: Annotated[BorjaShear, Parameter("law of the shear stress")]
    plastic_yield_condition: Annotated[CamClayYield, Parameter("the yield surface")]
    internal_variable_model: Annotated[Consolidation, Parameter("its growth")]

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return CamClayState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        pressure, shear = self.pressure_model, self.elastic_shear_modulus_model
        growth = self.internal_variable_model
        if pressure[1:] != shear[2:]:
            message = (
                "p0, alpha, kappatilde and epse_v0 must be those of pressure_model: they are of one energy"
            )
            return [("elastic_shear_modulus_model", message)]
        if growth.kappatilde != pressure.kappatilde:
            return [("internal_variable_model", "kappatilde must be that of pressure_model")]
        if growth.lambdatilde <= growth.kappatilde:
            return [("internal_variable_model", "lambdatilde must exceed kappatilde")]
        if yield_value(self, elastic_stress(self, 0.0, 0.0), growth.pc0) > 0.0:
            message = "pc0 must lie beyond the pressure of the start, p0 exp(epse_v0 / kappatilde)"
            return [("internal_variable_model", message)]
        return []


class Elastic(NamedTuple):
    """Mean and shear stress at some elastic strain, with their slopes."""

    p: float
    q: float
    p_by_volume: float
    q_by_volume: float
    """Also the slope of p over e_s."""
    q_by_shear: float
    energy: float


@inline
def elastic_stress(model: CamClay, volume: float, shear: float) -> Elastic:
    """Mean and shear stress at the invariants e_v, e_s of the elastic strain."""
    law = model.pressure_model
    mu0 = model.elastic_shear_modulus_model.mu0
    reference = law.p0 * math.exp(-(volume - law.epse_v0) / law.kappatilde)
    mu = mu0 - law.alpha * reference
    p = reference * (1.0 + 1.5 * law.alpha * shear * shear / law.kappatilde)
    return Elastic(
        p=p,
        q=3.0 * mu * shear,
        p_by_volume=-p / law.kappatilde,
        q_by_volume=3.0 * law.alpha * reference * shear / law.kappatilde,
        q_by_shear=3.0 * mu,
        energy=-law.kappatilde * reference + 1.5 * mu * shear * shear,
    )


@inline
def yield_value(model: CamClay, at: Elastic, preconsolidation: float) -> float:
    """q^2 / M^2 + p (p - pc), over pc^2."""
    M = model.plastic_yield_condition.M
    return ((at.q / M) ** 2 + at.p * (at.p - preconsolidation)) / preconsolidation**2


@initial_sound_speed.register
def _(model: CamClay, density: Any, temperature: Any) -> Any:
    start = elastic_stress(model, 0.0, 0.0)
    return np.sqrt((start.p_by_volume + 4.0 / 9.0 * start.q_by_shear) / density)


@initialize.register
def _(model: CamClay, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    particles.stress[:] = elastic_stress(model, 0.0, 0.0).p * np.eye(3)
    state.preconsolidation[:] = model.internal_variable_model.pc0


class Return(NamedTuple):
    """Where the return to the ellipse ends."""

    volume: float
    shear: float
    multiplier: float
    preconsolidation: float


class Residual(NamedTuple):
    """How far a point is from the end of the return, with what Newton's step needs."""

    volume: float
    shear: float
    yielding: float
    size: float
    at: Elastic
    preconsolidation: float


@inline
def residual(
    model: CamClay, trial_volume: float, trial_shear: float, start: float, x: float, y: float, z: float
) -> Residual:
    """The equations at e_v = x, e_s = y and the multiplier z (made dimensionless by pc at the start)."""
    growth, M = model.internal_variable_model, model.plastic_yield_condition.M
    at = elastic_stress(model, x, y)
    pc = start * math.exp((x - trial_volume) / (growth.lambdatilde - growth.kappatilde))
    volume = x - trial_volume + z * (2.0 * at.p - pc) / start
    shear = y - trial_shear + z * 2.0 * at.q / (M * M * start)
    yielding = ((at.q / M) ** 2 + at.p * (at.p - pc)) / (start * start)
    return Residual(volume, shear, yielding, abs(volume) + abs(shear) + abs(yielding), at, pc)


@inline
def return_to_ellipse(model: CamClay, trial_volume: float, trial_shear: float, start: float) -> Return:
    """Newton's iteration with halved steps where the residual grows; ``start`` is pc before the step."""
    growth, M2 = model.internal_variable_model, model.plastic_yield_condition.M**2
    x, y, z = trial_volume, trial_shear, like(0.0, trial_volume)
    r = residual(model, trial_volume, trial_shear, start, x, y, z)
    for _ in range(MOST_ITERATIONS):
        goes_on = r.size >= TOLERANCE
        if not anywhere(goes_on):
            break
        at, pc = r.at, r.preconsolidation
        pc_slope = pc / (growth.lambdatilde - growth.kappatilde)
        f_p, f_q = (2.0 * at.p - pc) / start, 2.0 * at.q / (M2 * start)
        vv = 1.0 + z * (2.0 * at.p_by_volume - pc_slope) / start
        vs = 2.0 * z * at.q_by_volume / start
        sv = 2.0 * z * at.q_by_volume / (M2 * start)
        ss = 1.0 + 2.0 * z * at.q_by_shear / (M2 * start)
        fv = (f_q * at.q_by_volume + f_p * at.p_by_volume - at.p * pc_slope / start) / start
        fs = (f_q * at.q_by_shear + f_p * at.q_by_volume) / start
        area = vv * ss - vs * sv
        along_v, along_s = (ss * f_p - vs * f_q) / area, (vv * f_q - sv * f_p) / area
        rest_v = (ss * r.volume - vs * r.shear) / area
        rest_s = (vv * r.shear - sv * r.volume) / area
        dz = (r.yielding - fv * rest_v - fs * rest_s) / (fv * along_v + fs * along_s)
        dx, dy = -rest_v - along_v * dz, -rest_s - along_s * dz
        to_x, to_y, to_z = x + dx, max(y + dy, 0.0), z + dz
        better = residual(model, trial_volume, trial_shear, start, to_x, to_y, to_z)
        part = like(1.0, x)
        for _ in range(MOST_HALVINGS):
            worse = goes_on & negation(better.size < r.size)
            if not anywhere(worse):
                break
            part = where(worse, 0.5 * part, part)
            to_x, to_y, to_z = x + part * dx, max(y + part * dy, 0.0), z + part * dz
            better = residual(model, trial_volume, trial_shear, start, to_x, to_y, to_z)
        x, y, z = where(goes_on, to_x, x), where(goes_on, to_y, y), where(goes_on, to_z, z)
        r = where(goes_on, better, r)
    return Return(x, y, z / start, r.preconsolidation)


@inline
def carried_strain(strain: Tensor, F_old: Tensor, F: Tensor) -> Tensor:
    """1/2 ln(f b f^T) with f = F F_old^-1 and b = exp(2 strain)."""
    f = F @ inverse(F_old)
    e = spectrum(strain)
    b = compose(math.exp(2.0 * e.first), math.exp(2.0 * e.second), math.exp(2.0 * e.third), e.axes)
    t = spectrum(f @ b @ f.T)
    return compose(0.5 * math.log(t.first), 0.5 * math.log(t.second), 0.5 * math.log(t.third), t.axes)


@implements(stress_update, CamClay)
@lanewise
def cam_clay_stress(
    model: CamClay, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Elastic strain carried along, then returned to the ellipse; the energy is what is stored."""
    J = determinant(point.deformation_gradient)
    possible = (J > 0.0) & (math.inf > J)
    F = where(possible, point.deformation_gradient, point.deformation_gradient_old)
    localized = where(possible, point.localized, DELETE)
    J = determinant(F)
    strain = carried_strain(tensor_at(state.elastic_strain, p), point.deformation_gradient_old, F)
    volume, shear = trace(strain), math.sqrt(2.0 / 3.0) * norm(deviator(strain))
    direction = deviator(strain) / where(shear > 0.0, shear, 1.0)
    pc = state.preconsolidation[p]
    yields = yield_value(model, elastic_stress(model, volume, shear), pc) > TOLERANCE
    if anywhere(yields):
        new = return_to_ellipse(model, volume, shear, pc)
        volume, shear = where(yields, new.volume, volume), where(yields, new.shear, shear)
        pc = where(yields, new.preconsolidation, pc)
        state.multiplier[p] += where(yields, new.multiplier, 0.0)
        strain = where(yields, direction * shear + isotropic(volume / 3.0), strain)
    put_tensor(state.elastic_strain, p, strain)
    state.preconsolidation[p] = pc
    at = elastic_stress(model, volume, shear)
    tau = direction * (2.0 / 3.0 * at.q) + isotropic(at.p)
    density = material.density / J
    bulk = max(at.p_by_volume, 0.0)
    return StressUpdate(
        stress=tau / J,
        sound_speed=math.sqrt((bulk + 4.0 / 9.0 * at.q_by_shear) / material.density),
        strain_energy=at.energy * point.volume / J,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(
            step, trace(point.velocity_gradient), math.sqrt(bulk / density), density
        ),
        localized=localized,
    )
