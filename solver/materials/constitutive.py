"""What every constitutive model is given and gives back."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import singledispatch
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.declare import IntVector
from solver.dispatch import generic, inline
from solver.grid import GridIndex
from solver.lanes import where
from solver.particles import Particles
from solver.tensor import Tensor


class Material(NamedTuple):
    """Constants of a material that are not its constitutive model's (SI, or any consistent units)."""

    density: float
    specific_heat: float
    """At constant volume."""
    specific_heat_constant_pressure: float
    thermal_conductivity: float
    room_temperature: float
    melt_temperature: float
    thermal_expansion: float
    """Linear coefficient, 1/K."""


class Step(NamedTuple):
    """What stress updates know of the time step."""

    dt: float
    time: float
    """Time at the start of the step."""
    length: float
    """Mean cell size (dx + dy + dz) / 3, for artificial viscosity."""
    artificial_viscosity: bool
    viscosity_linear: float
    viscosity_quadratic: float
    viscosity_heating: bool


class Point(NamedTuple):
    """One particle as a stress update sees it; ``old`` is at the start of the step."""

    stress: Tensor
    """Cauchy stress at the start of the step."""
    deformation_gradient_old: Tensor
    deformation_gradient: Tensor
    velocity_gradient: Tensor
    volume_old: float
    volume: float
    mass: float
    temperature: float
    """At the start of the step."""
    previous_temperature: float
    """One step earlier still."""
    localized: int
    """Not 0 where the particle has failed."""


class StressUpdate(NamedTuple):
    """The answer of a constitutive model for one particle."""

    stress: Tensor
    """Cauchy stress at the end of the step."""
    sound_speed: float
    strain_energy: float
    """What the particle adds to the reduction StrainEnergy."""
    heating_rate: float
    """dT/dt by the material itself, K/s."""
    artificial_pressure: float
    """The viscous pressure q that enters the next step's internal force."""
    localized: int
    """New failure state: 0 sound, positive failed, DELETE to remove the particle."""


DELETE = -999
"""Value of ``localized`` that removes a particle at the end of the step."""


@generic
def stress_update(
    model: Any, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Stress of particle ``p`` at the end of the step; the model's own ``state`` arrays are updated in place."""
    raise NotImplementedError


@singledispatch
def initial_sound_speed(model: Any, density: NDArray[np.float64], temperature: NDArray[np.float64]) -> Any:
    """Wave speed of undeformed particles (n,), from which the first time step follows."""
    raise TypeError(f"{type(model).__name__} declares no initial sound speed")


@singledispatch
def initialize(model: Any, state: Any, particles: Particles, material: Material, patch: Any) -> None:
    """Set the model's state arrays, and initial stress where there is any, beyond their declared initial values.

    ``patch`` holds the patch id of each particle, (n,), which seeds the distributions that a model draws from.
    """


def numbers_only(model: Any) -> Any:
    """A model's record for kernels: words, which choose what is made before the first step, become 0.

    Numba takes records of numbers as they are; each word would have to be looked at anew in every call.
    """
    if isinstance(model, str):
        return 0
    if isinstance(model, tuple) and hasattr(model, "_fields"):
        return type(model)(*map(numbers_only, model))
    return model


class Neighbourhood(NamedTuple):
    """Where the particles of a body lay at the start of a step, for models whose particles feel each other.

    They do so through nodes: a model sums over its particles, completes the sums by those of others, and looks at the
    nodes within its ``coupling_length`` of a particle. All of these are stored.
    """

    interpolator: Any
    grid: GridIndex
    position: NDArray[np.float64]
    """(n, 3)."""
    dt: float
    repeats: IntVector
    """After so many nodes they repeat in each direction; 0 where they do not, or where images are stored."""
    complete: Callable[[NDArray[np.float64]], None]
    """Adds to sums over particles (N, ...), in place, those of periodic images and of other ranks."""
    largest: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    """The largest of some numbers of all ranks."""


@singledispatch
def couple_particles(model: Any, state: Any, particles: Particles, neighbourhood: Neighbourhood) -> float:
    """Correct the stresses of a step by what the particles of the body do together; most models do not.

    Called once all particles of a body went through :func:`stress_update`, whose answers are in ``particles``
    and ``state``; both are updated in place. Returns what that adds to the strain energy.
    """
    return 0.0


def is_coupled(model: Any) -> bool:
    """Whether the particles of a model feel each other beside the grid."""
    return type(model) in couple_particles.registry


def coupling_length(model: Any) -> float:
    """How far from a particle its model looks at nodes (its attribute ``coupling_length``), m; 0 for most."""
    return float(getattr(model, "coupling_length", 0.0))


class NoState(NamedTuple):
    """The state of a model that keeps nothing but stress and deformation gradient."""


def state_record(model: Any) -> type:
    """The NamedTuple class of a model's own state arrays (its attribute ``State``)."""
    return getattr(model, "State", NoState)


def time_step_limit(model: Any) -> float:
    """The longest step that a model allows whatever the wave speed (its attribute ``largest_time_step``)."""
    return float(getattr(model, "largest_time_step", math.inf))


@inline
def artificial_viscosity(
    step: Step, dilatation_rate: float, bulk_sound_speed: float, density: float
) -> float:
    """Viscous pressure of compression, von Neumann and Richtmyer (1950) with a linear term.

    q = rho (A1 c |D h| + A2 D^2 h^2) where D = tr d < 0, else 0.
    """
    if not step.artificial_viscosity:
        return 0.0
    stretch = dilatation_rate * step.length
    pressure = density * (
        step.viscosity_linear * bulk_sound_speed * abs(stretch) + step.viscosity_quadratic * stretch * stretch
    )
    return where(dilatation_rate < 0.0, pressure, 0.0)
