"""Modified Cam clay against the closed forms of consolidation, its energy and the critical state."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import (
    MATERIAL,
    SAMPLE,
    Driver,
    assert_blind_to_spin,
    assert_kernel_agrees,
    rotation_matrix,
    stress_from_energy,
)

from solver.materials.cam_clay import BorjaPressure, BorjaShear, CamClay, CamClayYield, Consolidation
from solver.materials.constitutive import initial_sound_speed

P0, ALPHA, KAPPA, EV0, MU0, M, PC0, LAMBDA = -9.0e4, 60.0, 0.018, 0.0, 5.4e6, 1.05, -1.2e5, 0.13


def clay(pc0=PC0, mu0=MU0, alpha=ALPHA, **changes):
    parts = {
        "pressure_model": BorjaPressure("borja_pressure", P0, alpha, KAPPA, EV0),
        "elastic_shear_modulus_model": BorjaShear("borja_shear_modulus", mu0, P0, alpha, KAPPA, EV0),
        "plastic_yield_condition": CamClayYield("camclay_yield_function", M),
        "internal_variable_model": Consolidation("borja_consolidation_pressure", pc0, LAMBDA, KAPPA),
    }
    return CamClay(**(parts | changes))


def cube(strain):
    return np.eye(3) * np.exp(strain / 3)


def invariants(stress, F):
    tau = np.linalg.det(F) * stress
    p = np.trace(tau) / 3
    s = tau - p * np.eye(3)
    return p, np.sqrt(1.5 * np.sum(s * s))


def test_swelling_and_consolidation_lines():
    # elastic: p = p0 exp(-e_v / kappa); from pc0 on: p = pc0 exp(-(e_v - e_y) / lambda)
    driver = Driver(clay())
    yields = -KAPPA * np.log(PC0 / P0)
    for strain in [0.5 * yields, 0.99 * yields]:
        F = cube(strain)
        assert invariants(driver.advance(F), F)[0] == pytest.approx(P0 * np.exp(-strain / KAPPA), rel=1e-10)
    assert driver.state.preconsolidation[0] == PC0
    for strain in [-0.02, -0.05, -0.15]:
        F, expected = cube(strain), PC0 * np.exp(-(strain - yields) / LAMBDA)
        assert invariants(driver.advance(F), F)[0] == pytest.approx(expected, rel=1e-9)
        assert driver.state.preconsolidation[0] == pytest.approx(expected, rel=1e-9)
    F = cube(-0.145)
    p = invariants(driver.advance(F), F)[0]
    assert p == pytest.approx(expected * np.exp(-0.005 / KAPPA), rel=1e-9)


def test_elastic_stress_comes_from_the_energy():
    F = np.eye(3) + 0.03 * SAMPLE

    def energy(F):
        values, _ = np.linalg.eigh(F @ F.T)
        strain = 0.5 * np.log(values)
        volume = strain.sum()
        shear2 = 2 / 3 * np.sum((strain - volume / 3) ** 2)
        e = P0 * np.exp(-(volume - EV0) / KAPPA)
        return -KAPPA * e + 1.5 * (MU0 - ALPHA * e) * shear2

    driver = Driver(clay(pc0=-1.0e7))
    np.testing.assert_allclose(driver.advance(F), stress_from_energy(energy, F, 1e-6), rtol=1e-6, atol=1.0)
    assert driver.strain_energy == pytest.approx(2.0 * energy(F), rel=1e-10)


def test_shear_at_constant_volume_ends_in_the_critical_state():
    driver = Driver(clay(alpha=0.0))
    for gamma in np.linspace(0.0, 0.6, 200)[1:]:
        F = np.array([[1, gamma, 0], [0, 1, 0], [0, 0, 1.0]])
        p, q = invariants(driver.advance(F), F)
        pc = driver.state.preconsolidation[0]
        assert q**2 / M**2 + p * (p - pc) <= 1e-9 * pc**2
    assert q == pytest.approx(-M * p, rel=1e-4)
    assert p == pytest.approx(pc / 2, rel=1e-4)
    assert driver.state.multiplier[0] > 0.0


def test_plastic_dissipation_is_never_negative():
    driver = Driver(clay())
    stored, previous = None, np.eye(3)
    for F in [np.eye(3) + t * (SAMPLE - 0.1 * np.eye(3)) for t in np.linspace(0, 1, 80)[1:]]:
        before = driver.particles.stress[0].copy()
        volume = driver.particles.volume[0]
        driver.advance(F)
        L = (F - previous) @ np.linalg.inv(0.5 * (F + previous))
        work = (
            np.sum(0.5 * (before + driver.particles.stress[0]) * L)
            * 0.5
            * (volume + driver.particles.volume[0])
        )
        if stored is not None:
            assert work - (driver.strain_energy - stored) >= -1e-4 * abs(work)
        stored, previous = driver.strain_energy, F


def test_starts_in_its_own_pressure():
    driver = Driver(clay(), start=rotation_matrix([1, 2, 3], 0.5))
    np.testing.assert_allclose(driver.particles.stress[0], P0 * np.eye(3), rtol=1e-14)
    stiffness = -P0 / KAPPA + 4 / 3 * (MU0 - ALPHA * P0)
    assert initial_sound_speed(clay(), MATERIAL.density, 300.0) == pytest.approx(
        np.sqrt(stiffness / MATERIAL.density)
    )


def test_objective_and_compiled():
    assert_blind_to_spin(clay(), rtol=1e-9)
    assert_kernel_agrees(clay(), rtol=1e-9)


@pytest.mark.parametrize(
    ("parts", "field"),
    [
        ({"pc0": -1.0e4}, "internal_variable_model"),
        ({"internal_variable_model": Consolidation("", PC0, 0.01, KAPPA)}, "internal_variable_model"),
        ({"internal_variable_model": Consolidation("", PC0, LAMBDA, 0.02)}, "internal_variable_model"),
        (
            {"elastic_shear_modulus_model": BorjaShear("", MU0, -1e5, ALPHA, KAPPA, EV0)},
            "elastic_shear_modulus_model",
        ),
    ],
)
def test_parts_that_do_not_fit(parts, field):
    assert [name for name, _ in clay(**parts).faults()] == [field]
    assert clay().faults() == []
