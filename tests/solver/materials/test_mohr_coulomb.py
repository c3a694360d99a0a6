"""Mohr-Coulomb soil against an enumeration of active planes and against closed forms."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from point_driver import (
    MATERIAL,
    SAMPLE,
    Driver,
    assert_kernel_agrees,
    assert_turns_with_the_path,
    sample_path,
)

from solver.declare import fields
from solver.materials.constitutive import initial_sound_speed, initialize, state_record
from solver.materials.mohr_coulomb import MohrCoulomb, saturation
from solver.particles import Particles, new_arrays, state_variables

G, K, C, PHI, PSI = 4.0e6, 9.0e6, 2.0e3, 30.0, 10.0
SOIL = MohrCoulomb(G, K, PHI, 11.0, c=C, Psi=PSI)
EARTH = MATERIAL._replace(density=1800.0)


def ratio(angle):
    s = np.sin(np.radians(angle))
    return (1 + s) / (1 - s)


def plane(angle, i, j):
    a = np.zeros(3)
    a[i], a[j] = ratio(angle), -1.0
    return a


STIFFNESS = (K - 2 * G / 3) * np.ones((3, 3)) + 2 * G * np.eye(3)
STRENGTH = 2 * C * np.sqrt(ratio(PHI))


def plain_return(trial):
    """Koiter's rule: the set of planes with non-negative flow on which the stress comes to lie."""
    if plane(PHI, 0, 2) @ trial <= STRENGTH:
        return trial
    for active in ([(0, 2)], [(0, 2), (1, 2)], [(0, 2), (0, 1)]):
        A = np.array([plane(PHI, *pair) for pair in active])
        B = np.array([plane(PSI, *pair) for pair in active])
        flow = np.linalg.solve(A @ STIFFNESS @ B.T, A @ trial - STRENGTH)
        stress = trial - STIFFNESS @ B.T @ flow
        allowed = all(
            plane(PHI, i, j) @ stress <= STRENGTH * (1 + 1e-9) for i, j in itertools.permutations(range(3), 2)
        )
        if allowed and (flow >= -1e-15).all():
            return stress
    return np.full(3, STRENGTH / (ratio(PHI) - 1))


@pytest.mark.parametrize("seed", range(40))
def test_return_from_any_side(seed):
    rng = np.random.default_rng(seed)
    strain = rng.normal(size=(3, 3)) * 10 ** rng.uniform(-4, -2.5)
    strain = (strain + strain.T) / 2
    driver = Driver(SOIL, EARTH)
    start = -1e3 * rng.uniform(0, 20) * np.eye(3)
    driver.particles.stress[0] = start
    stress = driver.advance(np.eye(3) + strain)
    trial = start + 2 * G * strain + (K - 2 * G / 3) * np.trace(strain) * np.eye(3)
    values, axes = np.linalg.eigh(trial)
    expected = axes[:, ::-1] @ np.diag(plain_return(values[::-1])) @ axes[:, ::-1].T
    np.testing.assert_allclose(stress, expected, rtol=1e-8, atol=1e-9 * np.abs(trial).max())


def test_active_earth_pressure():
    """Ground that is stretched sideways ends at s_h = s_v t^2 - 2 c t with t = tan(45 - phi/2)."""
    driver = Driver(SOIL._replace(Psi=0.0), EARTH)
    driver.particles.stress[0] = -5e4 * np.eye(3)
    F = np.eye(3)
    for _ in range(50):
        vertical = driver.particles.stress[0][1, 1]
        give = (5e4 + vertical) / (K + 4 * G / 3)
        F = np.diag([1 + 4e-4, 1 - give, 1.0]) @ F
        stress = driver.advance(F)
    t = np.tan(np.radians(45 - PHI / 2))
    assert -stress[0, 0] == pytest.approx(-stress[1, 1] * t**2 - 2 * C * t, rel=1e-9)


def test_energy_and_sound_speed():
    driver = Driver(SOIL, EARTH)
    stress = driver.advance(np.eye(3) + 1e-4 * SAMPLE)
    work = (1e-4 * SAMPLE * stress / 2).sum() * driver.particles.volume[0]
    assert driver.strain_energy == pytest.approx(work, rel=1e-9)
    density = EARTH.density / np.linalg.det(np.eye(3) + 1e-4 * SAMPLE)
    assert driver.sound_speed == pytest.approx(np.sqrt(5 * (G + 0.3 * K) / 3 / density), rel=1e-12)
    speed = initial_sound_speed(SOIL, np.array([1800.0]), 300.0)
    np.testing.assert_allclose(speed, np.sqrt((K + 4 * G / 3) / 1800.0))


