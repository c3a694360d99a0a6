from __future__ import annotations

import itertools

import numpy as np
import pytest
from plasticity import assert_compiled_agrees

from solver.materials.stability import elastic_stress, tangent_modulus
from solver.materials.yield_condition import YIELD_CONDITION, hardening_term, yield_normal, yield_value
from solver.materials.yield_condition.gurson import Gurson
from solver.materials.yield_condition.rousselier import Rousselier
from solver.materials.yield_condition.von_mises import VonMises
from solver.tensor import Tensor, isotropic

GURSON = Gurson(q1=1.5, q2=1.0, q3=2.25, k=4.0, f_c=0.05)
ROUSSELIER = Rousselier(D=2.0, sig_1=445.0e6)
CONDITIONS = [VonMises(), GURSON, ROUSSELIER]
FLOW_STRESS = 500.0e6
POROSITIES = [0.0, 0.01, 0.05, 0.08]
STRESSES = [
    np.array(given) * 1.0e6
    for given in (
        [[300, 120, 0], [120, -200, 40], [0, 40, 100]],
        [[900, 0, 0], [0, 700, 50], [0, 50, 800]],
        [[-700, 0, 30], [0, -900, 0], [30, 0, -500]],
    )
]


def tensor(a):
    return Tensor(*np.ravel(a))


def matrix(t):
    return np.array([[t.xx, t.xy, t.xz], [t.yx, t.yy, t.yz], [t.zx, t.zy, t.zz]])


def function(condition, stress, flow_stress, porosity):
    s = stress - np.trace(stress) / 3 * np.eye(3)
    return yield_value(
        condition, np.sqrt(1.5 * (s * s).sum()), np.trace(stress), flow_stress, porosity
    ).function


def smooth_function(condition, stress, flow_stress, porosity):
    """The yield functions of the papers; that of Rousselier is linear in stress."""
    s = stress - np.trace(stress) / 3 * np.eye(3)
    equivalent, mean = np.sqrt(1.5 * (s * s).sum()), np.trace(stress) / 3
    if isinstance(condition, VonMises):
        return equivalent**2 - flow_stress**2
    if isinstance(condition, Rousselier):
        D, sig_1 = condition
        voids = D * sig_1 * porosity * np.exp(mean / (sig_1 * (1 - porosity)))
        return equivalent / (1 - porosity) + voids - flow_stress
    q1, q2, q3, k, f_c = condition
    f = porosity if porosity <= f_c else f_c + k * (porosity - f_c)
    matrix_part = 1 + q3 * f**2 - 2 * q1 * f * np.cosh(1.5 * q2 * mean / flow_stress)
    return equivalent**2 - flow_stress**2 * matrix_part


def test_every_condition_is_tested():
    assert {type(c) for c in CONDITIONS} == set(YIELD_CONDITION.models.values())


@pytest.mark.parametrize("condition", CONDITIONS)
def test_the_sign_of_the_yield_function_is_that_of_the_papers(condition):
    for stress, factor, porosity in itertools.product(STRESSES, (0.1, 0.5, 1.0, 2.0), POROSITIES):
        mean = factor * np.trace(stress) / 3 * np.eye(3)
        if smooth_function(condition, mean, FLOW_STRESS, porosity) > 0:
            continue  # voids leave no strength
        expected = smooth_function(condition, factor * stress, FLOW_STRESS, porosity)
        assert np.sign(function(condition, factor * stress, FLOW_STRESS, porosity)) == np.sign(expected)


@pytest.mark.parametrize("condition", CONDITIONS)
def test_the_strength_is_the_equivalent_stress_of_the_surface(condition):
    for mean, porosity in itertools.product((-4e8, 0.0, 3e8), POROSITIES):
        strength = yield_value(condition, 0.0, 3 * mean, FLOW_STRESS, porosity).strength
        shear = strength / np.sqrt(3.0)
        stress = np.array([[mean, shear, 0], [shear, mean, 0], [0, 0, mean]])
        assert abs(smooth_function(condition, stress, FLOW_STRESS, porosity)) < 1e-9 * FLOW_STRESS**2


