"""Matrix with fibres against its energy, its closed forms and its relaxation function."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import (
    MATERIAL,
    SAMPLE,
    Driver,
    assert_blind_to_spin,
    assert_kernel_agrees,
    sample_path,
    stress_from_energy,
)
from scipy.integrate import quad

from solver.declare import fields
from solver.materials.constitutive import initial_sound_speed, state_record
from solver.materials.trans_iso_hyper import TransIsoHyper, ViscoTransIsoHyper
from solver.particles import state_variables

K, C1, C2, C3, C4, C5, STRAIGHT = 7.0e7, 1.4e6, 2.0e5, 1.4e5, 22.0, 1.5e8, 1.055
A0 = np.array([0.6, 0.0, 0.8])
LIGAMENT = TransIsoHyper(K, C1, C2, C3, C4, C5, STRAIGHT, tuple(A0), 0.0, 1.2, 0.5)
WEIGHTS, TIMES = (0.5, 0.3, 0.0, 0.0, 0.0, 0.2), (1e-5, 1e-4, 0.0, 0.0, 0.0, 1e-3)
VISCOUS = ViscoTransIsoHyper(*LIGAMENT[:11], *WEIGHTS, *TIMES)
C6 = C3 * (np.exp(C4 * (STRAIGHT - 1)) - 1) - C5 * STRAIGHT


def fiber_energy(stretch):
    if stretch < 1:
        return 0.0
    crimped = quad(lambda x: C3 * (np.exp(C4 * (x - 1)) - 1) / x, 1, min(stretch, STRAIGHT))[0]
    if stretch < STRAIGHT:
        return crimped
    return crimped + quad(lambda x: C5 + C6 / x, STRAIGHT, stretch)[0]


def energy(F):
    J = np.linalg.det(F)
    C = F.T @ F / J ** (2 / 3)
    I1 = np.trace(C)
    I2 = (I1**2 - np.trace(C @ C)) / 2
    return K / 2 * np.log(J) ** 2 + C1 * (I1 - 3) + C2 * (I2 - 3) + fiber_energy(np.sqrt(A0 @ C @ A0))


@pytest.mark.parametrize("stretch", [0.95, 1.03, 1.1])
def test_stress_is_the_derivative_of_the_energy(stretch):
    F = (np.eye(3) + 0.2 * SAMPLE) @ (np.eye(3) + (stretch - 1) * np.outer(A0, A0))
    driver = Driver(LIGAMENT)
    np.testing.assert_allclose(driver.advance(F), stress_from_energy(energy, F), atol=2e-7 * K)
    assert driver.strain_energy == pytest.approx(2.0 * energy(F), rel=1e-8)
    assert driver.state.stretch[0] == pytest.approx(np.linalg.norm(F @ A0), rel=1e-12)


def test_undeformed_is_without_stress_and_energy():
    driver = Driver(LIGAMENT)
    np.testing.assert_allclose(driver.advance(np.eye(3)), 0.0, atol=1e-7)
    assert driver.strain_energy == pytest.approx(0.0, abs=1e-6)


def test_fibers_and_matrix_fail_for_good():
    model = LIGAMENT._replace(failure_option=1.0, max_fiber_strain=1.1, max_matrix_strain=0.2)
    pulled = np.eye(3) + 0.15 * np.outer(A0, A0)
    driver = Driver(model._replace(max_matrix_strain=9.0))
    driver.advance(pulled)
    assert driver.state.failure[0] == 2.0
    back = np.eye(3) + 0.05 * np.outer(A0, A0)
    without_fibers = Driver(LIGAMENT._replace(c3=0.0, c5=0.0)).advance(back)
    np.testing.assert_allclose(driver.advance(back), without_fibers, rtol=1e-10, atol=1e-6)

    driver = Driver(model)
    driver.advance([[1, 0.3, 0], [0, 1, 0], [0, 0, 1]])
    assert driver.state.failure[0] == 1.0
    stress = driver.advance(back)
    assert np.trace(stress) == pytest.approx(0.0, abs=1e-6 * np.abs(stress).max())
    np.testing.assert_array_equal(driver.advance(pulled), 0.0)
    assert driver.state.failure[0] == 3.0


def test_without_the_option_nothing_fails():
    driver = Driver(LIGAMENT)
    driver.advance(np.eye(3) * 1.5)
    assert driver.state.failure[0] == 0.0


def test_memory_of_a_sudden_strain():
    """After a jump the stress relaxes by sigma_e (1 + sum y_k (t_k/dt) (1 - e^(-dt/t_k)) e^(-t/t_k))."""
    dt, held, F = 1e-6, 30, np.eye(3) + 0.05 * SAMPLE
    elastic = Driver(LIGAMENT).advance(F)
    stress = Driver(VISCOUS).follow([F] * (held + 1), dt)[-1]
    factor = 1.0
    for y, t in zip(WEIGHTS, TIMES, strict=True):
        if t > 0:
            factor += y * (1 - np.exp(-dt / t)) * t / dt * np.exp(-held * dt / t)
    np.testing.assert_allclose(stress, factor * elastic, rtol=1e-9)


def test_first_time_switches_the_memory():
    path = sample_path(4, 0.3)
    np.testing.assert_allclose(
        Driver(VISCOUS._replace(t1=0.0)).follow(path), Driver(LIGAMENT).follow(path), rtol=1e-12
    )


def test_sound_speeds():
    expected = np.sqrt((K + 2 / 3 * C1) / MATERIAL.density)
    for model in (LIGAMENT, VISCOUS):
        np.testing.assert_allclose(initial_sound_speed(model, np.array([MATERIAL.density]), 300.0), expected)
    driver = Driver(LIGAMENT)
    driver.advance(np.eye(3) - 0.05 * np.outer(A0, A0))
    expected = np.sqrt((K + (2 * C1 + C2) / 3) * 0.95 / MATERIAL.density)
    assert driver.sound_speed == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("model", [LIGAMENT, LIGAMENT._replace(failure_option=1.0)])
def test_objective(model):
    assert_blind_to_spin(model, rtol=1e-9)


@pytest.mark.parametrize("model", [LIGAMENT._replace(failure_option=1.0), VISCOUS])
def test_kernel(model):
    assert_kernel_agrees(model, viscosity=True, rtol=1e-10)


def test_state_is_named_as_in_archives():
    labels = {v.label for v in state_variables(state_record(LIGAMENT)).values()}
    assert labels == {"p.fiberDir", "p.stretch", "p.fail"}
    more = {v.label for v in state_variables(state_record(VISCOUS)).values()} - labels
    assert more == {"p.ElasticStress", *(f"p.history{k}" for k in range(1, 7))}


def test_bounds():
    bounds = {f.name: f.parameter for f in fields(ViscoTransIsoHyper)}
    assert bounds["bulk_modulus"].gt == 0.0
    assert bounds["fiber_stretch"].ge == 1.0
