"""Compressible neo-Hookean material against closed forms and a plain reference."""

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

from solver.declare import FAMILIES, fields
from solver.materials.comp_neo_hook import CompNeoHook, CompNeoHookPlastic
from solver.materials.constitutive import NoState, initial_sound_speed, initialize, state_record
from solver.particles import Particles, new_arrays, state_variables
from solver.random import musil, patch_seed

K, G, Y, H = 130.0e9, 46.0e9, 0.4e9, 1.5e9
ELASTIC = CompNeoHook(K, G)
PLASTIC = CompNeoHookPlastic(K, G, yield_stress=Y, hardening_modulus=H)


def energy(F):
    J = np.linalg.det(F)
    b = F @ F.T / J ** (2 / 3)
    return K / 2 * ((J**2 - 1) / 2 - np.log(J)) + G / 2 * (np.trace(b) - 3)


def test_names():
    models = FAMILIES["constitutive_model"].models
    assert models["comp_neo_hook"] is models["UCNH"] is CompNeoHook
    assert models["comp_neo_hook_plastic"] is CompNeoHookPlastic


@pytest.mark.parametrize("J", [0.6, 0.99, 1.0, 1.4])
def test_volume_change(J):
    driver = Driver(ELASTIC)
    stress = driver.advance(np.eye(3) * J ** (1 / 3))
    np.testing.assert_allclose(stress, K / 2 * (J - 1 / J) * np.eye(3), rtol=1e-12, atol=K * 1e-13)
    assert driver.sound_speed == pytest.approx(np.sqrt((K + 4 * G / 3) * J / MATERIAL.density), rel=1e-12)


def test_simple_shear():
    """sigma_xy = G gamma and the normal-stress difference G gamma^2 (Poynting)."""
    gamma = 0.3
    stress = Driver(ELASTIC).advance([[1, gamma, 0], [0, 1, 0], [0, 0, 1]])
    assert stress[0, 1] == pytest.approx(G * gamma, rel=1e-13)
    assert stress[0, 0] - stress[1, 1] == pytest.approx(G * gamma**2, rel=1e-12)


def test_stress_is_the_derivative_of_the_energy():
    F = sample_path(1)[0]
    driver = Driver(ELASTIC)
    stress = driver.advance(F)
    np.testing.assert_allclose(stress, stress_from_energy(energy, F), atol=1e-8 * K)
    assert driver.strain_energy == pytest.approx(2.0 * energy(F), rel=1e-12)


def test_thermal_expansion_at_free_stretch_is_without_stress():
    material = MATERIAL._replace(thermal_expansion=1e-4)
    stretch = 1 + 1e-4 * 200
    stress = Driver(ELASTIC, material, temperature=500.0).advance(np.eye(3) * stretch)
    np.testing.assert_allclose(stress, 0.0, atol=1e-12 * K)


def test_failed_particles_count_no_energy():
    driver = Driver(ELASTIC)
    driver.particles.localized[0] = 1
    driver.advance(np.eye(3) * 1.1)
    assert driver.strain_energy == 0.0
    assert driver.localized == 1


def plain_radial_return(path):
    """Box 9.1 of Simo and Hughes, in numpy."""
    b, ep, old, stresses = np.eye(3), 0.0, np.eye(3), []
    for F in path:
        f = F @ np.linalg.inv(old)
        f = f / np.linalg.det(f) ** (1 / 3)
        b = f @ b @ f.T
        mean = np.trace(b) / 3
        s = G * (b - mean * np.eye(3))
        size = np.sqrt((s * s).sum())
        excess = size - np.sqrt(2 / 3) * (Y + H * ep)
        if excess > 0:
            slip = excess / (2 * G * mean + 2 / 3 * H)
            s = s * (1 - 2 * G * mean * slip / size)
            ep += np.sqrt(2 / 3) * slip
            b = s / G + mean * np.eye(3)
        J = np.linalg.det(F)
        stresses.append(K / 2 * (J - 1 / J) * np.eye(3) + s / J)
        old = F
    return np.array(stresses), ep, b


