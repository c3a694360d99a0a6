"""Crushing of pores against the equations of the P-alpha model."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, Driver, assert_blind_to_spin, assert_kernel_agrees, sample_path

from solver.declare import fields
from solver.materials.comp_neo_hook import CompNeoHookPlastic
from solver.materials.constitutive import initial_sound_speed, state_record
from solver.materials.p_alpha import PAlpha
from solver.particles import state_variables

PS, PE, RHO_S, K0, KS, T0, C0, GAMMA, S = 1.0e9, 0.2e9, 2650.0, 5.0e9, 36.0e9, 300.0, 3700.0, 1.1, 1.5
SAND = MATERIAL._replace(density=1800.0, specific_heat=800.0)
MODEL = PAlpha(PS, PE, RHO_S, K0, KS, T0, C0, GAMMA, S)
ALPHA_0 = RHO_S / 1800.0
ALPHA_P = ALPHA_0 * (1 - PE / K0)


def squeeze(J):
    return np.diag([J, 1.0, 1.0])


def pressures(path, **options):
    driver = Driver(MODEL, SAND, **options)
    return [-np.trace(driver.advance(squeeze(J))) / 3 for J in path], driver


def crush_curve(alpha):
    return PS - (PS - PE) * np.sqrt((alpha - 1) / (ALPHA_P - 1))


def test_elastic_and_back():
    (first, second), driver = pressures([0.98, 0.99])
    assert first == pytest.approx(K0 * 0.02, rel=1e-10)
    assert second == pytest.approx(K0 * 0.01, rel=1e-10)
    assert driver.heating_rate == 0.0
    assert driver.sound_speed == pytest.approx(np.sqrt(K0 * 0.99 / 1800.0), rel=1e-12)


def test_crushing_heats():
    J, J_old, dt = 0.8, 0.81, 1e-6
    (_, pressure), driver = pressures([J_old, J])
    assert pressure == pytest.approx(crush_curve(ALPHA_0 * J), rel=1e-10)
    expected = pressure * (1 - J / J_old) / (1800.0 / J * 800.0) / dt
    assert driver.heating_rate == pytest.approx(expected, rel=1e-10)


def test_unloading_is_stiffer():
    (top, down), driver = pressures([0.8, 0.805])
    alpha, least = ALPHA_0 * 0.805, ALPHA_0 * 0.8
    cs, ce = np.sqrt(KS / RHO_S), np.sqrt(K0 / 1800.0)
    h = 1 + (ce - cs) * (alpha - 1) / (cs * (ALPHA_0 - 1))
    slope = min(alpha**2 / KS * (1 - 1 / h**2), -1 / KS)
    assert down == pytest.approx(crush_curve(alpha) + (alpha - least) / slope, rel=1e-9)
    assert top - down > 2 * (crush_curve(least) - crush_curve(alpha))
    assert driver.state.least_alpha[0] == pytest.approx(least, rel=1e-12)
    assert driver.sound_speed == pytest.approx(cs + (ce - cs) * (alpha - 1) / (ALPHA_0 - 1), rel=1e-12)


def test_dense_solid_follows_its_shock_curve():
    """At the temperature of closing p - Ps is that of Mie and Grueneisen, written in compression."""
    J = 0.6
    (_, pressure), _driver = pressures([0.7, J])
    chi = 1 - RHO_S * J / 1800.0
    expected = PS + RHO_S * C0**2 * chi * (1 - GAMMA * chi / 2) / (1 - S * chi) ** 2
    assert pressure == pytest.approx(expected, rel=1e-9)


def test_dense_solid_is_heated_by_compression():
    driver = Driver(MODEL, SAND)
    driver.advance(squeeze(0.7))
    driver.particles.temperature[0] = 350.0
    J, dt = 0.6, 1e-6
    p = -np.trace(driver.advance(squeeze(J), dt)) / 3
    cold, _ = pressures([0.7, J])
    assert p - cold[1] == pytest.approx(GAMMA * 800.0 * 50.0 * RHO_S, rel=1e-9)
    rate = (J / 0.7 - 1) / dt
    assert driver.heating_rate == pytest.approx(-350.0 * GAMMA * RHO_S * rate / (1800.0 / J), rel=1e-9)


@pytest.mark.parametrize(("Ku", "modulus"), [(0.0, K0 / 10), (2.0e8, 2.0e8)])
def test_tension(Ku, modulus):
    stress = Driver(MODEL._replace(Ku=Ku), SAND).advance(squeeze(1.05))
    np.testing.assert_allclose(stress, modulus * 0.05 * np.eye(3), rtol=1e-9)


def test_deviator_is_that_of_the_neo_hookean_metal():
    model = MODEL._replace(shear_modulus=2e9, yield_stress=2e7, hardening_modulus=1e8)
    metal = CompNeoHookPlastic(1e9, 2e9, yield_stress=2e7, hardening_modulus=1e8)
    path = sample_path(10)
    ours, theirs = Driver(model, SAND).follow(path), Driver(metal, SAND).follow(path)
    mean = [np.trace(s, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3) for s in (ours, theirs)]
    np.testing.assert_allclose(ours - mean[0], theirs - mean[1], rtol=1e-9, atol=1.0)


def test_initial_values():
    driver = Driver(MODEL, SAND)
    assert driver.state.least_alpha[0] == ALPHA_0
    assert driver.state.closing_temperature[0] == T0
    np.testing.assert_allclose(initial_sound_speed(MODEL, np.array([1800.0]), T0), np.sqrt(K0 / 1800.0))
    labels = {v.label for v in state_variables(state_record(MODEL)).values()}
    assert labels == {"p.alpha", "p.alphaMin", "p.tempAlpha1", "p.plasticStrain", "p.bElBar"}


def test_objective():
    path = [squeeze(J) @ np.array([[1, 1 - J, 0], [0, 1, 0], [0, 0, 1]]) for J in (0.95, 0.85, 0.7, 0.6)]
    assert_blind_to_spin(MODEL._replace(shear_modulus=1e8, yield_stress=1e6), path, material=SAND)


def test_kernel():
    path = [squeeze(J) for J in (0.97, 0.9, 0.92, 0.6, 0.65, 1.1)]
    assert_kernel_agrees(MODEL._replace(shear_modulus=1e8), path, material=SAND, viscosity=True)


def test_bounds():
    assert next(f.parameter for f in fields(PAlpha) if f.name == "K0").gt == 0.0
    assert MODEL.faults() == []
    assert [name for name, _ in MODEL._replace(Pe=6e9).faults()] == ["Pe", "Pe"]
