"""The loop over particles that deforms them and asks their constitutive model for the stress."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from solver.declare import Vector
from solver.deferred import directly
from solver.dispatch import inline, singly, takes_lanes
from solver.jit import kernel
from solver.kernels.chunks import CHUNK
from solver.lanes import WIDTH, Eight, everywhere, floor, largest_of, sum_of, where
from solver.materials.constitutive import Material, Point, Step, stress_update
from solver.materials.failure import Failure, restrained, restrains, weakened, weakens
from solver.particles import Particles
from solver.tensor import Tensor, determinant, isotropic, norm, put_tensor, tensor_at


class Kinematics(NamedTuple):
    """How deformation gradients follow velocity gradients."""

    subcycles: int
    """n > 0: at least n steps of F <- (I + L dt/n) F; n <= 0: |n| terms of exp(L dt)."""
    stabilize_pressure: bool


MOST_SUBCYCLES = 10000.0


@inline
def new_deformation_gradient(F: Tensor, L: Tensor, dt: float, subcycles: int) -> Tensor:
    """F at the end of the step from the velocity gradient L."""
    if subcycles > 0:
        n = min(max(1.0 * subcycles, 2.0 * floor(norm(L) * dt)), MOST_SUBCYCLES)
        increment = isotropic(1.0) + L * (dt / n)
        for k in range(int(largest_of(n))):
            F = where(k < n, increment @ F, F)
        return F
    series = isotropic(1.0)
    term = isotropic(1.0)
    for k in range(1, abs(subcycles) + 1):
        term = (term @ L) * (dt / k)
        series = series + term
    return series @ F


@kernel
def particle_cells(position: Any, anchor: Vector, spacing: Vector, own_cells: Any, cells: Any) -> None:
    """The cells (n,) of positions (n, 3), counted x fastest in the box between two corners of cells."""
    (x, y, z), (end_x, end_y, _) = own_cells
    nx, ny = end_x - x, end_y - y
    for p in range(cells.shape[0]):
        i = math.floor((position[p, 0] - anchor[0]) / spacing[0]) - x
        j = math.floor((position[p, 1] - anchor[1]) / spacing[1]) - y
        k = math.floor((position[p, 2] - anchor[2]) / spacing[2]) - z
        cells[p] = i + nx * (j + ny * k)


@kernel
def cell_dilatation(
    particles: Particles, cells: Any, kinematics: Kinematics, dt: float, volume: Any, reference_volume: Any
) -> None:
    """Sums of new volume V and of V / det F over the particles of each cell, for pressure stabilization."""
    volume[:] = 0.0
    reference_volume[:] = 0.0
    for p in range(particles.mass.shape[0]):
        F_old = tensor_at(particles.deformation_gradient, p)
        F = new_deformation_gradient(
            F_old, tensor_at(particles.velocity_gradient, p), dt, kinematics.subcycles
        )
        J = determinant(F)
        v = particles.volume[p] * J / determinant(F_old)
        volume[cells[p]] += v
        reference_volume[cells[p]] += v / J


class Stressed(NamedTuple):
    """Sums and extremes over the particles of a material after the stress update."""

    strain_energy: float
    volume: float
    wave_speed: tuple[float, float, float]
    """Per direction the largest of sound speed plus particle speed."""
    finite: bool
    """Whether every stress and position is a finite number."""


STRESS_SUMS = 6
"""Numbers in a :class:`Stressed`."""


def total(sums: Any) -> Stressed:
    """The sums and extremes of all chunks (chunks, STRESS_SUMS) together."""
    energy, volume = sums[:, :2].sum(axis=0)
    x, y, z = sums[:, 2:5].max(axis=0, initial=1.0e-12)
    return Stressed(float(energy), float(volume), (float(x), float(y), float(z)), bool(sums[:, 5].all()))


class Passed(NamedTuple):
    """What a particle adds to a :class:`Stressed`, or eight of them in lanes."""

    strain_energy: float
    volume: float
    wave_x: float
    wave_y: float
    wave_z: float
    finite: bool


@singly
def stretch_of_cell(cell_stretch: Any, cells: Any, p: int) -> float:
    """The det F averaged over the cell of a particle."""
    return cell_stretch[cells[p]]


class StressLoop(NamedTuple):
    """What the stress update of the particles of a material needs."""

    model: Any
    state: Any
    failure: Failure
    particles: Particles
    material: Material
    step: Step
    kinematics: Kinematics
    cells: Any
    """The cell of each particle, where pressure is stabilized."""
    cell_stretch: Any
    """The det F averaged over each cell, where pressure is stabilized."""


@inline
def update_stress(loop: StressLoop, p: Any) -> Passed:
    """Deform particle ``p``, or eight of them, and ask their constitutive model for the stress."""
    model, state, failure, particles = loop.model, loop.state, loop.failure, loop.particles
    material, step, kinematics = loop.material, loop.step, loop.kinematics
    dt = step.dt
    F_old = tensor_at(particles.deformation_gradient, p)
    L = tensor_at(particles.velocity_gradient, p)
    F = new_deformation_gradient(F_old, L, dt, kinematics.subcycles)
    J, J_old = determinant(F), determinant(F_old)
    volume_old = particles.volume[p]
    volume = volume_old * J / J_old
    if kinematics.stabilize_pressure:
        J_cell = stretch_of_cell(loop.cell_stretch, loop.cells, p)
        F = F * (J_cell / J) ** (1.0 / 3.0)
        L = L + isotropic(math.log(J_cell / J) / (3.0 * dt))
        put_tensor(particles.velocity_gradient, p, L)
    temperature = particles.temperature[p]
    point = Point(
        tensor_at(particles.stress, p),
        F_old,
        F,
        L,
        volume_old,
        volume,
        particles.mass[p],
        temperature,
        particles.previous_temperature[p],
        particles.localized[p],
    )
    if restrains(failure):
        point = restrained(failure, point)
    new = stress_update(model, state, p, point, material, step)
    stress, localized = new.stress, new.localized
    if weakens(failure):
        damaged = weakened(failure, model, state, p, point, stress, localized, material, step)
        stress, localized = damaged.stress, damaged.localized
    put_tensor(particles.deformation_gradient, p, point.deformation_gradient)
    put_tensor(particles.stress, p, stress)
    particles.volume[p] = volume
    particles.artificial_pressure[p] = new.artificial_pressure
    particles.heating_rate[p] = new.heating_rate
    particles.localized[p] = localized
    particles.previous_temperature[p] = temperature
    particles.temperature[p] = temperature + particles.temperature_rate[p] * dt + new.heating_rate * dt
    c = new.sound_speed
    x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
    return Passed(
        new.strain_energy,
        volume,
        c + abs(particles.old_velocity[p, 0]),
        c + abs(particles.old_velocity[p, 1]),
        c + abs(particles.old_velocity[p, 2]),
        math.isfinite(norm(stress) + c + x + y + z),
    )


@inline
def empty(sums: Any, chunk: int) -> None:
    """Make the sums of a chunk those of no particles."""
    row = sums[chunk]
    row[0] = row[1] = 0.0
    row[2] = row[3] = row[4] = 1.0e-12
    row[5] = 1.0


@inline
def count(passed: Passed, sums: Any, chunk: int) -> None:
    """Add a particle, or eight, to the sums and extremes of a chunk."""
    row = sums[chunk]
    row[0] += sum_of(passed.strain_energy)
    row[1] += sum_of(passed.volume)
    row[2] = max(row[2], largest_of(passed.wave_x))
    row[3] = max(row[3], largest_of(passed.wave_y))
    row[4] = max(row[4], largest_of(passed.wave_z))
    if not everywhere(passed.finite):
        row[5] = 0.0


@kernel
def update_singly(loop: StressLoop, first: int, last: int, sums: Any) -> None:
    """:func:`update_stresses`, one particle after the other."""
    for chunk in range(first, last):
        empty(sums, chunk)
        for p in range(chunk * CHUNK, min((chunk + 1) * CHUNK, loop.particles.mass.shape[0])):
            count(update_stress(loop, p), sums, chunk)


@kernel
def update_by_eight(loop: StressLoop, first: int, last: int, sums: Any) -> None:
    """:func:`update_stresses` of eight particles at once, without those that are left of the last chunk."""
    for chunk in range(first, last):
        empty(sums, chunk)
        end = min((chunk + 1) * CHUNK, loop.particles.mass.shape[0])
        for start in range(chunk * CHUNK, end - WIDTH + 1, WIDTH):
            count(update_stress(loop, Eight(start)), sums, chunk)


@kernel
def update_rest(loop: StressLoop, chunk: int, sums: Any) -> None:
    """:func:`update_stresses` of the particles that :func:`update_by_eight` left in the last chunk.

    A kernel of its own: many decks never need it, and it takes as long to compile as the other.
    """
    particles = loop.particles.mass.shape[0]
    for p in range(particles - particles % WIDTH, particles):
        count(update_stress(loop, p), sums, chunk)


def update_stresses(
    loop: StressLoop, first: int, last: int, sums: Any, call: Callable[..., Any] = directly
) -> None:
    """Deformation gradients, volumes, stresses and temperatures at the end of the step.

    Does the chunks ``first`` to ``last`` of particles and stores in ``sums`` (chunks, STRESS_SUMS) each one's
    :class:`Stressed`. Kernels are called by ``call``.
    """
    particles = len(loop.particles)
    if not _by_eight(loop):
        call(update_singly, loop, first, last, sums)
        return
    call(update_by_eight, loop, first, last, sums)
    if particles % WIDTH and first <= particles // CHUNK < last:
        call(update_rest, loop, last - 1, sums)


def _by_eight(loop: StressLoop) -> bool:
    return len(loop.particles) >= WIDTH and takes_lanes(stress_update, loop.model)


def kernels_of(loop: StressLoop) -> list[tuple[Any, tuple[Any, ...]]]:
    """The kernels that :func:`update_stresses` will call, each with arguments of the right types."""
    sums = np.zeros((0, STRESS_SUMS))
    if not _by_eight(loop):
        return [(update_singly, (loop, 0, 0, sums))]
    rest = [(update_rest, (loop, 0, sums))] if len(loop.particles) % WIDTH else []
    return [(update_by_eight, (loop, 0, 0, sums)), *rest]
