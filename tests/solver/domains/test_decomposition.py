from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpm_cases import make_grid

from solver.domains.decomposition import Domain, TooManyRanksError, cut, imbalance, patch_planes
from solver.grid import Grid


def profile_of(grid: Grid, work):
    """The profile of work (nx, ny, nz) in each cell."""

    def profile(boxes):
        found = []
        for box in boxes:
            part = work[tuple(slice(a, b) for a, b in zip(box.low, box.high, strict=True))]
            found.append([part.sum(axis=others) for others in ((1, 2), (0, 2), (0, 1))])
        return found

    return profile


def even(grid: Grid):
    return profile_of(grid, np.ones(grid.cells))


def loads(domains, work):
    return [work[tuple(slice(a, b) for a, b in zip(d.low, d.high, strict=True))].sum() for d in domains]


@given(
    cells=st.tuples(*[st.integers(1, 9)] * 3),
    ranks=st.integers(1, 12),
    seed=st.integers(0, 5),
)
def test_domains_tile_the_grid(cells, ranks, seed):
    grid = make_grid(cells)
    work = np.random.default_rng(seed).integers(0, 3, cells)
    if ranks > np.prod(cells):
        with pytest.raises(TooManyRanksError):
            cut(grid, ranks, profile_of(grid, work))
        return
    domains = cut(grid, ranks, profile_of(grid, work))
    times = np.zeros(cells, int)
    for low, high in domains:
        assert np.less(low, high).all()
        times[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] += 1
    assert len(domains) == ranks
    assert (times == 1).all()


def test_a_cube_on_eight_ranks_becomes_eight_cubes():
    grid = make_grid((8, 8, 8))
    assert {d.shape for d in cut(grid, 8, even(grid))} == {(4, 4, 4)}


def test_three_ranks_share_evenly():
    grid = make_grid((12, 2, 2))
    assert [d.shape[0] for d in cut(grid, 3, even(grid))] == [4, 4, 4]


def test_a_body_in_a_corner_is_shared_not_the_grid():
    grid = make_grid((20, 20, 1))
    work = np.zeros(grid.cells)
    work[:6, :6] = 8.0
    domains = cut(grid, 4, profile_of(grid, work))
    assert imbalance(loads(domains, work)) == 1.0


def test_cuts_follow_the_patches_of_the_deck():
    grid = make_grid((10, 10, 1), patches=(2, 2, 1))
    assert patch_planes(grid) == [[5], [5], []]
    domains = cut(grid, 4, even(grid), patch_planes(grid))
    assert {(d.low, d.high) for d in domains} == {(p.low, p.high) for p in grid.patches}


def test_cuts_leave_the_patches_where_there_are_too_few():
    grid = make_grid((8, 1, 1), patches=(2, 1, 1))
    assert [d.shape[0] for d in cut(grid, 4, even(grid), patch_planes(grid))] == [2, 2, 2, 2]


def test_work_that_is_nowhere_is_shared_by_cells():
    grid = make_grid((8, 1, 1))
    assert cut(grid, 2, profile_of(grid, np.zeros(grid.cells)))[0] == Domain((0, 0, 0), (4, 1, 1))


def test_imbalance_is_the_largest_over_the_mean():
    assert imbalance([1, 1, 1, 5]) == 2.5
    assert imbalance([0, 0]) == 1.0
