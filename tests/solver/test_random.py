"""Random numbers against those of Uintah's own generator, compiled and run for the purpose."""

from __future__ import annotations

import math

import numpy as np
import pytest

from solver.random import by_patch, drand48, gaussian, musil, patch_seed, size_effect, uniform, weibull


@pytest.mark.parametrize(
    ("seed", "first", "thousandth"),
    [
        (0, [0.42119194568651963, 0.88829671293998302, 0.35388849748349571], 0.046037928249763382),
        (1, [0.82062205646650099, 0.30630663123665514, 0.16680574495472555], 0.32348084610007888),
        (24, [0.69208953528651307, 0.98259884483230664, 0.74198238564214947], 0.41487815277771389),
        ((1 << 31) | 5, [0.44002355081608258, 0.69447088014103997, 0.70334836105584131], 0.45295054969574267),
    ],
)
def test_musil(seed, first, thousandth):
    drawn = musil(seed, 1000)
    assert drawn[:3].tolist() == first
    assert drawn[-1] == thousandth


def test_gaussian():
    values = gaussian(musil(3, 6).reshape(3, 2), 10.0, 2.5)
    np.testing.assert_allclose(
        values, [8.1812317869894606, 8.738753623608627, 12.030203064997153], rtol=1e-14
    )


def test_weibull():
    values = weibull(musil(3, 3), 10.0, 6.0, 0.5, 2.0, 4.0)
    np.testing.assert_allclose(
        values, [14.211044052509193, 13.32206007533809, 11.214581628536473], rtol=1e-14
    )


def test_distributions_have_their_moments():
    draws = musil(11, 20000)
    normal = gaussian(draws.reshape(-1, 2), 3.0, 0.5)
    assert normal.mean() == pytest.approx(3.0, abs=0.02)
    assert normal.std() == pytest.approx(0.5, abs=0.02)
    assert weibull(draws, 7.0, 3.0).mean() == pytest.approx(7.0, rel=0.01)
    flat = uniform(draws, 5.0, 2.0)
    assert (flat.min(), flat.max()) == (pytest.approx(3.0, abs=0.01), pytest.approx(7.0, abs=0.01))


def test_larger_particles_are_weaker():
    assert size_effect(8.0, 1.0, 3.0) == pytest.approx(0.5)


def test_patches_have_seeds_of_their_own():
    assert [patch_seed(3, p) for p in (0, 1, 31, 32)] == [4, 8, 4 << 31 & 0xFFFFFFFF, 5]


def test_by_patch_follows_the_order_of_particles():
    patch = np.array([5, 2, 5, 2, 2])
    drawn = by_patch(patch, 9, per_particle=2)
    np.testing.assert_array_equal(drawn[patch == 2].ravel(), musil(patch_seed(9, 2), 6))
    np.testing.assert_array_equal(drawn[patch == 5].ravel(), musil(patch_seed(9, 5), 4))


@pytest.mark.parametrize("count", [0, 1, 2, 5, 1000])
def test_drand48_is_the_linear_congruence(count):
    state, expected = 0, []
    for _ in range(count):
        state = (0x5DEECE66D * state + 11) % 2**48
        expected.append(math.ldexp(state, -48))
    assert drand48(count).tolist() == expected
