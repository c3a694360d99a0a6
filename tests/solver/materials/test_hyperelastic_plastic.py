from __future__ import annotations

import numpy as np
import pytest
from point_driver import Driver, assert_blind_to_spin, assert_kernel_agrees, sample_path
from test_elastic_plastic import COPPER, COPPER_EOS, COPPER_JC, G, K
from test_flow_stress import COPPER_MTS
from test_yield_condition import GURSON

from solver.declare import FAMILIES
from solver.materials.comp_neo_hook import CompNeoHookPlastic
from solver.materials.constitutive import DELETE, initial_sound_speed
from solver.materials.elastic_plastic import ElasticPlastic
from solver.materials.equation_of_state.default_hyper import DefaultHyper
from solver.materials.flow_stress.isotropic_hardening import IsotropicHardening
from solver.materials.hyperelastic_plastic import HyperElasticPlastic
from solver.materials.return_algorithm.semi_implicit import SemiImplicit
from solver.materials.shear_modulus.mechanical_threshold_stress import MechanicalThresholdShear

SIGMA_Y, H = 90.0e6, 1.5e9
LINEAR = HyperElasticPlastic(K, G, IsotropicHardening(SIGMA_Y, H))
ELASTIC = HyperElasticPlastic(K, G, IsotropicHardening(1.0e12, 0.0))
JC = HyperElasticPlastic(K, G, COPPER_JC, equation_of_state=COPPER_EOS)
MTS = JC._replace(flow_model=COPPER_MTS, shear_modulus_model=MechanicalThresholdShear(47.7e9, 3.0e9, 180.0))
POROUS = JC._replace(yield_condition=GURSON, plastic_convergence_algo=SemiImplicit(), failure_is_checked=True)


def drive(model, **options):
    return Driver(model, **{"material": COPPER, **options})


def deviator(a):
    return a - np.trace(a) / 3 * np.eye(3)


def test_name():
    assert FAMILIES["constitutive_model"].models["hyperelastic_plastic"] is HyperElasticPlastic


@pytest.mark.parametrize("J", [0.8, 1.0, 1.1])
def test_elastic_stress_is_neo_hookean(J):
    F = (J / 1.05) ** (1 / 3) * np.array([[1.05, 0.2, 0.0], [0.0, 1.0, 0.1], [0.0, 0.0, 1.0]])
    b = np.linalg.det(F) ** (-2 / 3) * F @ F.T
    expected = K / 2 * (J - 1 / J) * np.eye(3) + G / J * deviator(b)
    np.testing.assert_allclose(drive(ELASTIC).advance(F), expected, atol=1e-9 * K)


def test_linear_hardening_without_change_of_volume_is_that_of_comp_neo_hook_plastic():
    # at J = 1 true stress and J times it are one; the return stops at a thousandth of the flow stress
    other = CompNeoHookPlastic(K, G, yield_stress=SIGMA_Y, hardening_modulus=H)
    path = [F / np.cbrt(np.linalg.det(F)) for F in sample_path(60, 0.8)]
    mine, theirs = drive(LINEAR), drive(other)
    for F in path:
        stress, expected = mine.advance(F), theirs.advance(F)
        np.testing.assert_allclose(deviator(stress), deviator(expected), atol=2e-3 * SIGMA_Y)
    assert mine.state.plastic_strain[0] == pytest.approx(theirs.state.plastic_strain[0], rel=2e-3)
    assert mine.state.plastic_strain[0] > 0.05


@pytest.mark.parametrize("model", [LINEAR, JC, MTS], ids=["linear", "jc", "mts"])
def test_small_steps_of_moderate_strain_agree_with_the_hypoelastic_material(model):
    fields = model._asdict()
    other = ElasticPlastic(**fields)
    mine, theirs = drive(model, exact_rates=True), drive(other, exact_rates=True)
    for F in sample_path(200, 0.1):
        stress, expected = mine.advance(F), theirs.advance(F)
    np.testing.assert_allclose(stress, expected, atol=0.01 * np.abs(deviator(expected)).max())
    assert mine.state.plastic_strain[0] == pytest.approx(theirs.state.plastic_strain[0], rel=0.01)
    assert mine.state.energy[0] == pytest.approx(theirs.state.energy[0], rel=0.01)


@pytest.mark.parametrize("compression", [1.0, 0.8])
def test_true_stress_lies_on_the_yield_surface(compression):
    driver = drive(LINEAR)
    for F in sample_path(20, 0.5):
        stress = driver.advance(compression ** (1 / 3) * F)
    flow = SIGMA_Y + H * driver.state.plastic_strain[0]
    assert np.sqrt(1.5) * np.linalg.norm(deviator(stress)) == pytest.approx(flow, rel=2e-3)


def test_spin_makes_no_stress():
    assert_blind_to_spin(ELASTIC, material=COPPER)
    # the strain rate of a finite step sees its rotation, and with it flow stress and pressure do
    assert_blind_to_spin(LINEAR._replace(equation_of_state=DefaultHyper()), material=COPPER, rtol=1e-3)


@pytest.mark.parametrize("model", [LINEAR, MTS, POROUS], ids=["linear", "mts", "porous"])
def test_the_kernel_does_what_python_does(model):
    assert_kernel_agrees(model, sample_path(12, 0.4), dt=1e-6, material=COPPER, temperature=350.0)


def test_a_melt_has_no_shear_stress_and_starts_anew():
    driver = drive(LINEAR, temperature=1400.0)
    assert np.abs(deviator(driver.advance(np.diag([1.1, 1.0, 0.9])))).max() < 1e-3
    driver.particles.temperature[0] = 300.0
    assert np.abs(deviator(driver.advance(np.diag([1.1, 1.0, 0.9])))).max() < 1e-3


@pytest.mark.parametrize("F", [np.diag([-1.0, 1.0, 1.0]), np.diag([50.0, 50.0, 50.0])])
def test_inverted_and_exploded_particles_are_removed(F):
    driver = drive(JC)
    driver.advance(F)
    assert driver.localized == DELETE
    assert not driver.particles.stress.any()


def test_failure_is_that_of_elastic_plastic():
    for checked in (False, True):
        driver = drive(LINEAR._replace(failure_is_checked=checked, critical_porosity=0.001))
        driver.advance(np.diag([1.002, 0.999, 0.999]))
        assert driver.localized == int(checked)


def test_faults_are_those_of_elastic_plastic():
    assert [field for field, _ in LINEAR._replace(yield_condition=GURSON).faults()] == [
        "plastic_convergence_algo"
    ]
    assert not POROUS.faults()


def test_sound_speed():
    assert initial_sound_speed(JC, 8930.0, 300.0) == pytest.approx(np.sqrt((K + 4 * G / 3) / 8930.0))
    driver = drive(JC)
    driver.advance(np.eye(3))
    assert driver.sound_speed == pytest.approx(np.sqrt((K + 4 * G / 3) / 8930.0))
