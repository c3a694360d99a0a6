"""rf_elastic_plastic and gao_elastic: what swells freely has no stress, what cannot swell is pressed."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import MATERIAL, Driver, assert_kernel_agrees, assert_turns_with_the_path, sample_path

from solver.materials.elastic_plastic import ElasticPlastic
from solver.materials.equation_of_state.default_hypo import DefaultHypo
from solver.materials.equation_of_state.mie_gruneisen import MieGruneisen
from solver.materials.flow_stress.isotropic_hardening import IsotropicHardening
from solver.materials.gao_elastic import GaoElastic
from solver.materials.rf_elastic_plastic import SwellingElasticPlastic

K, G, BETA, YIELD = 48.0e9, 33.0e9, 0.56, 2.0e9
ELASTIC = IsotropicHardening(sigma_Y=1e15, K=0.0)
PLASTIC = IsotropicHardening(sigma_Y=YIELD, K=0.0)


def silicon(flow=ELASTIC, **changes):
    return SwellingElasticPlastic(K, G, BETA, flow, **changes)


def swell(driver, concentration, gradient_of, steps=50, dt=1.0e-6):
    """The stress after the concentration has risen, with the deformation gradient that goes with it."""
    driver.state.concentration_rate[:] = concentration / (steps * dt)
    for t in np.linspace(0.0, 1.0, steps + 1)[1:]:
        stress = driver.advance(gradient_of(t * concentration), dt)
    return stress


EQUATIONS = [{}, {"equation_of_state": DefaultHypo()}, {"equation_of_state": MieGruneisen(4000.0, 1.5, 1.3)}]


@pytest.mark.parametrize("changes", EQUATIONS)
@pytest.mark.parametrize("c", [0.3, -0.2, 1.0])
def test_free_swelling_makes_no_stress(changes, c):
    driver = Driver(silicon(**changes), exact_rates=True)
    stress = swell(driver, c, lambda c: np.exp(BETA * c) * np.eye(3))
    assert np.abs(stress).max() < 1e-9 * K
    assert driver.state.swelling[0] == pytest.approx(BETA * c)
    assert driver.sound_speed == pytest.approx(
        np.sqrt((K + 4 * G / 3) * np.exp(3 * BETA * c) / MATERIAL.density), rel=1e-9
    )


def test_held_material_is_pressed_by_what_it_would_swell():
    # default_hyper: p = K/2 (J - 1/J) at J = exp(-3 beta c)
    c = 0.02
    stress = swell(Driver(silicon(), exact_rates=True), c, lambda c: np.eye(3))
    J = np.exp(-3 * BETA * c)
    np.testing.assert_allclose(stress, K / 2 * (J - 1 / J) * np.eye(3), rtol=1e-9, atol=1e-6 * K)


def test_a_film_held_in_its_plane():
    # x and y held, z free of stress: s_xx = -2 G (3 K / (K + 4 G / 3)) beta c to first order
    c = 1.0e-4
    expand = BETA * c
    thickness = 3 * K * expand / (K + 4 * G / 3)
    stress = swell(
        Driver(silicon(equation_of_state=DefaultHypo()), exact_rates=True),
        c,
        lambda now: np.diag([1.0, 1.0, np.exp(thickness * now / c)]),
    )
    assert stress[0, 0] == pytest.approx(-2 * G * thickness, rel=1e-3)
    assert abs(stress[2, 2]) < 1e-3 * abs(stress[0, 0])


def test_a_film_yields():
    stress = swell(
        Driver(silicon(PLASTIC), exact_rates=True),
        0.5,
        lambda c: np.diag([1.0, 1.0, np.exp(3 * BETA * c)]),
        steps=400,
    )
    assert stress[2, 2] - stress[0, 0] == pytest.approx(YIELD, rel=1e-3)


def test_without_a_substance_it_is_the_metal():
    metal = Driver(ElasticPlastic(K, G, PLASTIC, evolve_porosity=False, isothermal=True), temperature=298.0)
    other = Driver(silicon(PLASTIC), temperature=298.0)
    np.testing.assert_array_equal(metal.follow(sample_path(10)), other.follow(sample_path(10)))
    assert other.state.plastic_strain[0] > 0.01


def test_temperature_plays_no_part():
    path = sample_path(5)
    cold, hot = Driver(silicon(PLASTIC), temperature=10.0), Driver(silicon(PLASTIC), temperature=1200.0)
    np.testing.assert_array_equal(cold.follow(path), hot.follow(path))
    assert hot.heating_rate == 0.0


def test_gao_elastic():
    free = Driver(GaoElastic(K, G, BETA), exact_rates=True)
    stress = swell(free, 0.4, lambda c: np.exp(BETA * c) * np.eye(3))
    assert np.abs(stress).max() < 1e-9 * K
    held = swell(Driver(GaoElastic(K, G, BETA)), 0.4, lambda c: np.eye(3))
    np.testing.assert_allclose(held, -3 * K * BETA * 0.4 * np.eye(3), rtol=1e-12, atol=1e-6)


@pytest.mark.parametrize("model", [silicon(PLASTIC), GaoElastic(K, G, BETA)])
def test_compiled(model):
    assert_kernel_agrees(model, rtol=1e-10)


def test_objective():
    assert_turns_with_the_path(silicon(PLASTIC), rtol=1e-7)
