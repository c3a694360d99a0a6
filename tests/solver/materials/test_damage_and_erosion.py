from __future__ import annotations

from collections import namedtuple

import numpy as np
import pytest

from solver.declare import FAMILIES, fields
from solver.materials.constitutive import Material, Step
from solver.materials.damage import (
    DAMAGE,
    DamagePoint,
    ScalarDamage,
    damage_state,
    for_constitutive_model,
    initialize_damage,
    update_damage,
)
from solver.materials.damage.brittle import BrittleDamage
from solver.materials.damage.hancock_mackenzie import HancockMacKenzieDamage
from solver.materials.damage.johnson_cook import JohnsonCookDamage
from solver.materials.damage.no_damage import NoDamage
from solver.materials.damage.threshold import Entry, Threshold, ThresholdVar, VariableProperties
from solver.materials.distribution import draw
from solver.materials.distribution.constant import Constant
from solver.materials.distribution.gauss import Gauss
from solver.materials.erosion import EROSION, ErosionState, erode, lets_fail, restrain
from solver.materials.erosion.allow_no_shear import AllowNoShear
from solver.materials.erosion.allow_no_tension import AllowNoTension
from solver.materials.erosion.no_erosion import NoErosion, PreserveStress
from solver.materials.erosion.zero_stress import ZeroStress
from solver.materials.failure_criterion import FAILURE_CRITERION
from solver.materials.failure_criterion.mohr_coulomb import MohrCoulombFailure
from solver.materials.failure_criterion.principal_strain import MaximumPrincipalStrain
from solver.materials.failure_criterion.principal_stress import MaximumPrincipalStress
from solver.particles import Particles, new_arrays, state_variables
from solver.tensor import Tensor, isotropic

HypoModuli = namedtuple("HypoModuli", "bulk_modulus shear_modulus")
STEEL = Material(7830.0, 477.0, 477.0, 38.0, 294.0, 1793.0, 0.0)
STEP = Step(1.0e-6, 0.0, 1.0e-3, False, 0.2, 2.0, False)
# 4340 steel, Johnson and Cook 1985
JC = JohnsonCookDamage(D1=0.05, D2=3.44, D3=-2.12, D4=0.002, D5=0.61)
STRESS_LIMIT = Threshold(MaximumPrincipalStress(), failure_mean=250.0e6)
STRAIN_LIMIT = Threshold(MaximumPrincipalStrain(), failure_mean=0.05)
COULOMB = Threshold(MohrCoulombFailure(), failure_mean=100.0e6, friction_angle=30.0, tensile_cutoff=0.5)
VARIABLE = ThresholdVar(
    MaximumPrincipalStress(), VariableProperties((Entry(0.0, 1.0e8, 0.0), Entry(2.0, 3.0e8, 2.0e7)))
)
THRESHOLDS = [STRESS_LIMIT, STRAIN_LIMIT, COULOMB, VARIABLE]
BRITTLE = for_constitutive_model(BrittleDamage(), HypoModuli(bulk_modulus=20.0e9, shear_modulus=10.0e9))
STRESSES = [np.diag(d) * 1e6 for d in ([600, 0, 0], [-600, 0, 0], [900, 800, 850], [300, -300, 0])]
STRESS = np.array([[300.0, 120.0, 0.0], [120.0, 200.0, 40.0], [0.0, 40.0, 100.0]]) * 1e6
F_OLD = np.diag([1.1, 1.0, 0.9])
F = np.array([[1.2, 0.3, 0.0], [0.0, 1.0, 0.1], [0.0, 0.0, 0.9]])
L = np.array([[100.0, 20.0, 0.0], [-20.0, 50.0, 0.0], [0.0, 0.0, 30.0]])


def tensor(a):
    return Tensor(*np.ravel(a))


def matrix(t):
    return np.array([[t.xx, t.xy, t.xz], [t.yx, t.yy, t.yz], [t.zx, t.zy, t.zz]])


def point(stress, rate, temperature=500.0, localized=0):
    return DamagePoint(tensor(stress), isotropic(1.0), rate, temperature, 1.0, localized)


def ratio(stress):
    s = stress - np.trace(stress) / 3 * np.eye(3)
    return np.trace(stress) / 3 / np.sqrt(1.5 * (s * s).sum())


def test_every_model_is_tested():
    models = {"none", "johnson_cook", "hancock_mackenzie", "Threshold", "ThresholdVar", "Brittle"}
    assert set(DAMAGE.models) == models
    assert {type(t.failure_criteria) for t in THRESHOLDS} == set(FAILURE_CRITERION.models.values())
    assert set(EROSION.models) == {"none", "PreserveStress", "ZeroStress", "AllowNoTension", "AllowNoShear"}


