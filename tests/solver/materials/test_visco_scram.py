"""Visco-SCRAM against a plain integration of its equations."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import (
    MATERIAL,
    SAMPLE,
    Driver,
    assert_kernel_agrees,
    assert_turns_with_the_path,
    rotation_matrix,
    sample_path,
)

from solver.declare import fields
from solver.materials.constitutive import initial_sound_speed, state_record, time_step_limit
from solver.materials.visco_scram import ViscoScram
from solver.particles import state_variables
from solver.random import drand48

MODULI = np.array([3.5e8, 1.739e8, 5.212e8, 9.085e8, 6.875e8])
RATES = np.array([0.0, 7.32e3, 7.32e4, 7.32e5, 2.0e6])
PBX = ViscoScram(
    0.3,
    1e-3,
    10.0,
    300.0,
    5e5,
    0.35,
    3e-5,
    12.0,
    *MODULI,
    *RATES,
    Beta=1.5e-4,
    Gamma=1.0,
    DCp_DTemperature=3.3,
)
EXPLOSIVE = MATERIAL._replace(density=1830.0, specific_heat=1000.0)
G = MODULI.sum()
K = 2 * G * 1.3 / (3 * 0.4)
WITHOUT_CRACKS = PBX._replace(CrackParameterA=1e6)


def path_of(rate, dt, steps):
    """Deformation gradients of a constant velocity gradient, by forward steps."""
    F = [np.eye(3)]
    for _ in range(steps):
        F.append((np.eye(3) + dt * rate) @ F[-1])
    return F[1:]


def test_maxwell_elements_without_cracks():
    """Steady shearing: s_xy = sum of 2 G_k d tau_k (1 - exp(-t/tau_k))."""
    dt, steps, rate = 2e-8, 200, 50.0
    L = np.array([[0.0, rate, 0], [0, 0, 0], [0, 0, 0]])
    stress = Driver(WITHOUT_CRACKS, EXPLOSIVE).follow(path_of(L, dt, steps), dt)[-1]
    t = dt * steps
    expected = MODULI[0] * rate * t + (MODULI[1:] * rate / RATES[1:] * (1 - np.exp(-RATES[1:] * t))).sum()
    assert stress[0, 1] == pytest.approx(expected, rel=1e-5)


def test_pressure_is_elastic():
    dt = 1e-8
    driver = Driver(PBX, EXPLOSIVE)
    stress = driver.follow(path_of(-100.0 * np.eye(3), dt, 10), dt)[-1]
    np.testing.assert_allclose(stress, -K * 300.0 * 10 * dt * np.eye(3), rtol=1e-6, atol=1.0)


def growth_speed(c, tension, mean, squared, rate):
    """Crack speed as a function of the radius, from the paper's equations 24 to 31."""
    m, K0, mu = 10.0, 5e5, 0.35
    limit = min(np.exp(0.90564746 * np.log(rate) - 2.90178468) * (12.0 if tension else 1.0), 300.0)
    driving = np.sqrt(squared + (3 * mean**2 if tension else 0.0))
    KI = np.sqrt(1.5 * np.pi * c) * driving
    a = 0.0 if tension else -np.sqrt(45 / (2 * (3 - 2 * mu**2))) * mu * mean
    return limit, m, K0, KI, a


def crack_speed(c, c_old, tension, mean, squared, rate):
    limit, m, K0, KI, a = growth_speed(c, tension, mean, squared, rate)
    b = 1 + a * np.sqrt(c_old) / K0
    threshold = K0 * np.sqrt(1 + np.pi * a * np.sqrt(c_old) * b / K0)
    transition = threshold * np.sqrt(1 + 2 / m)
    if growth_speed(c_old, tension, mean, squared, rate)[3] < transition:
        return limit * (KI / (transition * (1 + m / 2) ** (1 / m))) ** m
    return limit * (1 - threshold**2 / KI**2)


