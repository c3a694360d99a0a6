"""Particles that have mixed are brought into the order of their cells, and nothing else changes."""

from __future__ import annotations

import numpy as np
import pytest
from mpm_cases import make_body, make_grid, make_particles, make_simulation

from solver import sorting
from solver.interpolation.gimp import Gimp
from solver.interpolation.linear import Linear
from solver.sorting import disorder, in_order_of_cells, wants_sorting

GRID = make_grid((6, 5, 4), (0.5, 1.0, 2.0), (-1.0, 0.0, 3.0))


def positions(count=400, seed=1):
    low = np.array(GRID.anchor)
    high = low + np.array(GRID.cells) * np.array(GRID.spacing)
    return np.random.default_rng(seed).uniform(low, high, (count, 3))


def test_the_order_is_that_of_cells():
    x = positions()
    order = in_order_of_cells(GRID, x)
    np.testing.assert_array_equal(np.sort(order), np.arange(len(x)))
    i, j, k = GRID.cell_of(x[order]).T
    number = i + GRID.cells[0] * (j + GRID.cells[1] * k)
    assert (np.diff(number) >= 0).all()
    same = np.diff(number) == 0
    assert (np.diff(order)[same] > 0).all()  # those of a cell stay in their order


def test_disorder_is_the_share_of_jumps():
    x = np.array([[-0.9, 0.5, 3.5], [-0.4, 0.5, 3.5], [0.6, 0.5, 3.5], [0.7, 1.5, 5.5], [0.7, 3.5, 5.5]])
    assert disorder(GRID.index, x) == 0.5  # the third and the last
    assert disorder(GRID.index, x[:1]) == 0.0
    shuffled = positions()
    assert disorder(GRID.index, shuffled) > 0.8
    assert disorder(GRID.index, shuffled[in_order_of_cells(GRID, shuffled)]) < 0.2


def test_only_many_particles_that_mixed_are_sorted_and_seldom(monkeypatch):
    x = positions()
    assert not wants_sorting(GRID, x, 100)  # so few stay in the caches
    monkeypatch.setattr(sorting, "LEAST_PARTICLES", 100)
    assert wants_sorting(GRID, x, 100)
    assert not wants_sorting(GRID, x, 150)
    assert not wants_sorting(GRID, x[in_order_of_cells(GRID, x)], 100)


@pytest.mark.parametrize("interpolator", [Linear(), Gimp()], ids=["linear", "gimp"])
def test_a_run_with_sorting_ends_as_one_without(monkeypatch, interpolator):
    """To rounding: sums at the nodes are taken in another order."""
    ended = []
    for least in (10**9, 50):
        monkeypatch.setattr(sorting, "LEAST_PARTICLES", least)
        monkeypatch.setattr(sorting, "STEPS_BETWEEN_LOOKS", 2)
        particles = make_particles(GRID, 0.8 * positions() + 0.2 * positions().mean(axis=0))
        particles.velocity[:] = np.random.default_rng(2).normal(size=particles.velocity.shape)
        body = make_body(particles)
        simulation = make_simulation(GRID, [body], interpolator)
        for _ in range(5):
            simulation.advance(0.01)
        ended.append(body.particles)
    plain, in_order = ended
    np.testing.assert_array_equal(plain.id, np.arange(len(plain)))
    assert (np.diff(in_order.id) < 0).any()
    assert disorder(GRID.index, in_order.position) < 0.3 < disorder(GRID.index, plain.position)
    place = np.argsort(in_order.id)
    for name in ("position", "velocity", "stress", "deformation_gradient", "volume"):
        expected = getattr(plain, name)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(getattr(in_order, name)[place], expected, rtol=0.0, atol=1e-12 * scale)