def cohesion_after(model, F, dt=1e-3):
    driver = Driver(model, EARTH)
    driver.advance(F, dt)
    return driver.state.cohesion[0], driver


SHEARED = np.array([[1, 0.02, 0], [0, 1, 0], [0, 0, 1.0]])


def test_cohesion_by_water_content_and_rate():
    model = SOIL._replace(Usetransition=1.0, St=2.0, A1=3.0e3, B1=0.5, W=0.4, beta_rate=0.1, strain_ref=1.0)
    slow, _ = cohesion_after(model, SHEARED, 1e3)
    assert slow == pytest.approx(2.0 * 3.0e3 * 0.4**-0.5, rel=1e-12)
    fast, driver = cohesion_after(model, SHEARED, 1e-3)
    rate = 0.5 * np.sqrt(3 * 10.0**2)
    assert driver.state.shear_strain_rate[0] == pytest.approx(rate, rel=1e-3)
    assert fast == pytest.approx(slow * driver.state.shear_strain_rate[0] ** 0.1, rel=1e-12)


def test_cohesion_by_height():
    model = SOIL._replace(Use_linear=1.0, a=100.0, y_ref=2.0, n=1.0)
    particles = new_arrays(Particles, 3)
    particles.position[:, 1] = [0.0, 2.0, 5.0]
    state = new_arrays(state_record(model), 3)
    initialize(model, state, particles, EARTH, np.zeros(3, int))
    np.testing.assert_array_equal(state.height, [0.0, 2.0, 5.0])
    cohesion, _ = cohesion_after(model._replace(n=0.0, y=5.0), np.eye(3))
    assert cohesion == pytest.approx(C + 300.0)


def test_moduli_by_cohesion():
    cohesion, driver = cohesion_after(SOIL._replace(Usemodul=1.0, m_modul=500.0, nuy=0.25), np.eye(3))
    assert driver.state.shear_modulus[0] == pytest.approx(500.0 * cohesion / 2.5)
    assert driver.state.bulk_modulus[0] == pytest.approx(500.0 * cohesion / 1.5)


@pytest.mark.parametrize("width", [0.0, 0.5])
def test_softening(width):
    model = SOIL._replace(Use_softening=1.0, St=4.0, strain_95=0.1)
    if width:
        model = model._replace(Use_regular=1.0, tFE=1.0, tShear=width)
    cohesion, driver = cohesion_after(model, SHEARED)
    strain = driver.state.shear_strain[0] * (1.0 / width if width else 1.0)
    assert cohesion == pytest.approx(C * (0.25 + 0.75 * 2.71 ** (-30 * strain)), rel=1e-12)


def test_suction():
    """At constant volume the suction stays; in compression the soil comes nearer to saturation."""
    model = SOIL._replace(
        UseWaterRetention=1.0,
        WR_Param1=0.3,
        WR_Param2=1.8,
        WR_Param3=1e-4,
        PhiB=12.0,
        suction=3500.0,
        SpecVol=1.9,
    )
    cohesion, driver = cohesion_after(model, np.eye(3))
    assert driver.state.suction[0] == pytest.approx(3500.0, rel=1e-10)
    assert cohesion == pytest.approx(C + np.tan(np.radians(12.0)) * 3500.0, rel=1e-10)
    cohesion, driver = cohesion_after(model, 0.999 * np.eye(3))
    volume = driver.state.specific_volume[0]
    assert volume == pytest.approx(1.9 * (1 - 3e-3), rel=1e-4)
    water = saturation(model, 3500.0) * 0.9 / 1.9
    assert saturation(model, driver.state.suction[0]) == pytest.approx(
        water * volume / (volume - 1), rel=1e-9
    )


def test_turned_path():
    model = SOIL._replace(Psi=PHI)
    assert_turns_with_the_path(model, sample_path(scale=0.05), material=EARTH, rtol=1e-8)


def test_kernel():
    model = SOIL._replace(Use_softening=1.0, St=4.0, strain_95=0.1, Use_linear=1.0, a=3.0)
    assert_kernel_agrees(model, sample_path(6, 0.1), material=EARTH, viscosity=True, rtol=1e-9)


def test_names_and_bounds():
    labels = {v.label for v in state_variables(state_record(SOIL)).values()}
    assert {"G", "K", "c", "Suction", "shear_strain", "strain11", "y"} <= labels
    bounds = {f.name: f.parameter for f in fields(MohrCoulomb)}
    assert (bounds["G"].gt, bounds["c"].ge, bounds["Version"].ge) == (0.0, 0.0, 11.0)
