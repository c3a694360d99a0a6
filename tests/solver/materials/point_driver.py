"""Takes one particle along a path of deformation gradients, in plain Python or in a compiled kernel."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from solver.materials.constitutive import Material, Point, Step, initialize, state_record, stress_update
from solver.particles import Particles, new_arrays
from solver.point_driver import logarithm
from solver.tensor import put_tensor, tensor_at

MATERIAL = Material(
    density=8900.0,
    specific_heat=400.0,
    specific_heat_constant_pressure=420.0,
    thermal_conductivity=300.0,
    room_temperature=300.0,
    melt_temperature=1400.0,
    thermal_expansion=0.0,
)


def update_particle(model, state, particles, old_gradient, old_volume, material, step, answer):
    """One stress update of particle 0; what is not stored with the particles goes to ``answer``."""
    point = Point(
        tensor_at(particles.stress, 0),
        tensor_at(old_gradient, 0),
        tensor_at(particles.deformation_gradient, 0),
        tensor_at(particles.velocity_gradient, 0),
        old_volume,
        particles.volume[0],
        particles.mass[0],
        particles.temperature[0],
        particles.previous_temperature[0],
        particles.localized[0],
    )
    update = stress_update(model, state, 0, point, material, step)
    put_tensor(particles.stress, 0, update.stress)
    answer[0] = update.sound_speed
    answer[1] = update.strain_energy
    answer[2] = update.heating_rate
    answer[3] = update.artificial_pressure
    answer[4] = update.localized


@cache
def compiled_update():
    from solver.jit import kernel

    return kernel(update_particle)


@dataclass
class Driver:
    """One particle of a material; ``advance`` gives it a new deformation gradient."""

    model: Any
    material: Material = MATERIAL
    compiled: bool = False
    temperature: float = 300.0
    viscosity: bool = False
    start: Any = field(default_factory=lambda: np.eye(3))
    length: float = 0.01
    exact_rates: bool = False
    """Velocity gradients ln(F F_old^-1) / dt, without strain in a rotation, or (F F_old^-1 - I) / dt."""

    def __post_init__(self):
        self.particles: Particles = new_arrays(Particles, 1)
        self.particles.volume[0] = 2.0
        self.particles.mass[0] = 2.0 * self.material.density
        self.particles.deformation_gradient[0] = self.start
        self.particles.temperature[0] = self.particles.previous_temperature[0] = self.temperature
        self.state = new_arrays(state_record(self.model), 1)
        if type(self.model) in initialize.registry:
            initialize(self.model, self.state, self.particles, self.material, np.zeros(1, int))
        self.time = 0.0
        self.answer = np.zeros(5)

    def advance(self, gradient, dt=1.0e-6, temperature=None):
        """Stress (3, 3) after a step to the deformation gradient ``gradient``."""
        p = self.particles
        old_gradient = p.deformation_gradient.copy()
        old_volume = p.volume[0]
        increment = np.asarray(gradient) @ np.linalg.inv(old_gradient[0])
        p.deformation_gradient[0] = gradient
        p.velocity_gradient[0] = (
            logarithm(increment[None])[0] if self.exact_rates else increment - np.eye(3)
        ) / dt
        p.volume[0] = old_volume * np.linalg.det(increment)
        step = Step(dt, self.time, self.length, self.viscosity, 0.2, 2.0, False)
        update = compiled_update() if self.compiled else update_particle
        update(self.model, self.state, p, old_gradient, old_volume, self.material, step, self.answer)
        self.time += dt
        p.previous_temperature[0] = p.temperature[0]
        if temperature is not None:
            p.temperature[0] = temperature
        return p.stress[0].copy()

    def follow(self, path, dt=1.0e-6):
        """Stresses (steps, 3, 3) along a path of deformation gradients."""
        return np.array([self.advance(gradient, dt) for gradient in path])

    @property
    def sound_speed(self):
        return self.answer[0]

    @property
    def strain_energy(self):
        return self.answer[1]

    @property
    def heating_rate(self):
        return self.answer[2]

    @property
    def artificial_pressure(self):
        return self.answer[3]

    @property
    def localized(self):
        return int(self.answer[4])


def rotation_matrix(axis, angle):
    """The matrix that turns by ``angle`` (radians) about ``axis``."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


SAMPLE = np.array([[0.11, -0.07, 0.03], [0.05, -0.06, 0.09], [-0.02, 0.08, 0.04]])
"""A displacement gradient without symmetry."""


def sample_path(steps=20, scale=1.0):
    """Deformation gradients from the undeformed state to I + scale * SAMPLE, not on a straight line."""
    s = np.linspace(0.0, 1.0, steps + 1)[1:]
    return np.array([np.eye(3) + scale * (t * SAMPLE + t * (1 - t) * SAMPLE.T) for t in s])


def assert_kernel_agrees(model, path=None, dt=1.0e-6, rtol=1.0e-12, **options):
    """The compiled update and the plain Python one walk the same path with the same stresses and state."""
    path = sample_path(4) if path is None else path
    plain, fast = Driver(model, **options), Driver(model, compiled=True, **options)
    stress = plain.follow(path, dt)
    np.testing.assert_allclose(fast.follow(path, dt), stress, rtol=rtol, atol=rtol * np.abs(stress).max())
    np.testing.assert_allclose(fast.answer, plain.answer, rtol=rtol)
    for mine, theirs in zip(plain.state, fast.state, strict=True):
        np.testing.assert_allclose(theirs, mine, rtol=rtol, atol=rtol * max(1.0, np.abs(mine).max()))


def assert_turns_with_the_path(model, path=None, dt=1.0e-6, rtol=1.0e-11, **options):
    """A path rotated as a whole, F -> Q F, gives the rotated stress Q sigma Q^T."""
    path = sample_path() if path is None else path
    Q = rotation_matrix([1.0, 2.0, -0.5], 0.9)
    stress = Driver(model, **options).follow(path, dt)
    turned = Driver(model, start=Q, **options).follow([Q @ F for F in path], dt)
    expected = Q @ stress @ Q.T
    np.testing.assert_allclose(turned, expected, rtol=rtol, atol=rtol * np.abs(expected).max())


def assert_blind_to_spin(model, path=None, dt=1.0e-6, rtol=1.0e-11, **options):
    """Objectivity: with a rotation that grows along the path, F -> Q(t) F, the stress is Q sigma Q^T."""
    path = sample_path() if path is None else path
    turns = [rotation_matrix([1.0, 2.0, -0.5], 1.3 * (k + 1) / len(path)) for k in range(len(path))]
    stress = Driver(model, **options).follow(path, dt)
    turned = Driver(model, **options).follow([Q @ F for Q, F in zip(turns, path, strict=True)], dt)
    expected = np.array([Q @ s @ Q.T for Q, s in zip(turns, stress, strict=True)])
    np.testing.assert_allclose(turned, expected, rtol=rtol, atol=rtol * np.abs(expected).max())


def stress_from_energy(energy, F, step=1.0e-5):
    """Cauchy stress (1/J) dW/dF F^T of an energy W(F) of unit initial volume, by central differences."""
    first_piola = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            change = np.zeros((3, 3))
            change[i, j] = step
            first_piola[i, j] = (energy(F + change) - energy(F - change)) / (2 * step)
    return first_piola @ F.T / np.linalg.det(F)
