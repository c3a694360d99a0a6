"""Slightly compressible liquid against its equation of state and Newton's law of viscosity."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, SAMPLE, Driver, assert_blind_to_spin, assert_kernel_agrees

from solver.declare import fields
from solver.materials.constitutive import DELETE, initial_sound_speed
from solver.materials.water import Water

K, MU, GAMMA = 15.0e6, 1.0e-3, 7.0
WATER = MATERIAL._replace(density=1000.0)
LIQUID = Water(K, MU, GAMMA)


@pytest.mark.parametrize("J", [0.9, 1.0, 1.05])
def test_equation_of_state(J):
    driver = Driver(LIQUID._replace(viscosity=0.0), WATER)
    stress = driver.advance(np.eye(3) * J ** (1 / 3))
    np.testing.assert_allclose(stress, -K * (J**-GAMMA - 1) * np.eye(3), rtol=1e-11, atol=1e-12 * K)
    assert driver.sound_speed == pytest.approx(np.sqrt(GAMMA * K * J ** (1 - GAMMA) / 1000.0), rel=1e-12)


def test_shear_flow():
    dt, gamma = 1e-3, 0.2
    stress = Driver(LIQUID, WATER).advance([[1, gamma, 0], [0, 1, 0], [0, 0, 1]], dt)
    assert stress[0, 1] == pytest.approx(MU * gamma / dt, rel=1e-10)
    np.testing.assert_allclose(np.diag(stress), 0.0, atol=1e-8)


def test_a_general_motion():
    dt, F = 1e-4, np.eye(3) + SAMPLE
    stress = Driver(LIQUID, WATER).advance(F, dt)
    d = (SAMPLE + SAMPLE.T) / 2 / dt
    expected = -K * (np.linalg.det(F) ** -GAMMA - 1) * np.eye(3) + 2 * MU * (d - np.trace(d) / 3 * np.eye(3))
    np.testing.assert_allclose(stress, expected, rtol=1e-10)


@pytest.mark.parametrize(("F", "fate"), [(np.diag([-1.0, 1, 1]), DELETE), (50.0 * np.eye(3), DELETE)])
def test_broken_particles_go(F, fate):
    driver = Driver(LIQUID, WATER)
    driver.advance(F)
    assert driver.localized == fate
    assert np.isfinite(driver.answer).all()


def test_pressure_is_objective():
    assert_blind_to_spin(LIQUID._replace(viscosity=0.0), material=WATER)


def test_initial_sound_speed():
    np.testing.assert_allclose(initial_sound_speed(LIQUID, np.array([1000.0]), 300.0), np.sqrt(K / 1000.0))


def test_kernel():
    assert_kernel_agrees(LIQUID, material=WATER, viscosity=True)


def test_bounds():
    bounds = {f.name: f.parameter for f in fields(Water)}
    assert (bounds["bulk_modulus"].gt, bounds["viscosity"].ge, bounds["gamma"].gt) == (0.0, 0.0, 0.0)
