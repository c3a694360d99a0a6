"""Storage of nodes, positions, and who is whose neighbour."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpm_cases import make_grid

from solver.grid import FACES, Grid, Patch

GRID = make_grid((3, 4, 5), (0.5, 1.0, 2.0), (-1.0, 0.0, 10.0))


def test_nodes_are_stored_x_fastest_extra_nodes_included():
    nodes = [(i, j, k) for k in range(-1, 7) for j in range(-1, 6) for i in range(-1, 5)]
    assert GRID.number_of_nodes == len(nodes)
    assert [GRID.flat(*node) for node in nodes] == list(range(len(nodes)))
    np.testing.assert_allclose(
        GRID.node_positions(), [(-1 + 0.5 * i, 1.0 * j, 10 + 2.0 * k) for i, j, k in nodes]
    )


def test_box_view_shares_memory_and_is_indexed_by_node():
    values = np.zeros((GRID.number_of_nodes, 3))
    box = GRID.as_box(values)
    assert box.shape == (6, 7, 8, 3)
    box[2, 3, 4] = (1.0, 2.0, 3.0)
    np.testing.assert_array_equal(values[GRID.flat(1, 2, 3)], (1.0, 2.0, 3.0))
    assert np.count_nonzero(values) == 3
    assert GRID.as_box(values[:, 0]).shape == (6, 7, 8)


@given(
    st.tuples(*[st.integers(1, 5)] * 3), st.tuples(*[st.integers(0, 2)] * 3), st.tuples(*[st.booleans()] * 3)
)
def test_ghost_nodes_hold_extra_cells_or_images(cells, extra, repeats):
    periodic = tuple(int(r) for r in repeats)
    grid = make_grid(cells, extra=extra, periodic=periodic)
    ghost = np.maximum(extra, periodic)
    assert grid.ghost == tuple(ghost)
    assert grid.index.first == tuple(-ghost)
    assert grid.number_of_nodes == np.prod(np.array(cells) + 1 + 2 * ghost)


def test_measures():
    assert GRID.upper == (0.5, 4.0, 20.0)
    assert GRID.cell_volume == 1.0
    assert GRID.dimensions == 3
    assert make_grid((3, 4, 1)).dimensions == 2


def test_cells_hold_their_lower_faces():
    positions = np.array([[-1.0, 0.0, 10.0], [-0.5, 0.999, 11.999], [-1.001, 4.0, 9.0]])
    np.testing.assert_array_equal(GRID.cell_of(positions), [(0, 0, 0), (1, 0, 0), (-1, 4, -1)])


def neighbors(grid):
    return [{face for face in FACES if grid.has_neighbor(patch, face)} for patch in grid.patches]


def test_a_single_patch_has_no_neighbor_but_itself_where_the_domain_repeats():
    assert neighbors(make_grid((4, 4, 4))) == [set()]
    assert neighbors(make_grid((4, 4, 4), periodic=(0, 1, 0))) == [{"y-", "y+"}]


def test_patches_side_by_side_are_neighbors():
    assert neighbors(make_grid((4, 4, 4), patches=(2, 1, 1))) == [{"x+"}, {"x-"}]
    assert neighbors(make_grid((4, 4, 4), patches=(1, 1, 3))) == [{"z+"}, {"z-", "z+"}, {"z-"}]
    assert neighbors(make_grid((4, 4, 4), patches=(2, 1, 1), periodic=(1, 0, 0))) == [{"x-", "x+"}] * 2


@pytest.mark.parametrize(
    ("low", "touches"), [((2, 0, 0), True), ((2, 3, 0), True), ((2, 4, 0), False), ((3, 0, 0), False)]
)
def test_patches_that_share_part_of_a_face_are_neighbors(low, touches):
    first, second = Patch(0, (0, 0, 0), (2, 4, 1)), Patch(1, low, (low[0] + 2, low[1] + 4, 1))
    grid = Grid((0.0,) * 3, (1.0,) * 3, (5, 8, 1), (0, 0, 0), (0, 0, 0), (first, second))
    assert grid.has_neighbor(first, "x+") is touches
    assert grid.has_neighbor(second, "x-") is touches
    assert not grid.has_neighbor(first, "x-")