def runge_kutta(slope, y, dt, *args):
    k1 = slope(y, *args) * dt
    k2 = slope(y + k1 / 2, *args) * dt
    k3 = slope(y + k2 / 2, *args) * dt
    k4 = slope(y + k3, *args) * dt
    return y + (k1 + 2 * k2 + 2 * k3 + k4) / 6, np.array([y, y + k1 / 2, y + k2 / 2, y + k3])


def reference(path, dt):
    """The whole update in numpy, elements one after the other."""
    s = np.zeros((5, 3, 3))
    sigma, c, old, out = np.zeros((3, 3)), 3e-5, np.eye(3), []
    for F in path:
        L = (F @ np.linalg.inv(old) - np.eye(3)) / dt
        d = (L + L.T) / 2
        e = d - np.trace(d) / 3 * np.eye(3)
        mean = np.trace(sigma) / 3
        dev = sigma - mean * np.eye(3)
        args = (c, mean > 0, mean, (dev**2).sum(), np.sqrt(1.5 * (e**2).sum()))
        speed = crack_speed(c, *args)
        new_c, radii = runge_kutta(crack_speed, c, dt, *args)
        for k in range(5):
            stages = []
            for i, weight in enumerate((0, 0.5, 0.5, 1)):
                trial = s + (weight * stages[-1] if stages else 0.0)
                total, relaxed = trial.sum(axis=0), np.einsum("k,kij", RATES, trial)
                growth, opened = 3 * radii[i] ** 2 * speed / 1e-9, radii[i] ** 3 / 1e-9
                total_rate = (2 * G * e - relaxed - growth * total) / (1 + opened)
                cracks = growth * total + opened * total_rate
                stages.append(dt * (2 * MODULI[k] * e - RATES[k] * trial[k] - MODULI[k] / G * cracks))
            s[k] += (stages[0] + 2 * stages[1] + 2 * stages[2] + stages[3]) / 6
        c, old = new_c, F
        sigma = s.sum(axis=0) + (mean + K * np.trace(d) * dt) * np.eye(3)
        total = s.sum(axis=0)
        opened = (c / 1e-3) ** 3
        growth = 3 * opened / c * speed
        total_rate = (2 * G * d - growth * total - np.einsum("k,kij", RATES, s)) / (1 + opened)
        cracking = ((total**2).sum() * growth + (total * total_rate).sum() * opened) / (2 * G)
        viscous = sum((s[k] ** 2).sum() * RATES[k] / (2 * MODULI[k]) for k in range(5))
        capacity = EXPLOSIVE.density / np.linalg.det(F) * EXPLOSIVE.specific_heat
        out.append((sigma, c, (viscous + cracking) / capacity - 300.0 * np.trace(d)))
    return out


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_against_plain_reference(sign):
    """Tension and compression, through slow and fast growth of cracks."""
    dt = 1e-7
    driver = Driver(PBX, EXPLOSIVE)
    path = path_of(sign * 3e4 * SAMPLE, dt, 40)
    radii = []
    for F, (stress, radius, heating) in zip(path, reference(path, dt), strict=True):
        np.testing.assert_allclose(driver.advance(F, dt), stress, rtol=1e-7, atol=1.0)
        assert driver.state.crack_radius[0] == pytest.approx(radius, rel=1e-9)
        assert driver.heating_rate == pytest.approx(heating, rel=1e-8)
        radii.append(radius)
    assert radii[-1] > 1.003 * radii[0]


def test_energy_is_the_work_of_the_step():
    dt, L = 1e-7, 1e3 * SAMPLE
    driver = Driver(PBX, EXPLOSIVE)
    first, second = path_of(L, dt, 2)
    before, after = driver.advance(first, dt), driver.advance(second, dt)
    work = (L * (before + after) / 2).sum() * dt * 2.0 * np.linalg.det(second)
    assert driver.strain_energy == pytest.approx(work, rel=1e-9)


