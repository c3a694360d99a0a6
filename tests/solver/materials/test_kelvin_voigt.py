"""Kelvin-Voigt solid against its closed form."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import (
    MATERIAL,
    SAMPLE,
    Driver,
    assert_kernel_agrees,
    assert_turns_with_the_path,
    rotation_matrix,
)

from solver.materials.constitutive import initial_sound_speed
from solver.materials.kelvin_voigt import KelvinVoigt

G, K, ETA_G, ETA_K = 4.0e6, 9.0e6, 150.0, 70.0
MODEL = KelvinVoigt(G, K, ETA_G, ETA_K)


def small_strain_stress(strain, rate, eta_k):
    mean, mean_rate = np.trace(strain) * np.eye(3), np.trace(rate) * np.eye(3)
    return 2 * G * (strain - mean / 3) + K * mean + 2 * ETA_G * (rate - mean_rate / 3) + eta_k * mean_rate


@pytest.mark.parametrize("eta_k", [ETA_K, -1.0])
def test_steady_straining(eta_k):
    """The spring's stress grows with the strain, the dashpot's stays, whatever the number of steps."""
    dt, rate = 1e-6, 1e-2 * (SAMPLE + SAMPLE.T)
    for steps in (10, 20):
        path = [np.eye(3) + dt * (k + 1) * rate for k in range(steps)]
        stress = Driver(MODEL._replace(viscous_bulk=eta_k)).follow(path, dt)[-1]
        expected = small_strain_stress(rate * dt * steps, rate, max(eta_k, 0.0))
        np.testing.assert_allclose(stress, expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())


def test_spring_turns_with_the_body():
    F = np.eye(3) + 1e-3 * SAMPLE
    driver = Driver(MODEL._replace(viscous_shear=0.0, viscous_bulk=0.0), exact_rates=True)
    stress = driver.advance(F)
    turns = [rotation_matrix([0.2, 1, 0], 0.15 * (k + 1)) for k in range(8)]
    turned = driver.follow([Q @ F for Q in turns])[-1]
    np.testing.assert_allclose(turned, turns[-1] @ stress @ turns[-1].T, rtol=1e-9, atol=1e-6)


def test_energy_is_the_work_of_the_step():
    dt = 1e-6
    driver = Driver(MODEL)
    stress = driver.advance(np.eye(3) + 1e-3 * SAMPLE, dt)
    work = (1e-3 * SAMPLE * stress / 2).sum() * driver.particles.volume[0]
    assert driver.strain_energy == pytest.approx(work, rel=1e-12)


def test_sound_speed():
    speed = initial_sound_speed(MODEL, np.array([MATERIAL.density]), 300.0)
    np.testing.assert_allclose(speed, np.sqrt((K + 4 * G / 3) / MATERIAL.density))


def test_turned_path():
    assert_turns_with_the_path(MODEL, rtol=1e-9)


def test_kernel():
    assert_kernel_agrees(MODEL, viscosity=True, rtol=1e-11)
