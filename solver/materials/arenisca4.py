"""Arenisca, fourth version: porous rock whose strength depends on the Lode angle."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, inline
from solver.materials.arenisca import parameters as of_rock
from solver.materials.arenisca.elasticity import Moduli, least_stiffness, stiffest
from solver.materials.arenisca.faults import faults_of
from solver.materials.arenisca.invariants import Invariants, invariants
from solver.materials.arenisca.parameters import CapState
from solver.materials.arenisca.return_mapping import (
    BISECTED,
    PATIENCE,
    Returned,
    deviator_stretch,
    inner_point,
    is_yielding,
    return_to_surface,
)
from solver.materials.arenisca.step import counts_from_current_moduli, step_fineness
from solver.materials.arenisca.update import Bounds, bounds_after, cap_model_stress, start_state
from solver.materials.arenisca.yield_surface import Surface, is_outside
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    initial_sound_speed,
    initialize,
    stress_update,
)
from solver.particles import Particles
from solver.spectral import compose, spectrum
from solver.tensor import Tensor, deviator, isotropic, norm, trace

TURNS = 40
"""How many directions are tried before a point counts as the closest."""

TURNS_TAKEN_BACK = 2
"""A point found inside goes back by so many directions."""

TURN = 0.7116445185561306
"""Angle about the line to the trial stress from one direction to the next, that of Uintah's table."""

EQUAL = 1.0e-10
"""Principal stresses that differ by this part of their size are one, without axes of their own."""

TILTS = 0.5 * math.pi * 2.0 ** (-0.25 * np.arange(TURNS))
ALONG = np.cos(TILTS)
ACROSS_X = np.sin(TILTS) * np.cos(TURN * np.arange(TURNS))
ACROSS_Y = np.sin(TILTS) * np.sin(TURN * np.arange(TURNS))
"""Directions that spiral in on the line from the trial stress to a point of the surface."""


@model("constitutive_model", "Arenisca4")
class Arenisca4(NamedTuple):
    """Arenisca3 with a yield surface that is not round: sqrt(J2) is scaled by a function of the Lode angle.

    With sin 3 theta = -J3 / 2 (3 / J2)^(3/2) the factor is that of Gudehus, (1 + s + (1 - s) / psi) / 2 with
    s = sin 3 theta, or of Mohr and Coulomb, 2 sqrt(3) / (3 - sin phi) (cos theta - sin phi sin theta /
    sqrt(3)) with sin phi = 3 (1 - psi) / (1 + psi). The closest point is sought among the principal stresses.
    Uintah multiplies the strength by the factor, which turns the corners of the Mohr-Coulomb surface inwards;
    here sqrt(J2) is multiplied (Brannon, Fossum and Strack, Kayenta, Sandia report SAND2009-2282).
    """

    PEAKI1: of_rock.PeakI1
    FSLOPE: of_rock.Fslope
    STREN: of_rock.Stren
    YSLOPE: of_rock.Yslope
    BETA_nonassociativity: of_rock.Beta
    B0: of_rock.B0
    B1: of_rock.B1
    B2: of_rock.B2
    B3: of_rock.B3
    B4: of_rock.B4
    G0: of_rock.G0
    G1: of_rock.G1
    G2: of_rock.G2
    G3: of_rock.UnusedShear
    G4: of_rock.UnusedShear
    p0_crush_curve: of_rock.P0
    p1_crush_curve: of_rock.P1
    p2_crush_curve: of_rock.P2
    p3_crush_curve: of_rock.P3
    CR: of_rock.CapRatio
    fluid_B0: of_rock.FluidB0
    fluid_pressure_initial: of_rock.FluidPressure
    T1_rate_dependence: of_rock.T1
    T2_rate_dependence: of_rock.T2
    subcycling_characteristic_number: of_rock.SubSteps = 256.0
    Use_Disaggregation_Algorithm: of_rock.Disaggregation = False
    PEAKI1IDIST: of_rock.Distribution = ""
    J3_type: Annotated[int, Parameter("0: round, 1: Gudehus, 3: Mohr and Coulomb", ge=0, le=3)] = 0
    J3_psi: Annotated[
        float,
        Parameter(
            "strength in extension over that in compression; convex for 7/9 to 9/7 (Gudehus), 1/2 to 2",
            gt=0.0,
        ),
    ] = 1.0
    principal_stress_cutoff: Annotated[
        float, Parameter("largest principal stress", unit="Pa", ignored="Uintah reads and never uses it")
    ] = 1.0e99
    B01: of_rock.UnreadModulus = 0.0

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return CapState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        found = faults_of(self)
        if self.J3_type == 2:
            found.append(
                ("J3_type", "Uintah has no law of this number: 0 (round), 1 (Gudehus) or 3 (Mohr-Coulomb)")
            )
        return found


