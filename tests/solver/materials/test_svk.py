"""The material of Saint Venant and Kirchhoff against its energy."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import (
    MATERIAL,
    SAMPLE,
    Driver,
    assert_blind_to_spin,
    assert_kernel_agrees,
    stress_from_energy,
)

from solver.materials.constitutive import initial_sound_speed
from solver.materials.svk import SaintVenantKirchhoff

E, NU = 2.0e9, 0.3
LAME, MU = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
RUBBER = SaintVenantKirchhoff(E, NU)


def energy(F):
    green = 0.5 * (F.T @ F - np.eye(3))
    return 0.5 * LAME * np.trace(green) ** 2 + MU * np.sum(green * green)


@pytest.mark.parametrize("scale", [0.3, 2.0, 5.0])
def test_stress_and_energy_belong_together(scale):
    F = np.eye(3) + scale * SAMPLE
    driver = Driver(RUBBER)
    stress = driver.advance(F)
    np.testing.assert_allclose(stress, stress_from_energy(energy, F), rtol=1e-7, atol=1e-3 * E * 1e-6)
    assert driver.strain_energy == pytest.approx(2.0 * energy(F), rel=1e-12)


@pytest.mark.parametrize("stretch", [0.8, 1.0, 1.4])
def test_uniaxial_strain_in_closed_form(stretch):
    driver = Driver(RUBBER)
    stress = driver.advance(np.diag([stretch, 1.0, 1.0]))
    assert stress[0, 0] == pytest.approx((LAME + 2 * MU) * (stretch**2 - 1) / 2 * stretch, abs=1e-3)
    tangent = (LAME + 2 * MU) * (3 * stretch**2 - 1) / 2  # dP/dF
    speed = stretch * np.sqrt(tangent / MATERIAL.density)
    assert driver.sound_speed >= speed * (1 - 1e-12)
    if stretch >= 1.0:
        assert driver.sound_speed == pytest.approx(speed, rel=1e-12)


def test_the_first_step_knows_the_wave_of_the_bulk():
    assert initial_sound_speed(RUBBER, 1000.0, 300.0) == pytest.approx(np.sqrt((LAME + 2 * MU) / 1000.0))


def test_objective_and_compiled():
    assert_blind_to_spin(RUBBER)
    assert_kernel_agrees(RUBBER)
