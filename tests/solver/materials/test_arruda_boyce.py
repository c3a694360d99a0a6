"""Eight-chain rubber against its energy and the published series."""

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

from solver.declare import fields
from solver.materials.arruda_boyce import ArrudaBoyce8
from solver.materials.constitutive import initial_sound_speed

K, G, BETA = 2.0e8, 5.0e5, 2.6
RUBBER = ArrudaBoyce8(K, G, BETA)


def energy(F):
    """The energy of Arruda and Boyce, their eq. 24 to the fifth power of I1, and that of the volume."""
    J = np.linalg.det(F)
    I1, N = np.trace(F @ F.T) / J ** (2 / 3), BETA**2
    series = (
        (I1 - 3) / 2
        + (I1**2 - 9) / (20 * N)
        + 11 * (I1**3 - 27) / (1050 * N**2)
        + 19 * (I1**4 - 81) / (7000 * N**3)
        + 519 * (I1**5 - 243) / (673750 * N**4)
    )
    return G * series + K / 2 * ((J**2 - 1) / 2 - np.log(J))


@pytest.mark.parametrize("scale", [0.5, 5.0])
def test_stress_is_the_derivative_of_the_energy(scale):
    F = sample_path(1, scale)[0]
    driver = Driver(RUBBER)
    np.testing.assert_allclose(driver.advance(F), stress_from_energy(energy, F), atol=1e-7 * K)
    assert driver.strain_energy == pytest.approx(2.0 * energy(F), rel=1e-10)


def test_stiffens_before_the_chains_lock():
    gamma = np.array([0.1, 2.5])
    shear = [Driver(RUBBER).advance([[1, g, 0], [0, 1, 0], [0, 0, 1]])[0, 1] for g in gamma]
    assert shear[1] / gamma[1] > 1.3 * shear[0] / gamma[0]


def test_initial_sound_speed():
    speed = initial_sound_speed(RUBBER, np.array([MATERIAL.density]), 300.0)
    np.testing.assert_allclose(speed, np.sqrt((K + 4 * G / 3) / MATERIAL.density))


def test_objective():
    assert_blind_to_spin(RUBBER)


def test_kernel():
    assert_kernel_agrees(RUBBER, viscosity=True)


def test_bounds():
    assert next(f.parameter for f in fields(ArrudaBoyce8) if f.name == "beta").gt == 1.0
