"""Viscoplastic ice against steady flow, a plain reference of its equations and failure by hand."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, SAMPLE, Driver, assert_kernel_agrees, sample_path

from solver.declare import fields
from solver.materials.constitutive import initial_sound_speed, initialize, state_record
from solver.materials.equation_of_state.default_hypo import DefaultHypo
from solver.materials.visco_plastic import ViscoPlastic
from solver.materials.viscoplastic_flow.suvic_i import SuvicI
from solver.particles import Particles, new_arrays, state_variables

K, G = 8.9e9, 3.52e9
FACTOR = 5.0e9 * np.exp(-67500.0 / 8.3144 / 269.15)
FLOW = SuvicI(integration_parameter_theta=0.5)
MODEL = ViscoPlastic(K, G, FLOW, DefaultHypo())
ICE = MATERIAL._replace(density=917.0, specific_heat=2000.0)


def deviator(a):
    return a - np.trace(a) / 3 * np.eye(3)


def stiffness(a):
    return (K - 2 * G / 3) * np.trace(a) * np.eye(3) + 2 * G * a


def plain_step(stress, hardening, rate, dt, flow=FLOW):
    """Stress and (Y, K, B) after a step of flow, by the theta rule with the derivatives that Uintah takes."""
    Y, drag, back = hardening
    n = flow.exponent_inelastic_strainrate
    reduced = deviator(stress) - back
    x = np.sqrt(1.5 * (reduced**2).sum())
    normal = 1.5 * reduced / x
    start = FACTOR * ((x - Y) / drag) ** n
    slope = FACTOR * n * ((x - Y) / drag) ** (n - 1) / drag
    power = start / flow.ref_strainrate
    R, S, B = 0.8e6 * power**0.25, 1.0e6 * power**0.25, 0.1e6 * power**0.25
    D = (S - B - R) / (start / FACTOR) ** (1 / n)
    dx = -75e6 + 75e6 / B * (normal * back).sum() - (normal * stiffness(normal)).sum()
    h = -slope * dx + slope * 1600e6 * (1 - Y / R) + slope / drag * 95e6 * (1 - drag / D)
    theta = flow.integration_parameter_theta * dt
    flowing = (start + theta * slope * (stiffness(normal) * rate).sum()) / (1 + theta * h)
    stress = stress + stiffness(rate - flowing * normal) * dt
    back = back + dt * flowing * (2 / 3 * 75e6 * normal - 75e6 / B * back)
    new_Y = Y + dt * 1600e6 * flowing * (1 - Y / R) if Y < R else Y
    new_drag = drag + dt * 95e6 * flowing * (1 - drag / D) if drag < D else drag
    return stress, (new_Y, new_drag, back), flowing


@pytest.mark.parametrize(("theta", "dt"), [(0.0, 0.02), (0.5, 0.5), (1.0, 0.5)])
def test_steps_of_the_equations(theta, dt):
    flow = FLOW._replace(integration_parameter_theta=theta)
    driver = Driver(MODEL._replace(visco_plasticity_model=flow), ICE)
    rate = 1e-4 * SAMPLE
    F = np.eye(3)
    F = (np.eye(3) + rate * dt) @ F
    stress = driver.advance(F, dt)
    np.testing.assert_allclose(stress, stiffness((rate + rate.T) / 2) * dt, rtol=1e-7)
    hardening, strain = (0.0, 0.05e6, np.zeros((3, 3))), 0.0
    for _ in range(60):
        F = (np.eye(3) + rate * dt) @ F
        stress, hardening, flowing = plain_step(stress, hardening, (rate + rate.T) / 2, dt, flow)
        strain += flowing * dt
        np.testing.assert_allclose(driver.advance(F, dt), stress, rtol=1e-7, atol=1e-2)
    assert hardening[0] > 10.0
    assert driver.state.plastic_strain[0] == pytest.approx(strain, rel=1e-7)
    assert driver.state.yield_stress[0] == pytest.approx(hardening[0], rel=1e-7)
    assert driver.state.drag_stress[0] == pytest.approx(hardening[1], rel=1e-7)
    np.testing.assert_allclose(driver.state.back_stress[0], hardening[2], rtol=1e-6, atol=1.0)


def test_steady_flow():
    """At a constant rate e the equivalent stress ends at s0 (e / e0)^(1/n)."""
    rate, dt = 1e-6, 20.0
    driver = Driver(MODEL._replace(coeff_thermal_expansion=0.0), ICE)
    stretching = rate * np.diag([1.0, -0.5, -0.5])
    F = np.eye(3)
    for _ in range(1500):
        F = (np.eye(3) + stretching * dt) @ F
        stress = driver.advance(F, dt)
    equivalent = np.sqrt(1.5) * np.linalg.norm(deviator(stress))
    assert equivalent == pytest.approx(1.0e6 * (rate / 7.794e-8) ** 0.25, rel=0.02)
    heating = 0.9 * equivalent * rate / (917.0 / np.linalg.det(F) * 2000.0)
    assert driver.heating_rate == pytest.approx(heating, rel=0.02)
    assert driver.state.plastic_temperature[0] - 269.15 > 0.0


def test_thermal_strain_makes_pressure():
    driver = Driver(MODEL._replace(coeff_thermal_expansion=1e-5), ICE)
    driver.advance(np.eye(3) * (1 + 1e-6), temperature=310.0)
    stress = driver.advance(np.eye(3) * (1 + 2e-6))
    assert np.trace(stress) / 3 == pytest.approx(K * 6e-6 - 3 * K * 1e-5 * 10.0, rel=1e-5)


def failing(**changes):
    model = MODEL._replace(check_failure=True, failure_variable_mean=3e5, **changes)
    driver = Driver(model, ICE)
    F = np.eye(3)
    for _ in range(100):
        F = (np.eye(3) + 1e-4 * np.diag([1.0, -0.2, -0.2]) * 0.5) @ F
        stress = driver.advance(F, 0.5)
        if driver.state.failed[0]:
            return driver, stress, F
    raise AssertionError("no failure")


def test_failure_by_principal_stress():
    driver, stress, F = failing()
    np.testing.assert_array_equal(stress, 0.0)
    assert driver.strain_energy == 0.0
    drag = driver.state.drag_stress[0]
    np.testing.assert_array_equal(driver.advance(1.001 * F, 0.5), 0.0)
    assert driver.state.drag_stress[0] == drag
    _, kept, _ = failing(zero_stress_upon_failure=False)
    assert np.linalg.eigvalsh(kept)[-1] > 3e5


def test_failure_leaves_no_tension():
    _, stress, _ = failing(zero_stress_upon_failure=False, allow_no_tension=True)
    np.testing.assert_array_equal(stress, 0.0)


def test_failure_by_mean_stress_and_by_strain():
    driver, _, _ = failing(failure_by_pressure=True, zero_stress_upon_failure=False)
    assert np.trace(driver.particles.stress[0]) / 3 > 3e5
    model = MODEL._replace(check_failure=True, failure_by_stress=False, failure_variable_mean=5e-4)
    driver = Driver(model, ICE)
    F = np.eye(3)
    for step in range(1, 30):
        F = (np.eye(3) + 1e-4 * np.diag([1.0, -0.5, -0.5]) * 0.5) @ F
        driver.advance(F, 0.5)
        strain = 0.5 * (1 - F[0, 0] ** -2)
        assert bool(driver.state.failed[0]) == (strain > 5e-4), step
    assert driver.state.failed[0]


def test_rest_keeps_stress():
    driver = Driver(MODEL, ICE)
    stress = driver.advance(np.eye(3) + 1e-7 * SAMPLE, 1.0)
    np.testing.assert_array_equal(driver.advance(np.eye(3) + 1e-7 * SAMPLE, 1.0), stress)
    assert driver.strain_energy == 0.0


def test_start():
    particles = new_arrays(Particles, 500)
    model = MODEL._replace(
        failure_variable_mean=10.0, failure_variable_std=2.0, failure_variable_distrib=' "gauss" '
    )
    state = new_arrays(state_record(model), 500)
    initialize(model, state, particles, ICE, np.zeros(500, int))
    assert state.strength.mean() == pytest.approx(10.0, abs=0.3)
    assert state.strength.std() == pytest.approx(2.0, abs=0.3)
    np.testing.assert_array_equal(state.drag_stress, 0.05e6)
    initialize(
        model._replace(failure_variable_distrib='"constant"'), state, particles, ICE, np.zeros(500, int)
    )
    np.testing.assert_array_equal(state.strength, 10.0)
    speed = initial_sound_speed(MODEL, np.array([917.0]), 300.0)
    np.testing.assert_allclose(speed, np.sqrt((K + 4 * G / 3) / 917.0))


def test_kernel():
    path = sample_path(6, 1e-4)
    assert_kernel_agrees(MODEL._replace(check_failure=True), path, dt=0.5, material=ICE, rtol=1e-10)


def test_names_and_faults():
    labels = {v.label for v in state_variables(state_record(MODEL)).values()}
    assert {"p.yield", "p.drag", "p.backstress", "p.varf", "p.localized", "p.plasticStrain"} <= labels
    assert MODEL.faults() == []
    wrong = MODEL._replace(failure_variable_distrib="uniform")
    assert [name for name, _ in wrong.faults()] == ["failure_variable_distrib"]
    assert {f.name: f.parameter for f in fields(SuvicI)}["intial_drag"].gt == 0.0
