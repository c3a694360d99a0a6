"""The loop over particles that deforms them and asks their constitutive model for the stress."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.dispatch import inline
from solver.jit import kernel
from solver.kernels.chunks import CHUNK
from solver.materials.constitutive import Material, Point, Step, stress_update
from solver.materials.failure import Failure, restrained, weakened
from solver.particles import Particles
from solver.tensor import Tensor, determinant, isotropic, norm, put_tensor, tensor_at


class Kinematics(NamedTuple):
    """How deformation gradients follow velocity gradients."""

    subcycles: int
    """n > 0: at least n steps of F <- (I + L dt/n) F; n <= 0: |n| terms of exp(L dt)."""
    stabilize_pressure: bool


@inline
def new_deformation_gradient(F: Tensor, L: Tensor, dt: float, subcycles: int) -> Tensor:
    """F at the end of the step from the velocity gradient L."""
    if subcycles > 0:
        n = min(max(subcycles, 2 * int(norm(L) * dt)), 10000)
        increment = isotropic(1.0) + L * (dt / n)
        for _ in range(n):
            F = increment @ F
        return F
    series = isotropic(1.0)
    term = isotropic(1.0)
    for k in range(1, abs(subcycles) + 1):
        term = (term @ L) * (dt / k)
        series = series + term
    return series @ F


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


@kernel
def update_stresses(
    model: Any,
    state: Any,
    failure: Failure,
    particles: Particles,
    material: Material,
    step: Step,
    kinematics: Kinematics,
    cells: Any,
    cell_stretch: Any,
    first: int,
    last: int,
    sums: Any,
) -> None:
    """Deformation gradients, volumes, stresses and temperatures at the end of the step.

    ``cell_stretch`` holds det F averaged over each cell, used where pressure is stabilized. Does the chunks ``first``
    to ``last`` of particles and stores in ``sums`` (chunks, STRESS_SUMS) each one's :class:`Stressed`.
    """
    dt = step.dt
    for chunk in range(first, last):
        energy = total_volume = 0.0
        wx = wy = wz = 1.0e-12
        finite = True
        for p in range(chunk * CHUNK, min((chunk + 1) * CHUNK, particles.mass.shape[0])):
            F_old = tensor_at(particles.deformation_gradient, p)
            L = tensor_at(particles.velocity_gradient, p)
            F = new_deformation_gradient(F_old, L, dt, kinematics.subcycles)
            J, J_old = determinant(F), determinant(F_old)
            volume_old = particles.volume[p]
            volume = volume_old * J / J_old
            if kinematics.stabilize_pressure:
                J_cell = cell_stretch[cells[p]]
                F = F * (J_cell / J) ** (1.0 / 3.0)
                L = L + isotropic(math.log(J_cell / J) / (3.0 * dt))
                put_tensor(particles.velocity_gradient, p, L)
            point = Point(
                tensor_at(particles.stress, p),
                F_old,
                F,
                L,
                volume_old,
                volume,
                particles.mass[p],
                particles.temperature[p],
                particles.previous_temperature[p],
                particles.localized[p],
            )
            point = restrained(failure, point)
            new = stress_update(model, state, p, point, material, step)
            new = weakened(failure, model, state, p, point, new, material, step)
            put_tensor(particles.deformation_gradient, p, point.deformation_gradient)
            put_tensor(particles.stress, p, new.stress)
            particles.volume[p] = volume
            particles.artificial_pressure[p] = new.artificial_pressure
            particles.heating_rate[p] = new.heating_rate
            particles.localized[p] = new.localized
            temperature = particles.temperature[p]
            particles.previous_temperature[p] = temperature
            particles.temperature[p] = (
                temperature + particles.temperature_rate[p] * dt + new.heating_rate * dt
            )
            energy += new.strain_energy
            total_volume += volume
            c = new.sound_speed
            wx = max(wx, c + abs(particles.old_velocity[p, 0]))
            wy = max(wy, c + abs(particles.old_velocity[p, 1]))
            wz = max(wz, c + abs(particles.old_velocity[p, 2]))
            x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
            if not math.isfinite(norm(new.stress) + c + x + y + z):
                finite = False
        row = sums[chunk]
        row[0], row[1] = energy, total_volume
        row[2], row[3], row[4] = wx, wy, wz
        row[5] = 1.0 if finite else 0.0
