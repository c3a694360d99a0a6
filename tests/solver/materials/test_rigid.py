"""Rigid material: no stress and no limit of the time step."""

from __future__ import annotations

import numpy as np
from point_driver import Driver, assert_kernel_agrees, sample_path

from solver.materials.constitutive import initial_sound_speed, time_step_limit
from solver.materials.rigid import Rigid


def test_bears_nothing():
    driver = Driver(Rigid(), viscosity=True)
    driver.particles.stress[0] = 5.0
    np.testing.assert_array_equal(driver.advance(0.7 * sample_path(1)[0]), 0.0)
    assert (driver.strain_energy, driver.heating_rate, driver.artificial_pressure) == (0.0, 0.0, 0.0)


def test_time_step_is_not_limited_by_speed():
    driver = Driver(Rigid())
    driver.advance(np.eye(3))
    fast = 1.0e9
    assert driver.sound_speed + fast < 0.0
    assert (initial_sound_speed(Rigid(), np.ones(3), np.ones(3)) + fast < 0.0).all()
    assert time_step_limit(Rigid()) == 1.0


def test_kernel():
    assert_kernel_agrees(Rigid())