def test_plastic_path_against_plain_reference():
    path = sample_path(40)
    driver = Driver(PLASTIC)
    stresses, ep, b = plain_radial_return(path)
    np.testing.assert_allclose(driver.follow(path), stresses, rtol=1e-9, atol=1e-9 * Y)
    assert ep > 0.05
    assert driver.state.plastic_strain[0] == pytest.approx(ep, rel=1e-10)
    np.testing.assert_allclose(driver.state.elastic_stretch[0], b, atol=1e-12)


def test_yielding_stress_lies_on_the_yield_surface():
    driver = Driver(PLASTIC)
    for F in sample_path(10):
        stress = driver.advance(F)
        deviator = (stress - np.trace(stress) / 3 * np.eye(3)) * np.linalg.det(F)
        flow = Y + H * driver.state.plastic_strain[0]
        assert np.sqrt(1.5 * (deviator**2).sum()) <= flow * (1 + 1e-12)
    assert np.sqrt(1.5 * (deviator**2).sum()) == pytest.approx(flow, rel=1e-12)


def test_below_yield_plastic_is_elastic():
    path = sample_path(10, scale=1e-3)
    np.testing.assert_allclose(
        Driver(PLASTIC).follow(path), Driver(ELASTIC).follow(path), rtol=1e-9, atol=1.0
    )


@pytest.mark.parametrize("model", [ELASTIC, PLASTIC])
def test_objective(model):
    assert_blind_to_spin(model)


@pytest.mark.parametrize(
    "model", [ELASTIC, PLASTIC, ELASTIC._replace(usePlasticity=True, yield_stress=Y, hardening_modulus=H)]
)
def test_kernel(model):
    assert_kernel_agrees(model)


def test_artificial_viscosity():
    driver = Driver(ELASTIC, viscosity=True)
    dt, J = 1e-6, 0.98
    driver.advance(np.diag([J, 1, 1]), dt)
    rate, density = (J - 1) / dt, MATERIAL.density / J
    stretch = abs(rate) * driver.length
    expected = density * (0.2 * np.sqrt(K / density) * stretch + 2.0 * stretch**2)
    assert driver.artificial_pressure == pytest.approx(expected, rel=1e-12)
    driver.advance(np.eye(3), dt)
    assert driver.artificial_pressure == 0.0


def test_state_is_named_as_in_archives():
    assert state_record(ELASTIC) is NoState
    assert state_record(PLASTIC._replace(usePlasticity=False)) is NoState
    labels = {v.label for v in state_variables(state_record(PLASTIC)).values()}
    assert labels == {"p.plasticStrain", "p.yieldStress", "p.bElBar"}


def test_initial_state():
    model = PLASTIC._replace(alpha=0.25, yield_distrib="uniform", yield_range=0.1e9, yield_seed=7)
    particles = new_arrays(Particles, 5)
    state = new_arrays(state_record(model), 5)
    patch = np.array([0, 0, 3, 3, 3])
    initialize(model, state, particles, MATERIAL, patch)
    draws = np.concatenate([musil(patch_seed(7, 0), 2), musil(patch_seed(7, 3), 3)])
    np.testing.assert_allclose(state.yield_stress, Y + (2 * draws - 1) * 0.1e9)
    np.testing.assert_array_equal(state.plastic_strain, 0.25)


def test_initial_pressure_is_in_equilibrium():
    driver = Driver(ELASTIC._replace(useInitialStress=True, initial_pressure=2.0e9))
    at_start = driver.particles.stress[0].copy()
    np.testing.assert_allclose(at_start, -2.0e9 * np.eye(3))
    again = driver.advance(driver.particles.deformation_gradient[0].copy())
    np.testing.assert_allclose(again, at_start, rtol=1e-12, atol=1e-4)


def test_initial_sound_speed():
    speed = initial_sound_speed(ELASTIC, np.array([MATERIAL.density]), np.array([300.0]))
    np.testing.assert_allclose(speed, np.sqrt((K + 4 * G / 3) / MATERIAL.density))


def test_plasticity_needs_a_yield_stress_and_a_slope():
    assert [name for name, _ in CompNeoHookPlastic(K, G).faults()] == ["yield_stress", "hardening_modulus"]
    assert ELASTIC.faults() == []


def test_bounds():
    bounds = {f.name: f.parameter for f in fields(CompNeoHookPlastic)}
    assert bounds["bulk_modulus"].gt == 0.0
    assert bounds["yield_stress"].ge == 0.0
    assert bounds["yield_distrib"].choices == ("constant", "uniform")
