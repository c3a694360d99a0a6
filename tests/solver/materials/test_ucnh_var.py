"""Neo-Hookean material with constants by colour against the one with fixed constants."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, Driver, assert_blind_to_spin, assert_kernel_agrees, sample_path

from solver.declare import FAMILIES
from solver.materials.comp_neo_hook import CompNeoHook, CompNeoHookPlastic
from solver.materials.constitutive import initial_sound_speed, initialize, state_record
from solver.materials.ucnh_var import Entry, UCNHVar, VariableProperties
from solver.particles import Particles, new_arrays

SOFT = Entry(0.0, 1.0e9, 0.4e9, 1.0e6, 2.0e7)
HARD = Entry(2.0, 5.0e9, 2.0e9, 9.0e6, 6.0e7)
MODEL = UCNHVar(VariableProperties((SOFT, HARD)))


def at_color(model, color):
    driver = Driver(model)
    driver.particles.color[0] = color
    initialize(model, driver.state, driver.particles, MATERIAL, np.zeros(1, int))
    return driver


@pytest.mark.parametrize(("color", "share"), [(-1.0, 0.0), (0.0, 0.0), (0.5, 0.25), (2.0, 1.0), (7.0, 1.0)])
@pytest.mark.parametrize("plastic", [False, True])
def test_constants_are_interpolated(color, share, plastic):
    K, G, Y, H = ((1 - share) * np.array(SOFT[1:]) + share * np.array(HARD[1:])).tolist()
    fixed = CompNeoHookPlastic(K, G, yield_stress=Y, hardening_modulus=H) if plastic else CompNeoHook(K, G)
    driver = at_color(MODEL._replace(usePlasticity=plastic), color)
    expected = Driver(fixed)
    path = sample_path(10)
    np.testing.assert_allclose(driver.follow(path), expected.follow(path), rtol=1e-12, atol=1e-3)
    np.testing.assert_allclose(driver.answer, expected.answer, rtol=1e-12)


def test_registered_with_the_state_of_its_kind():
    assert FAMILIES["constitutive_model"].models["UCNHVar"] is UCNHVar
    assert "plastic_strain" not in state_record(MODEL)._fields
    assert "plastic_strain" in state_record(MODEL._replace(usePlasticity=True))._fields


def test_initial_state():
    model = MODEL._replace(useInitialStress=True, initial_pressure=1e6)
    particles = new_arrays(Particles, 3)
    particles.color[...] = [0.0, 1.0, 2.0]
    state = new_arrays(state_record(model), 3)
    initialize(model, state, particles, MATERIAL, np.zeros(3, int))
    np.testing.assert_allclose(state.bulk_modulus, [1e9, 3e9, 5e9])
    np.testing.assert_allclose(particles.stress, np.broadcast_to(-1e6 * np.eye(3), (3, 3, 3)))
    np.testing.assert_allclose(initial_sound_speed(model, np.array([1000.0]), 300.0), np.sqrt(7 / 3 * 5e6))


def test_objective():
    assert_blind_to_spin(MODEL._replace(usePlasticity=True))


@pytest.mark.parametrize("plastic", [False, True])
def test_kernel(plastic):
    assert_kernel_agrees(MODEL._replace(usePlasticity=plastic))


def test_entries_must_rise():
    assert MODEL.faults() == []
    assert UCNHVar(VariableProperties((SOFT,))).faults()
    assert UCNHVar(VariableProperties((HARD, SOFT))).faults()