@pytest.mark.parametrize("condition", [GURSON, ROUSSELIER])
def test_without_porosity_the_condition_is_that_of_von_mises(condition):
    for stress in STRESSES:
        mises = yield_value(VonMises(), 4e8, np.trace(stress), FLOW_STRESS, 0.0)
        assert yield_value(condition, 4e8, np.trace(stress), FLOW_STRESS, 0.0) == pytest.approx(mises)


@pytest.mark.parametrize("condition", [GURSON, ROUSSELIER])
def test_when_voids_leave_no_strength_the_matrix_is_looked_at(condition):
    assert yield_value(condition, 0.0, 1e11, FLOW_STRESS, 0.3).strength == pytest.approx(
        FLOW_STRESS * (1.0 if condition is GURSON else 0.7)
    )


@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("porosity", POROSITIES)
def test_the_normal_is_the_derivative_by_stress(condition, porosity):
    for stress in STRESSES:
        normal = matrix(yield_normal(condition, tensor(stress), FLOW_STRESS, porosity))
        quotient = np.zeros((3, 3))
        for i, j in itertools.product(range(3), repeat=2):
            step = np.zeros((3, 3))
            step[i, j] = 1e3
            up = smooth_function(condition, stress + step, FLOW_STRESS, porosity)
            quotient[i, j] = (up - smooth_function(condition, stress - step, FLOW_STRESS, porosity)) / 2e3
        np.testing.assert_allclose(normal, quotient, rtol=1e-5, atol=1e-6 * np.abs(quotient).max())


@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("porosity", [0.01, 0.03, 0.08])
def test_the_hardening_term_is_the_derivative_along_the_evolution(condition, porosity):
    slope, nucleation = 2.0e9, 0.4
    for stress in STRESSES:
        normal = yield_normal(condition, tensor(stress), FLOW_STRESS, porosity)
        n = matrix(normal)
        sound = 1.0 if isinstance(condition, VonMises) else 1 - porosity
        strain_rate = (stress * n).sum() / (sound * FLOW_STRESS)
        porosity_rate = (1 - porosity) * np.trace(n) + nucleation * strain_rate
        h = 1e-5 * min(FLOW_STRESS / abs(slope * strain_rate), 0.01 / abs(porosity_rate))

        def along(h, stress=stress, strain_rate=strain_rate, porosity_rate=porosity_rate):
            flow_stress = FLOW_STRESS + h * slope * strain_rate
            return smooth_function(condition, stress, flow_stress, porosity + h * porosity_rate)

        quotient = (along(h) - along(-h)) / (2 * h)
        computed = hardening_term(condition, tensor(stress), normal, FLOW_STRESS, slope, porosity, nucleation)
        assert computed == pytest.approx(quotient, rel=1e-5)


def test_the_tangent_keeps_the_stress_on_the_yield_surface():
    # consistency: n : C_ep : d + h lambda = 0 with the multiplier lambda = n : C : d / (n : C : n - h)
    stress, rate = tensor(STRESSES[0]), tensor(STRESSES[2] / 1e9)
    normal = yield_normal(VonMises(), stress, FLOW_STRESS, 0.0)
    hardening = hardening_term(VonMises(), stress, normal, FLOW_STRESS, 3.0e9, 0.0, 0.0)
    tangent = tangent_modulus(129e9, 46e9, normal, hardening)
    n, d = matrix(normal), matrix(rate)
    elastic = matrix(elastic_stress(129e9, 46e9, rate))
    multiplier = (n * elastic).sum() / tangent.resistance
    stress_rate = elastic - matrix(tangent.direction) * multiplier
    assert (n * stress_rate).sum() == pytest.approx(-hardening * multiplier, rel=1e-9)
    assert (d * elastic).sum() > (d * stress_rate).sum()


@pytest.mark.parametrize("condition", CONDITIONS)
def test_compiled_functions_agree(condition):
    def value(condition, trace):
        return yield_value(condition, 4e8, trace, FLOW_STRESS, 0.06).function

    def term(condition, mean):
        stress = Tensor(3e8 + mean, 1e8, 0.0, 1e8, mean, 0.0, 0.0, 0.0, mean) + isotropic(mean)
        normal = yield_normal(condition, stress, FLOW_STRESS, 0.06)
        return hardening_term(condition, stress, normal, FLOW_STRESS, 2e9, 0.06, 0.4)

    assert_compiled_agrees(value, condition, 3e8)
    assert_compiled_agrees(term, condition, 2e8)
