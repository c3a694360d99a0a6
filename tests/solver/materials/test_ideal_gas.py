"""Ideal gas against the gas law and the adiabat."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, Driver, assert_kernel_agrees, assert_turns_with_the_path, sample_path

from solver.declare import fields
from solver.materials.constitutive import initial_sound_speed
from solver.materials.ideal_gas import IdealGas

GAMMA, CV, T = 1.4, 717.5, 300.0
AIR = MATERIAL._replace(density=1.1767)
GAS = IdealGas(GAMMA, CV)


@pytest.mark.parametrize("J", [0.5, 1.0, 2.0])
def test_gas_law(J):
    driver = Driver(GAS, AIR, temperature=T)
    stress = driver.advance(np.eye(3) * J ** (1 / 3))
    pressure = AIR.density / J * (GAMMA - 1) * CV * T
    np.testing.assert_allclose(stress, (101325.0 - pressure) * np.eye(3), rtol=1e-12, atol=1e-7)
    assert driver.sound_speed == pytest.approx(np.sqrt(GAMMA * (GAMMA - 1) * CV * T), rel=1e-13)
    assert driver.strain_energy == 0.0


def test_slow_compression_follows_the_adiabat():
    """T V^(gamma-1) stays the same; the forward step has an error of first order."""
    driver = Driver(GAS, AIR, temperature=T)
    dt, steps, temperature = 1e-6, 2000, T
    for k in range(steps):
        driver.advance(np.diag([1 - 0.5 * (k + 1) / steps, 1, 1]), dt)
        temperature += driver.heating_rate * dt
        driver.particles.temperature[0] = temperature
    assert temperature == pytest.approx(T * 2 ** (GAMMA - 1), rel=1e-3)


def test_viscosity_is_its_own():
    driver = Driver(GAS, AIR, viscosity=True)
    dt, J = 1e-5, 0.97
    driver.advance(np.diag([1, J, 1]), dt)
    expected = 6.25 * driver.length**2 * AIR.density / J * ((J - 1) / dt) ** 2
    assert driver.artificial_pressure == pytest.approx(expected, rel=1e-12)
    driver.advance(np.eye(3), dt)
    assert driver.artificial_pressure == 0.0


def test_initial_sound_speed():
    speed = initial_sound_speed(GAS, np.array([1.1767]), np.array([T]))
    assert speed[0] == pytest.approx(347.2, abs=0.1)


def test_isotropic():
    assert_turns_with_the_path(GAS, material=AIR)


def test_kernel():
    assert_kernel_agrees(GAS, sample_path(4), material=AIR, viscosity=True)


def test_bounds():
    bounds = {f.name: f.parameter for f in fields(IdealGas)}
    assert bounds["gamma"].gt == 1.0
    assert bounds["specific_heat"].gt == 0.0
