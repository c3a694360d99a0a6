"""Arenisca, third version: porous rock whose yield surface is a body of revolution."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from solver.declare import model
from solver.dispatch import implements, inline
from solver.materials.arenisca import parameters as of_rock
from solver.materials.arenisca.elasticity import Moduli, least_stiffness, stiffest
from solver.materials.arenisca.faults import faults_of
from solver.materials.arenisca.invariants import Invariants
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
from solver.tensor import Tensor, isotropic

TURNS = 19
"""How many angles are tried before a point counts as the closest."""

TURNS_TAKEN_BACK = 4
"""A point found inside widens the angle by so many."""

COSINES = np.cos(math.pi / 4.0 * (-2.0 / 3.0) ** np.arange(TURNS))
SINES = np.sin(math.pi / 4.0 * (-2.0 / 3.0) ** np.arange(TURNS))


@model("constitutive_model", "Arenisca3")
class Arenisca3(NamedTuple):
    """Porous rock: elasticity that depends on pressure and compaction, a shear limit and a moving cap.

    With I = I1 - zeta (tension positive) the stress yields at sqrt(J2) = a1 - a3 exp(a2 I) - a4 I, times
    sqrt(1 - ((kappa - I) / (kappa - X))^2) on the cap between kappa = PEAKI1 - CR (PEAKI1 - X) and X. The
    cap X follows the plastic volume strain by the crush curve, -e_vp = p3 - p3 exp(p1 (X - p0)), and fluid in
    the pores moves the surface by the back stress zeta. Trial stresses return to the closest point, sought
    geometrically; rate dependence is Duvaut and Lions'. Homel, Guilkey and Brannon, Acta Mechanica 227
    (2016); Brannon in "Shock wave science and technology reference library" 2 (2007).
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
    B01: of_rock.UnreadModulus = 0.0

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return CapState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        return faults_of(self)


@initial_sound_speed.register
def _(model: Arenisca3, density: Any, temperature: Any) -> Any:
    limit = stiffest(model)
    return np.sqrt((limit.bulk + 4.0 / 3.0 * limit.shear) / density)


@initialize.register
def _(model: Arenisca3, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    start_state(model, state, particles, material, patch)


@implements(least_stiffness, Arenisca3)
def least_stiffness_of_powder(model: Arenisca3) -> float:
    """The part of the moduli that disaggregated material keeps."""
    return 1.0e-5


@implements(step_fineness, Arenisca3)
def fineness(model: Arenisca3) -> float:
    """Sub-steps per size of the yield surface."""
    return 1.0e-4


@implements(counts_from_current_moduli, Arenisca3)
def counts_softened(model: Arenisca3) -> bool:
    """Disaggregated material needs fewer sub-steps."""
    return True


@implements(bounds_after, Arenisca3)
def widest_bounds(model: Arenisca3) -> Bounds:
    """Bounds at the end of the step."""
    return Bounds(1.0e16, 1.0e-16, 1.0e16)


@implements(is_yielding, Arenisca3)
def is_outside_of_revolution(model: Arenisca3, at: Surface, stress: Invariants) -> bool:
    """The Lode angle does not count."""
    return is_outside(at, stress.i1, stress.j2, stress.root_j2)


class Meridian(NamedTuple):
    """A point of the meridional plane: z along the hydrostat, r across, stretched to be at right angles."""

    z: float
    r: float


@inline
def contains(at: Surface, stretch: float, point: Meridian) -> bool:
    """Whether a point of the plane lies inside the yield surface."""
    root_j2 = point.r / stretch
    return not is_outside(at, math.sqrt(3.0) * point.z, root_j2 * root_j2, root_j2)


@inline
def between(a: Meridian, b: Meridian, part: float) -> Meridian:
    """The point a part of the way from a to b."""
    return Meridian(a.z + part * (b.z - a.z), a.r + part * (b.r - a.r))


@inline
def way_out(at: Surface, stretch: float, inside: Meridian, trial: Meridian) -> Meridian:
    """The point, just outside, where the line from a point inside to the trial stress leaves the surface."""
    outer, inner = 1.0, 0.0
    while outer - inner > BISECTED:
        middle = 0.5 * (outer + inner)
        if contains(at, stretch, between(inside, trial, middle)):
            inner = middle
        else:
            outer = middle
    return between(inside, trial, outer)


@inline
def turned(point: Meridian, trial: Meridian, n: int) -> Meridian:
    """A point turned about the trial stress by the n-th angle, pi/4 (-2/3)^n."""
    z, r = point.z - trial.z, point.r - trial.r
    return Meridian(trial.z + COSINES[n] * z - SINES[n] * r, trial.r + SINES[n] * z + COSINES[n] * r)


@implements(return_to_surface, Arenisca3)
def return_in_the_meridian(
    model: Arenisca3, at: Surface, stiffness: Moduli, trial: Tensor, stress: Invariants
) -> Returned:
    """The closest point at the Lode angle of the trial stress."""
    stretch = math.sqrt(2.0) * deviator_stretch(model, stiffness)
    target = Meridian(stress.i1 / math.sqrt(3.0), stretch * stress.root_j2)
    point = Meridian(inner_point(at, stress.i1, stress.root_j2) / math.sqrt(3.0), 0.0)
    n, tries = 0, 0
    while n < TURNS and tries < PATIENCE * TURNS:
        point = way_out(at, stretch, point, target)
        n = max(n - TURNS_TAKEN_BACK, 0)
        while n < TURNS:
            tries += 1
            candidate = turned(point, target, n)
            if contains(at, stretch, candidate):
                point = candidate
                break
            n += 1
    i1 = math.sqrt(3.0) * point.z
    shape = point.r / stretch / stress.root_j2 if stress.root_j2 != 0.0 else 1.0
    return Returned(isotropic(i1 / 3.0) + shape * stress.deviator, i1, tries >= PATIENCE * TURNS)


@implements(stress_update, Arenisca3)
def arenisca3_stress(
    model: Arenisca3, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The update that all versions share, with the return of this one."""
    return cap_model_stress(model, state, p, point, material, step)