@pytest.mark.parametrize("rate", [0.0, 0.3, 2.0e3])
@pytest.mark.parametrize("stress", STRESSES)
def test_johnson_cook_damage(rate, stress):
    state = ScalarDamage(np.array([0.1]))
    triaxiality = np.clip(ratio(stress), -1.5, 1.5)
    by_rate = (1 + rate) ** 0.002 if rate < 1 else 1 + 0.002 * np.log(rate)
    fracture = (0.05 + 3.44 * np.exp(-2.12 * triaxiality)) * by_rate * (1 + 0.61 * 206.0 / 1499.0)
    assert update_damage(JC, state, 0, point(stress, rate, localized=2), STEEL, STEP).localized == 2
    assert state.damage[0] == pytest.approx(0.1 + rate * 1e-6 / fracture, rel=1e-12)


def test_johnson_cook_damage_of_no_stress_and_below_its_threshold():
    state = ScalarDamage(np.array([0.0]))
    update_damage(JC, state, 0, point(np.zeros((3, 3)), 1.0e3), STEEL, STEP)
    assert state.damage[0] > 0.0
    update_damage(JC._replace(critical_scalar_damage=0.01), state, 0, point(STRESS, 1.0), STEEL, STEP)
    assert state.damage[0] == 0.0


@pytest.mark.parametrize("stress", STRESSES)
def test_hancock_mackenzie_damage_grows_in_tension(stress):
    state = ScalarDamage(np.array([0.2]))
    update_damage(HancockMacKenzieDamage(), state, 0, point(stress, 2.0e3), STEEL, STEP)
    growth = 2.0e-3 * np.exp(1.5 * ratio(stress)) / 1.65 if np.trace(stress) > 0 else 0.0
    assert state.damage[0] == pytest.approx(0.2 + growth, rel=1e-12)


def test_damage_at_the_start():
    patch = np.zeros(500, int)
    for model in (JC, HancockMacKenzieDamage()):
        model = model._replace(initial_mean_scalar_damage=0.3, initial_std_scalar_damage=0.05)
        state = new_arrays(damage_state(model), 500)
        initialize_damage(model, state, None, patch)
        assert (state.damage == 0.3).all()
        initialize_damage(model._replace(initial_scalar_damage_distrib=Gauss()), state, None, patch)
        assert state.damage.mean() == pytest.approx(0.3, abs=0.01)
        assert state.damage.std() == pytest.approx(0.05, abs=0.01)


def test_without_damage_nothing_is_kept():
    initialize_damage(NoDamage(), None, None, np.zeros(3, int))
    assert damage_state(NoDamage())._fields == ()
    update = update_damage(NoDamage(), None, 0, point(STRESS, 1.0, localized=1), STEEL, STEP)
    assert update.localized == 1
    np.testing.assert_array_equal(matrix(update.stress), STRESS)


def failed(model, stress, gradient, strength):
    state = new_arrays(damage_state(model), 1)
    state.strength[0] = strength
    at = point(stress, 0.0)._replace(deformation_gradient=tensor(gradient))
    update = update_damage(model, state, 0, at, STEEL, STEP)
    np.testing.assert_array_equal(matrix(update.stress), stress)
    return update.localized


def test_failure_by_stress_and_strain():
    largest = np.linalg.eigvalsh(STRESS)[-1]
    assert failed(STRESS_LIMIT, STRESS, F, 1.001 * largest) == 0
    assert failed(STRESS_LIMIT, STRESS, F, 0.999 * largest) == 1
    assert failed(STRESS_LIMIT._replace(LocalizeParticles=False), STRESS, F, 0.999 * largest) == 0
    largest = np.linalg.eigvalsh((np.eye(3) - np.linalg.inv(F @ F.T)) / 2)[-1]
    assert failed(STRAIN_LIMIT, STRESS, F, 1.001 * largest) == 0
    assert failed(STRAIN_LIMIT, STRESS, F, 0.999 * largest) == 1


def test_failure_by_cohesion_and_friction():
    uniaxial_strength = 2 * 100e6 * np.cos(np.pi / 6) / (1 - np.sin(np.pi / 6))
    for factor, answer in ((0.99, 0), (1.01, 2)):
        assert failed(COULOMB, np.diag([0.0, 0.0, -factor * uniaxial_strength]), F, 100e6) == answer
    for tension, answer in ((49e6, 0), (51e6, 1)):
        assert failed(COULOMB, tension * np.eye(3), F, 100e6) == answer


