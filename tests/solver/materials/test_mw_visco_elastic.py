"""Standard linear solid against its relaxation function."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, SAMPLE, Driver, assert_kernel_agrees, assert_turns_with_the_path

from solver.materials.constitutive import initial_sound_speed, state_record
from solver.materials.mw_visco_elastic import MWViscoElastic
from solver.particles import state_variables

GE, KE, GV, KV, ETA_V, ETA_D = 4.0e6, 9.0e6, 6.0e6, 3.0e6, 3.0e3, 2.4e3
MODEL = MWViscoElastic(GE, KE, GV, KV, ETA_V, ETA_D)


def steady(rate, dt, steps):
    path = [np.eye(3)]
    for _ in range(steps):
        path.append((np.eye(3) + dt * rate) @ path[-1])
    return path[1:]


def test_steady_shearing():
    """s = eta_d d (1 - exp(-t/tau)), tau = eta_d / (2 G_v); backward Euler is of first order."""
    dt, steps, rate = 1e-7, 3000, 1.0
    stress = Driver(MODEL).follow(steady(np.array([[0, rate, 0], [0, 0, 0], [0, 0, 0]]), dt, steps), dt)[-1]
    t, tau = dt * steps, ETA_D / (2 * GV)
    expected = GE * rate * t + ETA_D * rate / 2 * (1 - np.exp(-t / tau))
    assert stress[0, 1] == pytest.approx(expected, rel=1e-4)


def test_steady_dilatation():
    dt, steps, rate = 1e-7, 3000, 1.0
    stress = Driver(MODEL).follow(steady(rate / 3 * np.eye(3), dt, steps), dt)[-1]
    t, tau = dt * steps, ETA_V / (3 * KV)
    expected = KE * rate * t + ETA_V * rate / 3 * (1 - np.exp(-t / tau))
    np.testing.assert_allclose(stress, expected * np.eye(3), rtol=1e-4, atol=1e-6)


def test_energy_of_springs_and_dashpot():
    dt, L = 1e-5, 20.0 * SAMPLE
    driver = Driver(MODEL)
    driver.follow(steady(L, dt, 4), dt)
    state, volume = driver.state, driver.particles.volume[0]
    s, e = state.viscous_deviator[0], state.elastic_deviator[0]
    pressure = state.viscous_pressure[0] + state.elastic_pressure[0]
    stored = (s**2).sum() / (4 * GV) + (e**2).sum() / (4 * GE) + pressure**2 / (2 * (KE + KV))
    assert driver.strain_energy == pytest.approx(volume * (stored + dt * (s**2).sum() / ETA_D), rel=1e-12)
    stress = driver.particles.stress[0]
    np.testing.assert_allclose(stress, e + s - pressure * np.eye(3), atol=1e-9 * np.abs(stress).max())


def test_state_is_named_as_in_archives():
    labels = {v.label for v in state_variables(state_record(MODEL)).values()}
    assert labels == {"p.stress_e", "p.stress_e_v", "p.stress_e_d", "p.stress_ve_v", "p.stress_ve_d"}


def test_sound_speed():
    expected = np.sqrt((KE + KV + 4 * (GE + GV) / 3) / MATERIAL.density)
    np.testing.assert_allclose(initial_sound_speed(MODEL, np.array([MATERIAL.density]), 300.0), expected)


def test_turned_path():
    assert_turns_with_the_path(MODEL)


def test_kernel():
    assert_kernel_agrees(MODEL, viscosity=True)
