from __future__ import annotations

import numpy as np
import pytest

from solver.dispatch import inline
from solver.jit import kernel
from solver.lanes import WIDTH, Eight, where
from solver.materials.stability import STABILITY, is_checked, localizes, tangent_modulus
from solver.materials.stability.acoustic import Acoustic, Becker, band_determinant
from solver.materials.stability.drucker import Drucker
from solver.materials.stability.drucker_becker import DruckerBecker
from solver.materials.stability.no_check import NoCheck
from solver.tensor import Tensor, tensor_at

BULK, SHEAR = 150.0e9, 69.0e9
CHECKS = [NoCheck(), Drucker(), Becker(), DruckerBecker(), Acoustic()]


def tensor(a):
    return Tensor(*np.ravel(np.asarray(a, float)))


def stiffness(tangent):
    """M_ijkl of a tangent."""
    d = np.eye(3)
    symmetric = np.einsum("ik,jl->ijkl", d, d) + np.einsum("il,jk->ijkl", d, d)
    elastic = (BULK - 2 / 3 * SHEAR) * np.einsum("ij,kl->ijkl", d, d) + SHEAR * symmetric
    t = tangent.direction
    a = np.array([[t.xx, t.xy, t.xz], [t.yx, t.yy, t.yz], [t.zx, t.zy, t.zz]])
    return elastic - np.einsum("ij,kl->ijkl", a, a) / tangent.resistance


def band(stress, tangent, n):
    """R of Banerjee 2012, Eq. 77, for a band normal."""
    M = stiffness(tangent)
    R = np.einsum("ikjl,k,l->ij", M, n, n) + np.einsum("ilkj,k,l->ij", M, n, n)
    return R - np.outer(stress @ n, n)


def turned(a, angle=0.7):
    c, s = np.cos(angle), np.sin(angle)
    Q = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    return Q @ a @ Q.T


def uniaxial(stress, modulus):
    """Stress and tangent of a von Mises material in tension whose flow stress has a slope."""
    sigma = np.diag([stress, 0.0, 0.0])
    normal = 3 * (sigma - stress / 3 * np.eye(3))
    return sigma, tangent_modulus(BULK, SHEAR, tensor(normal), -4 * modulus * stress**2)


def test_every_check_is_tested():
    assert {type(c) for c in CHECKS} == set(STABILITY.models.values())


@pytest.mark.parametrize("modulus", [5.0e9, 0.0, -30.0e9])
def test_the_band_determinant_is_that_of_the_acoustic_tensor(modulus):
    sigma, tangent = uniaxial(8.0e8, modulus)
    det = band_determinant(tensor(sigma), tangent)
    for angle in np.linspace(0.01, 1.5, 7):
        n = np.array([np.cos(angle), 0.0, np.sin(angle)])
        x = n[2] / n[0]
        R = band(sigma, tangent, n)
        in_plane = R[0, 0] * R[2, 2] - R[0, 2] * R[2, 0]
        assert in_plane == pytest.approx(2 * n[0] ** 4 * (det.a * x**4 + det.b * x**2 + det.c), rel=1e-9)
        assert np.linalg.det(R) == pytest.approx(in_plane * R[1, 1], rel=1e-9)


@pytest.mark.parametrize("modulus", [5.0e9, -3.0e9, -40.0e9])
def test_the_acoustic_check_finds_what_a_search_over_bands_finds(modulus):
    sigma, tangent = uniaxial(8.0e8, modulus)
    angles = np.linspace(0.0, np.pi / 2, 2001)
    worst = min(np.linalg.det(band(sigma, tangent, np.array([np.cos(a), 0, np.sin(a)]))) for a in angles)
    assert localizes(Acoustic(), tensor(sigma), tensor(sigma), tangent) == (worst <= 0.0)


def test_hardening_material_is_stable_and_softening_is_not():
    for check in (Acoustic(), Becker()):
        answers = []
        for modulus in (5.0e9, -60.0e9):
            sigma, tangent = uniaxial(8.0e8, modulus)
            answers.append(localizes(check, tensor(sigma), tensor(sigma), tangent))
        assert answers == [False, True]


@pytest.mark.parametrize("check", CHECKS)
def test_checks_do_not_depend_on_the_frame(check):
    for modulus in (5.0e9, -2.0e9, -60.0e9):
        sigma, tangent = uniaxial(8.0e8, modulus)
        normal = 3 * (sigma - np.trace(sigma) / 3 * np.eye(3))
        rate = np.diag([2.0, -1.0, -0.9])
        there = tangent_modulus(BULK, SHEAR, tensor(turned(normal)), -4 * modulus * 8.0e8**2)
        here = localizes(check, tensor(sigma), tensor(rate), tangent)
        assert localizes(check, tensor(turned(sigma)), tensor(turned(rate)), there) == here


def test_drucker_looks_at_the_rate_of_the_stress_power():
    for modulus, rate in (
        (5.0e9, [2, -1, -1]),
        (-5.0e9, [2, -1, -1]),
        (-5.0e9, [1, 1, 1]),
        (-5.0e9, [0, 1, -1]),
    ):
        sigma, tangent = uniaxial(8.0e8, modulus)
        d = np.diag(rate)
        power = np.einsum("ij,ijkl,kl", d, stiffness(tangent), d)
        assert localizes(Drucker(), tensor(sigma), tensor(d), tangent) == (power <= 0)
        assert localizes(DruckerBecker(), tensor(sigma), tensor(d), tangent) >= (power <= 0)


def test_no_check_checks_nothing():
    sigma, tangent = uniaxial(8.0e8, -60.0e9)
    assert not localizes(NoCheck(), tensor(sigma), tensor(sigma), tangent)
    assert [is_checked(c) for c in CHECKS] == [False, True, True, True, True]


@inline
def check_at(check, stresses, rates, hardening, p, answers):
    normal = tensor_at(stresses, p) * 3.0
    tangent = tangent_modulus(BULK, SHEAR, normal, hardening[p])
    answers[p] = where(localizes(check, tensor_at(stresses, p), tensor_at(rates, p), tangent), 1.0, 0.0)


@kernel
def check_eight(check, stresses, rates, hardening, answers):
    for start in range(0, answers.shape[0], WIDTH):
        check_at(check, stresses, rates, hardening, Eight(start), answers)


@pytest.mark.parametrize("check", CHECKS[1:], ids=lambda check: type(check).__name__)
def test_eight_at_once_are_checked_as_one_after_the_other(check):
    rng = np.random.default_rng(6)
    stresses, rates = rng.normal(size=(2, 400, 3, 3))
    stresses, rates = (a + a.transpose(0, 2, 1) for a in (stresses, rates))
    stresses -= np.trace(stresses, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    stresses *= 8.0e8 / np.sqrt(1.5) / np.linalg.norm(stresses, axis=(1, 2))[:, None, None]
    rates[::2] = 1.0e-8 * stresses[::2] + 0.01 * rates[::2]  # as they flow
    stresses[3] = 0.0
    hardening = -4 * rng.uniform(-60.0e9, 5.0e9, 400) * 8.0e8**2
    answers, expected = np.zeros((2, 400))
    check_eight(check, stresses, rates, hardening, answers)
    for p in range(400):
        check_at(check, stresses, rates, hardening.tolist(), p, expected)
    np.testing.assert_array_equal(answers, expected)
    assert 0.1 < expected.mean() < 0.9
