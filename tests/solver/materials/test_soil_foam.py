"""Crushable foam against its table and its yield surface."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, Driver, assert_kernel_agrees, assert_turns_with_the_path

from solver.materials.constitutive import initial_sound_speed, state_record
from solver.materials.soil_foam import SoilFoam
from solver.particles import state_variables

G, K, A0, A1, A2, PC = 1.0e6, 2.0e7, 1.0e8, 2.0e3, 0.1, -1.0e4
STRAINS = -np.array([0.0, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])
PRESSURES = np.array([0.0, 1e5, 1.2e5, 1.5e5, 2e5, 3e5, 5e5, 9e5, 2e6, 5e6])
FOAM = SoilFoam(G, K, A0, A1, A2, PC, *STRAINS.tolist(), *PRESSURES.tolist())


def table(strain):
    return np.interp(-strain, -STRAINS, PRESSURES)


def cube(strain):
    return np.eye(3) * np.exp(strain / 3)


@pytest.mark.parametrize("strain", [-0.005, -0.03, -0.15, -0.65])
def test_loading_follows_the_table(strain):
    driver = Driver(FOAM)
    np.testing.assert_allclose(driver.advance(cube(strain)), -table(strain) * np.eye(3), rtol=1e-9)
    segment = np.searchsorted(-STRAINS, -strain) - 1
    slope = (PRESSURES[segment + 1] - PRESSURES[segment]) / (STRAINS[segment] - STRAINS[segment + 1])
    assert driver.sound_speed == pytest.approx(np.sqrt((slope + 4 * G / 3) / MATERIAL.density), rel=1e-9)


def test_unloading_is_elastic_and_tension_is_cut():
    driver = Driver(FOAM)
    driver.advance(cube(-0.15))
    np.testing.assert_allclose(
        driver.advance(cube(-0.149)), -(table(-0.15) - K * 1e-3) * np.eye(3), rtol=1e-8
    )
    np.testing.assert_allclose(driver.advance(cube(0.1)), -PC * np.eye(3), rtol=1e-12)
    np.testing.assert_allclose(driver.advance(cube(-0.2)), -table(-0.2) * np.eye(3), rtol=1e-8)
    assert driver.state.least_strain[0] == pytest.approx(-0.2)


def test_shear_is_elastic_then_limited():
    driver = Driver(FOAM)
    assert driver.advance([[1, 1e-4, 0], [0, 1, 0], [0, 0, 1]])[0, 1] == pytest.approx(G * 1e-4, rel=1e-9)
    stress = driver.advance([[1, 0.5, 0], [0, 1, 0], [0, 0, 1]])
    s = stress - np.trace(stress) / 3 * np.eye(3)
    pressure = -np.trace(stress) / 3
    assert (s**2).sum() / 2 == pytest.approx(A0 + A1 * pressure + A2 * pressure**2, rel=1e-8)


def test_energy_is_the_work_of_the_step():
    driver = Driver(FOAM)
    H = 1e-3 * np.array([[-1, 0.3, 0], [0.1, -2, 0.4], [0, 0, 1.0]])
    stress = driver.advance(np.eye(3) + H)
    work = (H * stress / 2).sum() * driver.particles.volume[0]
    assert driver.strain_energy == pytest.approx(work, rel=1e-9)


def test_turned_path():
    path = [np.diag([1 - e, 1, 1 + 0.2 * e]) for e in (0.02, 0.05, 0.04, 0.1)]
    assert_turns_with_the_path(FOAM, path)


def test_kernel():
    path = [np.diag([1 - e, 1, 1 + 0.2 * e]) for e in (0.02, 0.05, 0.04, 0.1)]
    assert_kernel_agrees(FOAM, path, viscosity=True)


def test_names_faults_and_sound_speed():
    labels = {v.label for v in state_variables(state_record(FOAM)).values()}
    assert labels == {"p.sv_minLabel", "p.p_sv_minLabel"}
    assert FOAM.faults() == []
    assert FOAM._replace(eps1=0.1).faults()[0][0] == "eps1"
    np.testing.assert_allclose(
        initial_sound_speed(FOAM, np.array([500.0]), 300.0), np.sqrt((K + 4 * G / 3) / 500.0)
    )
