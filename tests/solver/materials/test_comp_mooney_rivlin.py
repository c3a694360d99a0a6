"""Mooney-Rivlin rubber against its energy and its closed forms."""

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
from solver.materials.comp_mooney_rivlin import CompMooneyRivlin
from solver.materials.constitutive import initial_sound_speed

C1, C2, NU = 1.0e5, 2.0e4, 0.45
RUBBER = CompMooneyRivlin(C1, C2, NU)
C3 = C1 / 2 + C2
C4 = (C1 * (5 * NU - 2) + C2 * (11 * NU - 5)) / (2 * (1 - 2 * NU))


def energy(F):
    b = F @ F.T
    I1, I3 = np.trace(b), np.linalg.det(b)
    I2 = (I1**2 - np.trace(b @ b)) / 2
    return C1 * (I1 - 3) + C2 * (I2 - 3) + C3 * (I3**-2 - 1) + C4 * (I3 - 1) ** 2


def test_stress_is_the_derivative_of_the_energy():
    F = sample_path(1, 3.0)[0]
    driver = Driver(RUBBER)
    np.testing.assert_allclose(driver.advance(F), stress_from_energy(energy, F), atol=1e-7 * C1)
    assert driver.strain_energy == pytest.approx(2.0 * energy(F), rel=1e-12)


def test_undeformed_is_without_stress():
    np.testing.assert_allclose(Driver(RUBBER).advance(np.eye(3)), 0.0, atol=1e-9)


def test_simple_shear():
    """sigma_xy = 2 (C1 + C2) gamma for any gamma, in shear at constant volume."""
    stress = Driver(RUBBER).advance([[1, 0.7, 0], [0, 1, 0], [0, 0, 1]])
    assert stress[0, 1] == pytest.approx(2 * (C1 + C2) * 0.7, rel=1e-12)


def test_poisson_ratio_of_small_strains():
    """Uniaxial strain: the lateral stress is nu / (1 - nu) of the axial one."""
    stress = Driver(RUBBER).advance(np.diag([1 + 1e-7, 1, 1]))
    assert stress[1, 1] / stress[0, 0] == pytest.approx(NU / (1 - NU), rel=1e-5)


def test_sound_speeds():
    shear = 2 * (C1 + C2)
    expected = np.sqrt(2 * shear * (1 - NU) / (1 - 2 * NU) / MATERIAL.density)
    np.testing.assert_allclose(initial_sound_speed(RUBBER, np.array([MATERIAL.density]), 300.0), expected)
    driver = Driver(RUBBER)
    stress = driver.advance(np.diag([1.1, 0.95, 1.0]))
    J = 1.1 * 0.95
    squares = np.array([1.1, 0.95, 1.0]) ** 2
    I2, I3 = squares[0] * squares[1] + squares[1] * squares[2] + squares[2] * squares[0], J**2
    modulus = 4 * (C1 + C2 * I2) / J + 8 * (2 * C3 / I3**3 + C4 * (2 * I3 - 1)) - np.diag(stress).min() / J
    assert driver.sound_speed == pytest.approx(np.sqrt(modulus * J / MATERIAL.density), rel=1e-12)


def test_objective():
    assert_blind_to_spin(RUBBER)


def test_kernel():
    assert_kernel_agrees(RUBBER, viscosity=True)


def test_bounds():
    poisson = next(f.parameter for f in fields(CompMooneyRivlin) if f.name == "he_PR")
    assert (poisson.gt, poisson.lt) == (-1.0, 0.5)
    assert RUBBER.faults() == []
    assert RUBBER._replace(he_constant_1=-1.0e6).faults()[0][0] == "he_constant_1"