@initial_sound_speed.register
def _(model: Arenisca4, density: Any, temperature: Any) -> Any:
    limit = stiffest(model)
    return np.sqrt((limit.bulk + 4.0 / 3.0 * limit.shear) / density)


@initialize.register
def _(model: Arenisca4, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    start_state(model, state, particles, material, patch)


@implements(least_stiffness, Arenisca4)
def least_stiffness_of_powder(model: Arenisca4) -> float:
    """The part of the moduli that disaggregated material keeps."""
    return 1.0e-3


@implements(step_fineness, Arenisca4)
def fineness(model: Arenisca4) -> float:
    """Sub-steps per size of the yield surface."""
    return 1.0e-5


@implements(counts_from_current_moduli, Arenisca4)
def counts_softened(model: Arenisca4) -> bool:
    """Sub-steps are counted with the stiffest moduli."""
    return False


@implements(bounds_after, Arenisca4)
def narrow_bounds(model: Arenisca4) -> Bounds:
    """Bounds at the end of the step."""
    return Bounds(1.0e2, 1.0e-3, 1.0e2)


@inline
def lode_factor(model: Arenisca4, j2: float, j3: float) -> float:
    """The factor of sqrt(J2) at a Lode angle: 1 in triaxial compression, 1 / psi in extension."""
    if j2 == 0.0 or model.J3_type == 0:
        return 1.0
    sin_3_theta = -0.5 * j3 * math.sqrt(27.0 / (j2 * j2 * j2))
    if model.J3_type == 1:
        return 0.5 * (1.0 + sin_3_theta + (1.0 - sin_3_theta) / model.J3_psi)
    theta = math.asin(min(max(sin_3_theta, -1.0), 1.0)) / 3.0
    sin_phi = 3.0 * (1.0 - model.J3_psi) / (1.0 + model.J3_psi)
    shape = math.cos(theta) - sin_phi * math.sin(theta) / math.sqrt(3.0)
    return 2.0 * math.sqrt(3.0) / (3.0 - sin_phi) * shape


@implements(is_yielding, Arenisca4)
def is_outside_at_lode_angle(model: Arenisca4, at: Surface, stress: Invariants) -> bool:
    """The strength depends on the Lode angle."""
    factor = lode_factor(model, stress.j2, stress.j3)
    return is_outside(at, stress.i1, factor * factor * stress.j2, factor * stress.root_j2)


class PrincipalStress(NamedTuple):
    """Principal stresses of the stretched space, the lowest first."""

    low: float
    middle: float
    high: float


@inline
def along(a: PrincipalStress, b: PrincipalStress, part: float) -> PrincipalStress:
    """The sum a + part b."""
    return PrincipalStress(a.low + part * b.low, a.middle + part * b.middle, a.high + part * b.high)


@inline
def size(a: PrincipalStress) -> float:
    """The length of a vector of principal stresses."""
    return math.sqrt(a.low * a.low + a.middle * a.middle + a.high * a.high)


@inline
def contains(model: Arenisca4, at: Surface, stretch: float, point: PrincipalStress) -> bool:
    """Whether a point lies inside the yield surface."""
    star = Tensor(point.low, 0.0, 0.0, 0.0, point.middle, 0.0, 0.0, 0.0, point.high)
    stress = isotropic(trace(star) / 3.0) + (1.0 / stretch) * deviator(star)
    return not is_yielding(model, at, invariants(stress))


@inline
def way_out(
    model: Arenisca4, at: Surface, stretch: float, inside: PrincipalStress, trial: PrincipalStress
) -> PrincipalStress:
    """The last point of a bisection for where the line from a point inside leaves the surface."""
    way = along(trial, inside, -1.0)
    outer, inner = 1.0, 0.0
    point = inside
    while outer - inner > BISECTED:
        middle = 0.5 * (outer + inner)
        point = along(inside, way, middle)
        if contains(model, at, stretch, point):
            inner = middle
        else:
            outer = middle
    return point


class Spiral(NamedTuple):
    """Axes for directions about the line from the trial stress to a point, of that line's length."""

    x: PrincipalStress
    y: PrincipalStress
    z: PrincipalStress


@inline
def spiral(point: PrincipalStress, trial: PrincipalStress) -> Spiral:
    """The line itself, the low principal axis at right angles to it, and their normal."""
    to_point = along(point, trial, -1.0)
    length = size(to_point)
    z = PrincipalStress(to_point.low / length, to_point.middle / length, to_point.high / length)
    if abs(z.low) == 1.0:
        x, y = PrincipalStress(0.0, 0.0, -z.low), PrincipalStress(0.0, 1.0, 0.0)
    else:
        x = PrincipalStress(1.0 - z.low * z.low, -z.low * z.middle, -z.low * z.high)
        width = size(x)
        x = PrincipalStress(x.low / width, x.middle / width, x.high / width)
        y = PrincipalStress(
            z.middle * x.high - z.high * x.middle,
            z.high * x.low - z.low * x.high,
            z.low * x.middle - z.middle * x.low,
        )
    zero = PrincipalStress(0.0, 0.0, 0.0)
    return Spiral(along(zero, x, length), along(zero, y, length), along(zero, z, length))


@inline
def with_axes_of(trial: PrincipalStress, point: PrincipalStress) -> PrincipalStress:
    """A point whose principal stresses are equal wherever those of the trial stress are.

    Axes that belong to equal principal stresses are not known, so those of the point are averaged; as the
    yield surface is convex and symmetric the average is inside. Uintah divides by the difference of principal
    stresses, be it rounding alone, and its stress may then be far from the yield surface.
    """
    alike = EQUAL * size(trial)
    if trial.high - trial.low <= alike:
        mean = (point.low + point.middle + point.high) / 3.0
        return PrincipalStress(mean, mean, mean)
    if trial.high - trial.middle <= alike:
        mean = 0.5 * (point.middle + point.high)
        return PrincipalStress(point.low, mean, mean)
    if trial.middle - trial.low <= alike:
        mean = 0.5 * (point.low + point.middle)
        return PrincipalStress(mean, mean, point.high)
    return point


@implements(return_to_surface, Arenisca4)
def return_among_principal_stresses(
    model: Arenisca4, at: Surface, stiffness: Moduli, trial: Tensor, stress: Invariants
) -> Returned:
    """The closest point; the principal axes stay."""
    stretch = deviator_stretch(model, stiffness)
    star = spectrum(isotropic(stress.i1 / 3.0) + stretch * stress.deviator)
    target = PrincipalStress(star.third, star.second, star.first)
    start = inner_point(at, stress.i1, norm(stress.deviator)) / 3.0
    point = PrincipalStress(start, start, start)
    n, tries = 0, 0
    while n < TURNS and tries < PATIENCE * TURNS:
        point = way_out(model, at, stretch, point, target)
        axes = spiral(point, target)
        n = max(n - TURNS_TAKEN_BACK, 0)
        while n < TURNS:
            tries += 1
            candidate = along(target, axes.x, ACROSS_X[n])
            candidate = along(along(candidate, axes.y, ACROSS_Y[n]), axes.z, ALONG[n])
            if contains(model, at, stretch, candidate):
                point = candidate
                break
            n += 1
    point = with_axes_of(target, point)
    found = compose(point.high, point.middle, point.low, star.axes)
    i1 = trace(found)
    stress_found = isotropic(i1 / 3.0) + (1.0 / stretch) * deviator(found)
    return Returned(stress_found, i1, tries >= PATIENCE * TURNS)


@implements(stress_update, Arenisca4)
def arenisca4_stress(
    model: Arenisca4, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The update that all versions share, with the return of this one."""
    return cap_model_stress(model, state, p, point, material, step)