@pytest.mark.parametrize(
    ("name", "std", "deviation"),
    [("gauss", 2e7, 2e7), ("uniform", 5e7, 5e7 / 3**0.5), ("weibull", 8.0, 3.7e7)],
)
def test_strengths_have_their_distribution(name, std, deviation):
    particles = new_arrays(Particles, 4000)
    particles.volume[:] = 8.0e-9
    patch = np.repeat([0, 1], 2000)
    state = new_arrays(damage_state(STRESS_LIMIT), 4000)
    model = STRESS_LIMIT._replace(failure_distrib=name, failure_std=std)
    initialize_damage(model, state, particles, patch)
    assert state.strength.mean() == pytest.approx(250e6, rel=0.01)
    assert state.strength.std() == pytest.approx(deviation, rel=0.06)
    assert len(np.unique(state.strength)) > 3900
    alike = state.strength.copy()
    scaled = model._replace(scaling="kayenta", reference_volume=1.0e-9, exponent=3.0)
    initialize_damage(scaled, state, particles, patch)
    np.testing.assert_allclose(state.strength, 0.5 * alike)


def test_weibull_strength_scales_with_its_modulus():
    particles = new_arrays(Particles, 1)
    particles.volume[:] = 2.0
    model = STRESS_LIMIT._replace(failure_distrib="weibull", failure_std=4.0)
    states = [new_arrays(damage_state(model), 1) for _ in range(2)]
    initialize_damage(model, states[0], particles, np.zeros(1, int))
    initialize_damage(model._replace(scaling="kayenta"), states[1], particles, np.zeros(1, int))
    assert states[1].strength / states[0].strength == pytest.approx(0.5**0.25)


def test_strengths_follow_the_colour():
    particles = new_arrays(Particles, 3)
    particles.color[:] = [-1.0, 0.5, 5.0]
    state = new_arrays(damage_state(VARIABLE), 3)
    initialize_damage(VARIABLE, state, particles, np.zeros(3, int))
    np.testing.assert_allclose(state.strength, [1.0e8, 1.5e8, 3.0e8])


def test_what_does_not_go_together_is_a_fault():
    assert STRESS_LIMIT._replace(failure_distrib="weibull").faults()
    assert VARIABLE._replace(variable_properties=VariableProperties((Entry(0.0, 1e8, 0.0),))).faults()
    assert not STRESS_LIMIT.faults() + VARIABLE.faults()


def test_brittle_damage_softens_and_does_not_heal():
    state = new_arrays(damage_state(BRITTLE), 1)
    initialize_damage(BRITTLE, state, new_arrays(Particles, 1), np.zeros(1, int))
    young = 9 * 20e9 * 10e9 / (60e9 + 10e9)
    stress, size, D, energy = np.diag([1e6, 0, 0]), 1e-3, 0.1, 11.2
    for strain, grows in ((3e-4, False), (3.6e-4, True), (3e-4, False), (4.2e-4, True)):
        gradient = np.diag([1 / np.sqrt(1 - 2 * strain), 1.0, 1.0])
        before = state.damage[0]
        at = point(stress, 0.0)._replace(deformation_gradient=tensor(gradient), volume=size**3)
        update = update_damage(BRITTLE, state, 0, at, STEEL, STEP)
        if grows:
            C = 57.0 * size * (1 + D) * np.log(1 + D) / (energy * D)
            tau = np.sqrt(young) * strain
            expected = 0.999 / D * ((1 + D) / (1 + D * np.exp(-C * (tau - 57.0))) - 1)
            assert state.damage[0] == pytest.approx(min(expected, before + 0.1), rel=1e-6)
        assert (state.damage[0] > before) == grows
        np.testing.assert_allclose(matrix(update.stress), (1 - state.damage[0]) * stress)


def test_recovered_brittle_material_is_flagged():
    model = BRITTLE._replace(brittle_damage_allowRecovery=True, brittle_damage_recoveryCoeff=0.8)
    state = new_arrays(damage_state(model), 1)
    state.damage[0], state.threshold[0] = 0.3, 100.0
    update = update_damage(model, state, 0, point(-STRESS, 0.0), STEEL, STEP)
    np.testing.assert_allclose(matrix(update.stress), -0.8 * STRESS)
    assert state.damage[0] == -0.3


def test_the_distributions_of_patches_start_anew():
    patch = np.array([0, 1, 0, 1, 1])
    drawn = draw(Gauss(), 0.01, 0.01, patch)
    np.testing.assert_array_equal(drawn[patch == 0], drawn[patch == 1][:2])
    assert (drawn >= 0.0).all()
    assert (draw(Constant(), 0.01, 0.01, patch) == 0.01).all()


def test_algorithms_that_keep_the_particle_as_it_is():
    for algorithm in (NoErosion(), PreserveStress()):
        motion = restrain(algorithm, tensor(F_OLD), tensor(F), tensor(L))
        np.testing.assert_array_equal(matrix(motion.deformation_gradient), F)
        np.testing.assert_array_equal(matrix(motion.velocity_gradient), L)
        np.testing.assert_array_equal(matrix(erode(algorithm, tensor(STRESS), 1.0)), STRESS)
    assert [lets_fail(a) for a in (NoErosion(), PreserveStress(), ZeroStress())] == [False, True, True]


