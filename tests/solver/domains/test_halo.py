from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mpm_cases import make_grid
from thread_ranks import on_ranks

from solver.domains.decomposition import cut
from solver.domains.halo import Halo
from solver.grid import Window

CASES = [
    # cells, periodic, ranks, layers
    ((6, 5, 4), (0, 0, 0), 4, 1),
    ((6, 5, 4), (1, 0, 1), 4, 1),
    ((6, 5, 4), (1, 1, 1), 3, 2),
    ((8, 3, 1), (0, 0, 1), 2, 1),
    ((4, 1, 1), (1, 1, 1), 2, 2),
    ((7, 4, 2), (0, 1, 0), 5, 3),
]


def halves(grid, ranks):
    return cut(grid, ranks, lambda boxes: [[np.ones(n) for n in box.shape] for box in boxes])


def part(grid, domains, layers, communicator):
    """The grid of a rank, its halo, and for each of its nodes the number of the node of the domain."""
    mine = replace(grid, window=Window(*domains[communicator.rank], layers))
    i, j, k = np.meshgrid(*(mine.node_indices(a) + 1 for a in range(3)), indexing="ij")
    number = (i + 100 * (j + 100 * k)).transpose(2, 1, 0).ravel()
    return mine, Halo(mine, domains, communicator), number


def grid_of(cells, periodic):
    return make_grid(cells, periodic=periodic, extra=tuple(1 - p for p in periodic))


@pytest.mark.parametrize(("cells", "periodic", "ranks", "layers"), CASES)
def test_sums_at_a_node_are_those_of_all_its_copies(cells, periodic, ranks, layers):
    grid = grid_of(cells, periodic)
    domains = halves(grid, ranks)

    def add(communicator):
        mine, halo, number = part(grid, domains, layers, communicator)
        random = np.random.default_rng(communicator.rank)
        before = random.normal(size=(mine.number_of_nodes, 2)) * 10.0 ** random.integers(
            -8, 8, (mine.number_of_nodes, 1)
        )
        after = before.copy()
        halo.add(after)()
        return number, before, after

    found = on_ranks(ranks, add)
    numbers, before, after = (np.concatenate(parts) for parts in zip(*found, strict=True))
    for n in np.unique(numbers):
        copies = numbers == n
        assert after[copies] == pytest.approx(
            before[copies].sum(axis=0)[None].repeat(copies.sum(), 0), rel=1e-9
        )
        assert (after[copies] == after[copies][0]).all()  # the same bits


@pytest.mark.parametrize(("cells", "periodic", "ranks", "layers"), CASES)
def test_of_all_copies_of_a_node_one_counts_and_the_others_take_its_value(cells, periodic, ranks, layers):
    grid = grid_of(cells, periodic)
    domains = halves(grid, ranks)

    def share(communicator):
        _, halo, number = part(grid, domains, layers, communicator)
        values = np.where(halo.counted, 1.0 * number, -1.0)
        halo.share(values)
        return number, halo.counted, values

    found = on_ranks(ranks, share)
    numbers, counted, values = (np.concatenate(parts) for parts in zip(*found, strict=True))
    extra = [0 if p else 2 for p in periodic]
    assert np.array_equal(np.sort(numbers[counted]), np.unique(numbers))
    assert len(np.unique(numbers)) == np.prod(
        [n + (1 - p) + e for n, p, e in zip(cells, periodic, extra, strict=True)]
    )
    assert (values == numbers).all()


def test_ranks_store_their_part_only():
    grid = make_grid((64, 4, 4))
    domains = halves(grid, 8)
    mine = replace(grid, window=Window(*domains[3], 1))
    assert mine.index.nodes == (8 + 3, 4 + 3, 4 + 3)
    assert mine.index.first == (23, -1, -1)
