"""Hypoelastic material against Hooke's law of small strains."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, SAMPLE, Driver, assert_kernel_agrees, assert_turns_with_the_path

from solver.declare import fields
from solver.materials.constitutive import initial_sound_speed
from solver.materials.hypo_elastic import HypoElastic

G, K = 26.0e9, 78.0e9
MODEL = HypoElastic(G, K)


def hooke(strain):
    mean = np.trace(strain) / 3 * np.eye(3)
    return 2 * G * (strain - mean) + 3 * K * mean


def test_small_strain():
    strain = 1e-9 * (SAMPLE + SAMPLE.T) / 2
    stress = Driver(MODEL).advance(np.eye(3) + 1e-9 * SAMPLE)
    np.testing.assert_allclose(stress, hooke(strain), rtol=1e-5)


def test_rate_adds_up_over_steps_and_energy_is_the_work():
    driver, stress, work, F, L, dt = Driver(MODEL), np.zeros((3, 3)), 0.0, np.eye(3), 4e3 * SAMPLE, 1e-6
    for _ in range(5):
        F = (np.eye(3) + dt * L) @ F
        d = (L + L.T) / 2
        new = stress + hooke(d * dt)
        np.testing.assert_allclose(driver.advance(F, dt), new, rtol=1e-9, atol=1.0)
        work = (d * (stress + new) / 2).sum() * 2.0 * np.linalg.det(F) * dt
        assert driver.strain_energy == pytest.approx(work, rel=1e-9)
        stress = new
    assert driver.sound_speed == pytest.approx(
        np.sqrt((K + 4 * G / 3) * np.linalg.det(F) / MATERIAL.density), rel=1e-12
    )


@pytest.mark.parametrize("alpha", [1.2e-5, -1.0e-5])
def test_heated_and_held(alpha):
    """A warming of dT that may not expand gives the pressure 3 K alpha dT, one step later."""
    driver = Driver(MODEL._replace(alpha=alpha))
    driver.advance(np.eye(3), temperature=340.0)
    np.testing.assert_allclose(driver.advance(np.eye(3)), -3 * K * alpha * 40.0 * np.eye(3), rtol=1e-11)


def test_artificial_viscosity_sees_the_mechanical_rate():
    driver = Driver(MODEL._replace(alpha=1e-4), viscosity=True)
    dt = 1e-6
    driver.advance(np.eye(3), dt, temperature=301.0)
    driver.advance(np.eye(3), dt)
    stretch = 3 * 1e-4 / dt * driver.length
    density = MATERIAL.density
    expected = density * (0.2 * np.sqrt(K / density) * stretch + 2.0 * stretch**2)
    assert driver.artificial_pressure == pytest.approx(expected, rel=1e-10)


def test_turned_path():
    assert_turns_with_the_path(MODEL)


def test_initial_sound_speed():
    np.testing.assert_allclose(
        initial_sound_speed(MODEL, np.array([7800.0]), 300.0), np.sqrt((K + 4 * G / 3) / 7800.0)
    )


def test_kernel():
    assert_kernel_agrees(MODEL._replace(alpha=1e-5), viscosity=True)


def test_bounds():
    bounds = {f.name: f.parameter for f in fields(HypoElastic)}
    assert (bounds["G"].ge, bounds["K"].gt) == (0.0, 0.0)