def test_zero_stress_stops_the_particle_and_its_stress_decays():
    motion = restrain(ZeroStress(), tensor(F_OLD), tensor(F), tensor(L))
    np.testing.assert_array_equal(matrix(motion.deformation_gradient), F_OLD)
    assert not matrix(motion.velocity_gradient).any()
    np.testing.assert_array_equal(matrix(erode(ZeroStress(), tensor(STRESS), 0.0)), STRESS)
    assert not matrix(erode(ZeroStress(), tensor(STRESS), 1e-9)).any()
    slow = matrix(erode(ZeroStress(char_time=2e-6), tensor(STRESS), 1e-6))
    np.testing.assert_allclose(slow, STRESS * np.exp(-0.5))


@pytest.mark.parametrize("algorithm", [AllowNoTension(), AllowNoShear()])
def test_fluid_like_algorithms_keep_the_volume(algorithm):
    motion = restrain(algorithm, tensor(F_OLD), tensor(F), tensor(L))
    gradient = matrix(motion.deformation_gradient)
    assert np.linalg.det(gradient) == pytest.approx(np.linalg.det(F))
    np.testing.assert_allclose(gradient, gradient[0, 0] * np.eye(3))
    np.testing.assert_allclose(matrix(motion.velocity_gradient), 60.0 * np.eye(3))
    assert lets_fail(algorithm)


def test_allow_no_shear_leaves_the_mean_stress():
    np.testing.assert_allclose(matrix(erode(AllowNoShear(), tensor(STRESS), 1e-6)), 2e8 * np.eye(3))


def test_allow_no_tension_leaves_compression():
    np.testing.assert_allclose(matrix(erode(AllowNoTension(), tensor(-STRESS), 1e-6)), -2e8 * np.eye(3))
    assert not matrix(erode(AllowNoTension(), tensor(STRESS), 1e-6)).any()
    slow = matrix(erode(AllowNoTension(char_time=2e-6), tensor(STRESS), 1e-6))
    np.testing.assert_allclose(slow, STRESS * np.exp(-0.5))


def test_particles_start_unfailed():
    assert (new_arrays(ErosionState, 3).failure_time == -1.0e99).all()
    assert state_variables(ErosionState)["failure_time"].label == "p.timeofloc"


def damaged(model, state, scale, material, step):
    stress = Tensor(3e8 * scale, 1e8, 0.0, 1e8, 1e8, 0.0, 0.0, 0.0, 2e8)
    gradient = Tensor(1.01, 0.002, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.99)
    point = DamagePoint(stress, gradient, 2.0e3, 500.0, 1e-9, 0)
    return update_damage(model, state, 0, point, material, step).stress.xx


def eroded(algorithm, scale):
    stress = Tensor(3e8 * scale, 1e8, 0.0, 1e8, 1e8, 0.0, 0.0, 0.0, 2e8)
    motion = restrain(algorithm, isotropic(1.0), isotropic(1.01), stress * 1e-6)
    measures = motion.deformation_gradient.xx, motion.velocity_gradient.xx, motion.velocity_gradient.xy
    return (*measures, erode(algorithm, stress, 1e-6).xx, erode(algorithm, stress, 1e-6).xy)


@pytest.mark.parametrize("model", [NoDamage(), JC, HancockMacKenzieDamage(), BRITTLE, *THRESHOLDS])
def test_compiled_damage_agrees(model):
    from solver.jit import kernel

    plain, fast = (new_arrays(damage_state(model), 1) for _ in range(2))
    for state in (plain, fast):
        initialize_damage(model, state, new_arrays(Particles, 1), np.zeros(1, int))
    expected = damaged(model, plain, 1.2, STEEL, STEP)
    assert kernel(damaged)(model, fast, 1.2, STEEL, STEP) == pytest.approx(expected, rel=1e-13)
    np.testing.assert_allclose(list(fast), list(plain), rtol=1e-13)


@pytest.mark.parametrize("algorithm", [NoErosion(), ZeroStress(2e-6), AllowNoTension(2e-6), AllowNoShear()])
def test_compiled_erosion_agrees(algorithm):
    from solver.jit import kernel

    for scale in (1.0, -3.0):
        assert kernel(eroded)(algorithm, scale) == pytest.approx(eroded(algorithm, scale), rel=1e-13)


def test_all_parameters_explain_themselves():
    for name in ("damage", "erosion", "distribution", "failure_criterion"):
        for record in FAMILIES[name].models.values():
            assert record.__doc__
            assert all(item.parameter.meaning for item in fields(record))
