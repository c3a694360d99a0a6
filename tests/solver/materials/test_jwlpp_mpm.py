"""Burning explosive against its equations of state and its rate law."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, Driver, assert_kernel_agrees, assert_turns_with_the_path
from scipy.integrate import solve_ivp

from solver.declare import fields
from solver.materials.constitutive import DELETE, initial_sound_speed, state_record
from solver.materials.jwlpp_mpm import JWLppMPM
from solver.particles import state_variables

KAPPA, N, RATE, POWER = 1.8e-10, 7.4, 2.0e-9, 1.5
HE = MATERIAL._replace(density=1160.0)
MODEL = JWLppMPM(2.0e8, KAPPA, N, 2.9e11, 3.9e9, 1.3e9, 4.4, 1.4, 0.4, RATE, POWER, 1e-10)


def unburned(J):
    return (J**-N - 1) / (N * KAPPA)


def burned(J):
    return 2.9e11 * np.exp(-4.4 * J) + 3.9e9 * np.exp(-1.4 * J) + 1.3e9 * J**-1.4


def cube(J):
    return np.eye(3) * J ** (1 / 3)


def test_unburned_below_ignition():
    driver = Driver(MODEL, HE)
    np.testing.assert_allclose(driver.advance(cube(0.98)), -unburned(0.98) * np.eye(3), rtol=1e-11)
    driver.advance(cube(0.98))
    assert driver.state.burned[0] == 0.0
    expected = np.sqrt(0.98 ** (1 - N) / (KAPPA * 1160.0))
    assert driver.sound_speed == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("fast", [False, True])
def test_burn_follows_the_rate_law(fast):
    """At constant volume f' = G (1 - f) p(f)^b; backward Euler in small steps is accurate to its order."""
    J, dt = 0.85, 2e-8
    driver = Driver(MODEL._replace(doFastStressCompute=fast), HE)
    driver.advance(cube(J), dt)

    def rate(t, f):
        return RATE * (1 - f) * (unburned(J) * (1 - f) + burned(J) * f) ** POWER

    exact = solve_ivp(rate, (0, dt), [0.0], rtol=1e-10, atol=1e-14).y[0, -1]
    stress = driver.advance(cube(J), dt)
    f = driver.state.burned[0]
    assert 0.0 < f < 1.0
    assert f == pytest.approx(exact, rel=2e-2)
    assert driver.state.burned_in_step[0] == f
    np.testing.assert_allclose(stress, -(unburned(J) * (1 - f) + burned(J) * f) * np.eye(3), rtol=1e-8)


def test_step_of_the_burn_is_implicit():
    """One step solves f = f_0 + G (1 - f) p(f)^b dt."""
    J, dt = 0.85, 1e-10
    driver = Driver(MODEL._replace(tolerance_for_Newton_iterations=1e-5), HE)
    driver.advance(cube(J), dt)
    driver.advance(cube(J), dt)
    f = driver.state.burned[0]
    pressure = unburned(J) * (1 - f) + burned(J) * f
    assert f == pytest.approx(RATE * (1 - f) * pressure**POWER * dt, abs=2e-5)
    assert f > 0.0


def test_burn_ends():
    driver = Driver(MODEL._replace(max_burned_fraction=0.6, reaction_G=1e-6), HE)
    for _ in range(3):
        stress = driver.advance(cube(0.85), 1e-8)
    assert driver.state.burned[0] == 0.6
    np.testing.assert_allclose(stress, -(0.4 * unburned(0.85) + 0.6 * burned(0.85)) * np.eye(3), rtol=1e-11)


def test_failed_and_inverted_particles():
    driver = Driver(MODEL, HE)
    driver.particles.stress[0] = 3.0
    driver.particles.localized[0] = 1
    np.testing.assert_array_equal(driver.advance(cube(0.9)), 3.0)
    assert driver.localized == 1
    driver = Driver(MODEL, HE)
    np.testing.assert_array_equal(driver.advance(np.diag([-1.0, 1, 1])), 0.0)
    assert driver.localized == DELETE


def test_initial_pressure_is_in_equilibrium():
    driver = Driver(MODEL._replace(useInitialStress=True, initial_pressure=1e6), HE)
    at_start = driver.particles.stress[0].copy()
    np.testing.assert_allclose(at_start, -1e6 * np.eye(3))
    again = driver.advance(driver.particles.deformation_gradient[0].copy())
    np.testing.assert_allclose(again, at_start, rtol=1e-9, atol=1e-3)


def test_names_and_sound_speed():
    labels = {v.label for v in state_variables(state_record(MODEL)).values()}
    assert labels == {"p.progressF", "p.progressdelF"}
    speed = initial_sound_speed(MODEL, np.array([1160.0]), 300.0)
    np.testing.assert_allclose(speed, 1 / np.sqrt(KAPPA * 1160.0))


def test_isotropic():
    assert_turns_with_the_path(MODEL, [cube(0.95), cube(0.9)], 1e-9, material=HE)


@pytest.mark.parametrize("fast", [False, True])
def test_kernel(fast):
    model = MODEL._replace(doFastStressCompute=fast)
    assert_kernel_agrees(model, [cube(J) for J in (0.9, 0.85, 0.8)], 1e-9, material=HE, viscosity=True)


def test_bounds():
    bounds = {f.name: f.parameter for f in fields(JWLppMPM)}
    assert bounds["murnaghan_K"].gt == 0.0
    assert bounds["max_burned_fraction"].le == 1.0
    assert bounds["num_taylor_terms"].ignored
