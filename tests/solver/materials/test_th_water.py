"""Water of Thomsen and Hartka against their equation of state."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, Driver, assert_kernel_agrees, assert_turns_with_the_path
from scipy.optimize import brentq

from solver.declare import fields
from solver.materials.constitutive import initial_sound_speed
from solver.materials.th_water import THWater

A, B, CO, KO, TO, L, VO = 2e-7, 2.6, 4205.7, 5e-10, 277.0, 8e-6, 1.00008e-3
MODEL = THWater(A, B, CO, KO, TO, L, VO)
WATER = MATERIAL._replace(density=999.0)


def specific_volume(p, T):
    return VO * (1 - KO * p + L * (T - TO + A * p) ** 2)


@pytest.mark.parametrize("T", [275.0, 300.0, 350.0])
@pytest.mark.parametrize("J", [0.99, 1.0, 1.004])
def test_pressure_solves_the_equation_of_state(T, J):
    driver = Driver(MODEL, WATER, temperature=T)
    stress = driver.advance(np.eye(3) * J ** (1 / 3))
    pressure = brentq(lambda p: specific_volume(p, T) - J / 999.0, -4e8, 4e8, xtol=1e-3)
    np.testing.assert_allclose(stress, (101325.0 - pressure) * np.eye(3), rtol=1e-9, atol=0.01)


def test_compression_heats():
    J, dt = 0.99, 1e-6
    driver = Driver(MODEL, WATER)
    pressure = 101325.0 - driver.advance(np.eye(3) * J ** (1 / 3), dt)[0, 0]
    expected = -pressure * (J - 1) * J / (999.0 * CO) / dt
    assert driver.heating_rate == pytest.approx(expected, rel=1e-9)


def test_sound_speed():
    """At the density maximum the isentropic and the isothermal slopes of pressure are the same."""
    pressure = 101325.0
    T = TO - A * pressure
    density = 1 / specific_volume(pressure, T)
    speed = initial_sound_speed(MODEL, np.array([density]), np.array([T]))
    h = 10.0
    slope = 2 * h / (1 / specific_volume(pressure + h, T) - 1 / specific_volume(pressure - h, T))
    assert speed[0] == pytest.approx(np.sqrt(slope), rel=1e-5)
    assert speed[0] == pytest.approx(1414.0, abs=5.0)


def test_isotropic():
    assert_turns_with_the_path(MODEL, [np.eye(3) * s for s in (0.999, 0.995)], material=WATER, rtol=1e-8)


def test_kernel():
    path = [np.eye(3) * s for s in (0.999, 0.995, 1.0001)]
    assert_kernel_agrees(MODEL, path, material=WATER, rtol=1e-9)


def test_bounds():
    assert {f.parameter.gt for f in fields(THWater) if f.name in ("a", "ko", "L", "vo")} == {0.0}
