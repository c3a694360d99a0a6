"""Programmed burn against its lighting times and equations of state."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, Driver, assert_kernel_agrees

from solver.declare import fields
from solver.materials.constitutive import DELETE, initial_sound_speed, initialize, state_record
from solver.materials.program_burn import ProgramBurn
from solver.particles import Particles, new_arrays, state_variables

KAPPA, N, D, RHO = 6.9e-11, 7.4, 7000.0, 1600.0
A, B, C, R1, R2, OM = 4.0e11, 5.0e9, 1.2e9, 4.4, 1.3, 0.35
MODEL = ProgramBurn(KAPPA, N, A, B, C, R1, R2, OM, RHO, (0.0, 0.0, 0.0), D)
HE = MATERIAL._replace(density=RHO)


def unburned(J):
    return (J**-N - 1) / (N * KAPPA)


def burned(J):
    return A * np.exp(-R1 * J) + B * np.exp(-R2 * J) + C * J ** -(1 + OM)


@pytest.mark.parametrize(
    ("direction", "distance"), [((0.0, 0.0, 0.0), 5.0), ((0.0, 2.0, 0.0), 4.0), ((3.0, 0.0, 4.0), 1.8)]
)
def test_time_of_arrival(direction, distance):
    particles = new_arrays(Particles, 1)
    particles.position[0] = [3.0, 4.0, 0.0]
    model = MODEL._replace(direction_if_plane=direction, T0=1e-3)
    state = new_arrays(state_record(model), 1)
    initialize(model, state, particles, HE, np.zeros(1, int))
    assert state.arrival[0] == pytest.approx(1e-3 + distance / D)


def lit(age, J):
    driver = Driver(MODEL, HE)
    driver.state.arrival[0] = 1e-3
    driver.time = 1e-3 + age
    return driver, driver.advance(np.eye(3) * J ** (1 / 3))


def test_before_and_during_and_after():
    J = 0.9
    duration = 1.5 * (2.0 * RHO / RHO) ** (1 / 3) / D
    for age, f in ((-1e-6, 0.0), (0.4 * duration, 0.4), (0.97 * duration, 1.0), (9 * duration, 1.0)):
        driver, stress = lit(age, J)
        assert driver.state.burned[0] == pytest.approx(f, rel=1e-9)
        np.testing.assert_allclose(stress, -((1 - f) * unburned(J) + f * burned(J)) * np.eye(3), rtol=1e-9)


def test_sound_speeds_are_slopes_of_pressure():
    J, h = 0.9, 1e-6
    for age, law in ((-1.0, unburned), (1.0, burned)):
        driver, _ = lit(age, J)
        slope = -(law(J + h) - law(J - h)) / (2 * h) * J**2 / RHO
        assert driver.sound_speed == pytest.approx(np.sqrt(slope), rel=1e-6)
    np.testing.assert_allclose(initial_sound_speed(MODEL, np.array([RHO]), 300.0), 1 / np.sqrt(KAPPA * RHO))


def test_inverted_particles_go():
    driver = Driver(MODEL, HE)
    driver.advance(np.diag([-1.0, 1, 1]))
    assert driver.localized == DELETE


def test_kernel():
    assert_kernel_agrees(MODEL, [np.eye(3) * s for s in (0.99, 0.97, 1.1)], 1e-4, material=HE, viscosity=True)


def test_names_and_bounds():
    labels = {v.label for v in state_variables(state_record(MODEL)).values()}
    assert "p.progressF" in labels
    assert next(f.parameter for f in fields(ProgramBurn) if f.name == "D").gt == 0.0
