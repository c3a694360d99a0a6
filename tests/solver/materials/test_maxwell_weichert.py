"""Maxwell elements at finite strain against relaxation and elasticity in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import (
    MATERIAL,
    Driver,
    assert_blind_to_spin,
    assert_kernel_agrees,
    sample_path,
)

from solver.materials.comp_neo_hook import CompNeoHook
from solver.materials.constitutive import initial_sound_speed
from solver.materials.maxwell_weichert import MaxwellWeichert, Mode, Series

K, G_INF, MODES = 2.0e9, 3.0e6, (Mode(1e-5, 4.0e6), Mode(2e-3, 5.0e6, "slow"))
MODEL = MaxwellWeichert(K, G_INF, Series(MODES))
G_0 = G_INF + sum(m.partial_shear_modulus for m in MODES)


def test_relaxation_of_a_sudden_strain():
    """G(t) = G_inf + sum G_k (tau/dt) (1 - exp(-dt/tau)) exp(-t/tau) after a jump within a step dt."""
    dt, held, F = 1e-6, 25, sample_path(1)[0]
    stress = Driver(MODEL).follow([F] * (held + 1), dt)[-1]
    relaxed = G_INF
    for mode in MODES:
        tau = mode.relaxation_time
        jump = (1 - np.exp(-dt / tau)) * tau / dt
        relaxed += mode.partial_shear_modulus * jump * np.exp(-held * dt / tau)
    np.testing.assert_allclose(stress, Driver(CompNeoHook(K, relaxed)).advance(F), rtol=1e-9, atol=1e-3)


def test_fast_straining_is_elastic_with_all_moduli():
    path = sample_path(5)
    elastic = Driver(CompNeoHook(K, G_0)).follow(path)
    np.testing.assert_allclose(Driver(MODEL).follow(path, 1e-12), elastic, rtol=1e-6, atol=1e-6 * G_0)


def test_sound_speed():
    speed = initial_sound_speed(MODEL, np.array([MATERIAL.density]), 300.0)
    np.testing.assert_allclose(speed, np.sqrt((K + 4 * G_0 / 3) / MATERIAL.density))
    driver = Driver(MODEL)
    driver.advance(np.eye(3))
    assert driver.sound_speed == pytest.approx(speed[0], rel=1e-12)


def test_objective():
    assert_blind_to_spin(MODEL, rtol=1e-9)


def test_kernel():
    assert_kernel_agrees(MODEL, viscosity=True)


def test_number_of_elements():
    assert MODEL.faults() == []
    assert MODEL._replace(viscoelastic_series=Series(())).faults()
    assert MODEL._replace(viscoelastic_series=Series(MODES * 5)).faults()