def test_warm_elements_relax_faster():
    """The shift multiplies the rates by exp(C1 (T - T0) / (C2 + T - T0))."""
    dt, T = 1e-8, 310.0
    shifted = WITHOUT_CRACKS._replace(use_time_temperature_equation=True)
    shift = np.exp(6.5 * 12 / (120 + 12))
    by_hand = WITHOUT_CRACKS._replace(**{f"RTau{k + 1}": RATES[k] * shift for k in range(5)})
    path = path_of(1e3 * SAMPLE, dt, 20)
    expected = Driver(by_hand, EXPLOSIVE, temperature=T).follow(path, dt)
    np.testing.assert_allclose(
        Driver(shifted, EXPLOSIVE, temperature=T).follow(path, dt), expected, rtol=1e-10
    )


def test_elements_that_relax_within_a_step_bear_nothing():
    model = WITHOUT_CRACKS._replace(use_time_temperature_equation=True)
    driver = Driver(model, EXPLOSIVE, temperature=298.0)
    driver.follow(path_of(1e3 * SAMPLE, 1e-7, 3), 1e-7)
    np.testing.assert_array_equal(driver.state.element_5, 0.0)
    assert np.abs(driver.state.element_3).max() > 0.0


def test_thermal_expansion_held():
    driver = Driver(PBX._replace(CoeffThermalExpansion=5e-5, Gamma=0.0), EXPLOSIVE)
    driver.advance(np.eye(3), 1e-7, temperature=302.0)
    np.testing.assert_allclose(driver.advance(np.eye(3), 1e-7), -3 * K * 5e-5 * 2 * np.eye(3), rtol=1e-11)


def test_turned_path():
    assert_turns_with_the_path(PBX, path_of(1e4 * SAMPLE, 1e-7, 20), 1e-7, material=EXPLOSIVE, rtol=1e-8)


def test_objective_rate_turns_stress_with_the_body():
    """Without relaxation a rotation of the strained body turns its deviator; without the option it stays."""
    dt, angle, steps = 1e-7, 0.5, 10
    elastic = PBX._replace(RTau2=0.0, RTau3=0.0, RTau4=0.0, RTau5=0.0)
    F = path_of(1e3 * SAMPLE, dt, 5)
    turns = [rotation_matrix([0, 0, 1], angle * (k + 1) / steps) for k in range(steps)]
    for objective, Q in ((True, turns[-1]), (False, np.eye(3))):
        model = elastic._replace(useObjectiveRate=objective)
        driver = Driver(model, EXPLOSIVE, exact_rates=True)
        stress = driver.follow(F, dt)[-1]
        turned = driver.follow([turn @ F[-1] for turn in turns], dt)[-1]
        np.testing.assert_allclose(turned, Q @ stress @ Q.T, rtol=1e-7, atol=1e-4 * np.abs(stress).max())


@pytest.mark.parametrize("objective", [False, True])
def test_kernel(objective):
    model = PBX._replace(useObjectiveRate=objective, randomize_parameters=True)
    assert_kernel_agrees(model, sample_path(6, 0.01), 1e-7, material=EXPLOSIVE, viscosity=True, rtol=1e-11)


def test_initial_values():
    driver = Driver(PBX._replace(randomize_parameters=True), EXPLOSIVE)
    assert driver.state.crack_radius[0] == 3e-5
    assert driver.state.random[0] == drand48(1)[0]
    assert Driver(PBX).state.random[0] == 0.5
    labels = {v.label for v in state_variables(state_record(PBX)).values()}
    assert {"p.crackRad", "p.rand", "p.deformRate", "p.volHeatRate", "p.veHeatRate", "p.crHeatRate"} <= labels


def test_time_step_and_sound_speed():
    assert time_step_limit(PBX) == 1.0e-6
    np.testing.assert_allclose(
        initial_sound_speed(PBX, np.array([1830.0]), 300.0), np.sqrt((K + 4 * G / 3) / 1830.0)
    )


def test_bounds():
    bounds = {f.name: f.parameter for f in fields(ViscoScram)}
    assert (bounds["PR"].gt, bounds["PR"].lt) == (-1.0, 0.5)
    assert bounds["InitialCrackRadius"].gt == 0.0
    assert bounds["useJWLEOS"].ignored
