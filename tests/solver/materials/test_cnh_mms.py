"""Neo-Hookean material of manufactured solutions against its energy."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import (
    MATERIAL,
    Driver,
    assert_blind_to_spin,
    assert_kernel_agrees,
    sample_path,
    stress_from_energy,
)

from solver.materials.cnh_mms import CnhMms
from solver.materials.constitutive import initial_sound_speed

K, G = 3.0e9, 1.1e9
MODEL = CnhMms(K, G)


def energy(F):
    J = np.linalg.det(F)
    return (K / 2 - G / 3) * np.log(J) ** 2 - G * np.log(J) + G / 2 * (np.trace(F @ F.T) - 3)


def test_stress_is_the_derivative_of_the_energy():
    F = sample_path(1, 2.0)[0]
    driver = Driver(MODEL)
    np.testing.assert_allclose(driver.advance(F), stress_from_energy(energy, F), atol=1e-8 * K)
    expected = np.sqrt((K + 4 * G / 3) * np.linalg.det(F) / MATERIAL.density)
    assert driver.sound_speed == pytest.approx(expected, rel=1e-12)
    assert driver.strain_energy == 0.0


def test_initial_sound_speed():
    speed = initial_sound_speed(MODEL, np.array([1500.0]), 300.0)
    np.testing.assert_allclose(speed, np.sqrt((K + 4 * G / 3) / 1500.0))


def test_objective():
    assert_blind_to_spin(MODEL)


def test_kernel():
    assert_kernel_agrees(MODEL, viscosity=True)
