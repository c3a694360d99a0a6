from __future__ import annotations

import numpy as np
import pytest
from plasticity import state
from scipy.optimize import brentq
from test_flow_stress import COPPER_MTS, ISOTROPIC, STEEL_JC

from solver.materials.flow_stress import flow_stress
from solver.materials.plasticity_state import at_plastic_strain
from solver.materials.return_algorithm import RETURN_ALGORITHM, PlasticTrial, return_to_yield
from solver.materials.return_algorithm.radial_return import RadialReturn
from solver.materials.return_algorithm.semi_implicit import SemiImplicit
from solver.tensor import Tensor

G, DT = 46.0e9, 1.0e-7
RATE = np.array([[2000.0, 300.0, 0.0], [300.0, -700.0, 0.0], [0.0, 0.0, -1300.0]])


def tensor(a):
    return Tensor(*np.ravel(a))


def matrix(t):
    return np.array([[t.xx, t.xy, t.xz], [t.yx, t.yy, t.yz], [t.zx, t.zy, t.zz]])


def trial_of(start, flow_stress_now, old_rate=1.0e9):
    deviator = start + 2 * G * DT * RATE
    return PlasticTrial(
        leaves=True,
        old_stress=tensor(start - 1.0e8 * np.eye(3)),
        stress_deviator=tensor(deviator),
        rate_deviator=tensor(RATE),
        old_strain_rate=old_rate,
        flow_stress=flow_stress_now,
        strength=flow_stress_now,
        porosity=0.0,
        stiffness=G,
    )


def at_yield(model, turned=False):
    """A particle on the yield surface, stressed along or across the rate of deformation."""
    s = np.diag([0.0, 1.0, -1.0]) if turned else RATE
    at = state(strain_rate=np.sqrt(2 / 3) * np.linalg.norm(RATE), temperature=400.0)
    sigma_y = flow_stress(model, at)
    return at, s * (np.sqrt(2 / 3) * sigma_y / np.linalg.norm(s)), sigma_y


def exact(model, at, trial):
    """The closest point on the yield surface, by bracketing."""
    size = np.linalg.norm(matrix(trial.stress_deviator))

    def gap(multiplier):
        strain = np.sqrt(2 / 3) * multiplier
        end = at_plastic_strain(at, at.plastic_strain + strain, strain / DT)
        return size - np.sqrt(2 / 3) * flow_stress(model, end) - 2 * G * multiplier

    multiplier = brentq(gap, 0.0, size / (2 * G), xtol=1e-16)
    strain = np.sqrt(2 / 3) * multiplier
    return strain, flow_stress(model, at_plastic_strain(at, at.plastic_strain + strain, strain / DT))


def test_every_algorithm_is_tested():
    assert set(RETURN_ALGORITHM.models.values()) == {RadialReturn, SemiImplicit}


@pytest.mark.parametrize("algorithm", [RadialReturn(), SemiImplicit()])
@pytest.mark.parametrize("model", [ISOTROPIC, STEEL_JC, COPPER_MTS])
@pytest.mark.parametrize("turned", [False, True])
def test_the_stress_ends_on_the_yield_surface(algorithm, model, turned):
    at, start, sigma_y = at_yield(model, turned)
    trial = trial_of(start, sigma_y)
    end = return_to_yield(algorithm, model, at, trial, DT)
    stress = matrix(end.stress_deviator)
    reached = flow_stress(model, at_plastic_strain(at, end.plastic_strain, end.plastic_strain_rate))
    assert end.flow_stress == reached
    assert np.sqrt(1.5) * np.linalg.norm(stress) == pytest.approx(reached, rel=2e-3)
    assert end.plastic_strain - at.plastic_strain == pytest.approx(end.plastic_strain_rate * DT, rel=1e-9)
    trial_stress = matrix(trial.stress_deviator)
    direction = trial_stress / np.linalg.norm(trial_stress)
    np.testing.assert_allclose(stress / np.linalg.norm(stress), direction, atol=1e-12)


@pytest.mark.parametrize("model", [ISOTROPIC, STEEL_JC, COPPER_MTS])
def test_the_plastic_strain_is_that_of_the_closest_point(model):
    at, start, sigma_y = at_yield(model)
    trial = trial_of(start, sigma_y)
    strain, sigma = exact(model, at, trial)
    for algorithm in (RadialReturn(), SemiImplicit()):
        end = return_to_yield(algorithm, model, at, trial, DT)
        assert end.plastic_strain - at.plastic_strain == pytest.approx(strain, rel=0.02)
        assert end.flow_stress == pytest.approx(sigma, rel=1e-3)


def test_linear_hardening_is_solved_in_one_iteration():
    at, start, sigma_y = at_yield(ISOTROPIC)
    trial = trial_of(1.02 * start, sigma_y)
    strain, _ = exact(ISOTROPIC, at, trial)
    end = return_to_yield(RadialReturn(), ISOTROPIC, at, trial, DT)
    assert end.plastic_strain - at.plastic_strain == pytest.approx(strain, rel=1e-9)
    assert np.linalg.norm(matrix(end.plastic_increment)) == pytest.approx(end.multiplier, rel=1e-12)


@pytest.mark.parametrize("case", ["no stress", "unloading", "short step", "slow before"])
def test_the_semi_implicit_algorithm_falls_back_to_newtons(case):
    at, start, sigma_y = at_yield(STEEL_JC)
    trial = trial_of(start, sigma_y)
    if case == "no stress":
        trial = trial._replace(old_stress=tensor(-1.0e8 * np.eye(3)))
    elif case == "unloading":
        trial = trial._replace(old_stress=tensor(-start))
    elif case == "short step":
        trial = trial._replace(strength=3 * sigma_y)
    else:
        trial = trial._replace(old_strain_rate=1.0)
    semi = return_to_yield(SemiImplicit(), STEEL_JC, at, trial, DT)
    radial = return_to_yield(RadialReturn(), STEEL_JC, at, trial, DT)
    assert semi.plastic_strain == radial.plastic_strain
    np.testing.assert_array_equal(matrix(semi.stress_deviator), matrix(radial.stress_deviator))


def test_the_semi_implicit_estimate_is_that_of_the_paper():
    # Banerjee 2012, Eqs. 8, 13, 15 and 19, for stress across the rate
    at, start, sigma_y = at_yield(STEEL_JC, turned=True)
    trial = trial_of(start, sigma_y)
    u_s, u_eta = start / np.linalg.norm(start), RATE / np.linalg.norm(RATE)
    eta_s, eta = (RATE * u_s).sum(), (RATE * u_eta).sum()
    gamma_n = np.sqrt(3) * eta_s / 3
    roots = np.roots([2 / np.sqrt(3), -(eta_s + eta), 3 * gamma_n * (eta_s - eta)])
    error = (np.sqrt(2) * sigma_y - np.sqrt(3) * np.linalg.norm(start)) / (6 * G)
    gamma = max(roots) * DT / 3 - error
    end = return_to_yield(SemiImplicit(), STEEL_JC, at, trial, DT)
    assert end.multiplier == pytest.approx(gamma, rel=1e-9)
    # the plastic strain increment gamma u has the norm sqrt(3) gamma
    assert np.linalg.norm(matrix(end.plastic_increment)) == pytest.approx(np.sqrt(3) * gamma, rel=1e-9)
    assert end.plastic_strain_rate * DT == pytest.approx(np.sqrt(2) * gamma, rel=1e-9)
