"""Murnaghan's equation of state against its closed form."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import SAMPLE, Driver, assert_blind_to_spin, assert_kernel_agrees

from solver.materials.constitutive import initial_sound_speed
from solver.materials.murnaghan_mpm import MurnaghanMPM

K, GAMMA, MU, RHO = 2.2e9, 7.15, 1.0e3, 1000.0
MODEL = MurnaghanMPM(K, GAMMA, MU, 101325.0, RHO)


def test_pressure_and_viscosity():
    dt, F = 1e-4, np.eye(3) + SAMPLE
    driver = Driver(MODEL)
    stress = driver.advance(F, dt)
    d, J = (SAMPLE + SAMPLE.T) / 2 / dt, np.linalg.det(F)
    expected = -K * (J**-GAMMA - 1) * np.eye(3) + 2 * MU * (d - np.trace(d) / 3 * np.eye(3))
    np.testing.assert_allclose(stress, expected, rtol=1e-10)
    assert driver.sound_speed == pytest.approx(np.sqrt(GAMMA * K * J ** (1 - GAMMA) / RHO), rel=1e-12)


def test_initial_sound_speed():
    np.testing.assert_allclose(initial_sound_speed(MODEL, np.array([500.0]), 300.0), np.sqrt(K / 500.0))


def test_pressure_is_objective():
    assert_blind_to_spin(MODEL._replace(viscosity=0.0))


def test_kernel():
    assert_kernel_agrees(MODEL, viscosity=True)
