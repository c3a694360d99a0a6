"""Which cells, nodes and faces a patch stores, and where points are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from ups.archive import Archive, Box, Grid, Level, Patch
from ups.archive.variables import CELL, FACES, GRID_CONTAINERS, NODE

small = st.integers(1, 3)


@st.composite
def tiled_levels(draw):
    low = tuple(draw(st.integers(-3, 3)) for _ in range(3))
    parts = tuple(draw(small) for _ in range(3))
    high = tuple(lo + n * draw(small) for lo, n in zip(low, parts, strict=True))
    periodic = tuple(draw(st.booleans()) for _ in range(3))
    extra = tuple(0 if p else draw(st.integers(0, 2)) for p in periodic)
    grid = Grid.single_level(
        Box(low, high).split(parts),
        spacing=(0.5, 0.25, 2.0),
        anchor=(1.0, -2.0, 0.125),
        extra_cells=extra,
        periodic=periodic,
        procs=draw(st.integers(1, 3)),
    )
    return grid.levels[0]


@settings(max_examples=60, deadline=None)
@given(tiled_levels(), st.sampled_from(GRID_CONTAINERS))
def test_every_value_of_a_level_is_stored_once(level, container):
    whole = level.whole(container)
    stored = np.zeros(whole.shape, dtype=int)
    for position in range(len(level.patches)):
        stored[level.extent(position, container).within(whole.low)] += 1
    assert (stored == 1).all()


@settings(max_examples=60, deadline=None)
@given(tiled_levels())
def test_a_level_has_one_more_node_than_cells_unless_periodic(level):
    for axis in range(3):
        cells = level.interior.shape[axis]
        edge = 0 if level.periodic[axis] else 2 * level.extra_cells[axis]
        closing = 0 if level.periodic[axis] else 1
        assert level.whole(CELL).shape[axis] == cells + edge
        assert level.whole(NODE).shape[axis] == cells + edge + closing
        for face_axis, container in enumerate(FACES):
            assert level.whole(container).shape[axis] == cells + edge + (closing if face_axis == axis else 0)


@settings(max_examples=60, deadline=None)
@given(tiled_levels(), st.integers(0, 2**32 - 1))
def test_patch_of_position_is_the_patch_around_the_point(level, seed):
    low, high = level.bounds(level.interior)
    points = np.random.default_rng(seed).uniform(np.array(low) - 1.0, np.array(high) + 1.0, size=(50, 3))
    for point, owner in zip(points, level.patch_of_position(points), strict=True):
        holders = [
            position
            for position, patch in enumerate(level.patches)
            if all(
                lo * h <= x - a < hi * h
                for lo, hi, h, x, a in zip(
                    patch.low, patch.high, level.spacing, point, level.anchor, strict=True
                )
            )
        ]
        assert holders == ([owner] if owner >= 0 else [])


def test_a_point_on_a_boundary_belongs_to_the_patch_on_its_plus_side(grid):
    level = grid.levels[0]
    points = np.array(
        [[1.0, 0.5, 0.25], [np.nextafter(1.0, 0.0), 0.5, 0.25], [2.0, 0.5, 0.25], [0.0, 0.0, 0.0]]
    )
    assert level.patch_of_position(points).tolist() == [1, 0, -1, 0]


def test_the_nearest_patch_takes_points_beyond_the_edge(grid):
    level = grid.levels[0]
    points = np.array([[-7.0, 0.5, 0.25], [2.0, 0.5, 9.0], [np.inf, 0.5, 0.25], [np.nan, 0.5, 0.25]])
    assert level.nearest_patch(points).tolist() == [0, 1, 1, -1]


def test_patches_are_cut_at_the_integer_part():
    # 50 cells in three patches, as in an archive of a 12-patch run of Uintah's
    cuts = [box.low[0] for box in Box((0, 0, 0), (50, 1, 1)).split((3, 1, 1))]
    assert cuts == [0, 16, 33]


def test_patches_are_numbered_with_the_last_axis_fastest():
    lows = [box.low for box in Box((0, 0, 0), (2, 2, 2)).split((2, 2, 2))]
    assert lows[:3] == [(0, 0, 0), (0, 0, 1), (0, 1, 0)]


def test_a_partly_covered_face_counts_as_having_a_neighbour():
    patches = (Patch(0, 0, (0, 0, 0), (2, 4, 1)), Patch(1, 0, (2, 0, 0), (4, 2, 1)))
    level = Level(0, (0, 0, 0), (1, 1, 1), (1, 1, 0), (False,) * 3, patches)
    assert level.extent(0, NODE) == Box((-1, -1, 0), (2, 6, 2))
    assert level.extent(1, NODE) == Box((2, -1, 0), (6, 4, 2))


def test_a_boundary_layer_replaces_the_extra_cells(grid):
    assert grid.levels[0].extent(0, CELL, (2, 0, 0)) == Box((-2, 0, 0), (2, 2, 1))
    assert grid.levels[0].whole(CELL, (2, 0, 0)) == Box((-2, 0, 0), (6, 2, 1))


def test_coordinates_of_nodes_cells_and_faces(grid):
    level = grid.levels[0]
    assert level.coordinates(NODE, level.whole(NODE))[0].tolist() == [-0.5, 0, 0.5, 1, 1.5, 2, 2.5]
    assert level.coordinates(CELL, level.whole(CELL))[1].tolist() == [-0.25, 0.25, 0.75, 1.25]
    assert level.coordinates("SFCXVariable", level.interior)[0].tolist() == [0, 0.5, 1, 1.5]
    assert level.coordinates("SFCXVariable", level.interior)[1].tolist() == [0.25, 0.75]


def test_ranks_get_runs_of_patches():
    grid = Grid.single_level(Box((0, 0, 0), (5, 1, 1)).split((5, 1, 1)), spacing=(1, 1, 1), procs=2)
    assert [patch.proc for patch in grid.levels[0].patches] == [0, 0, 0, 1, 1]
    assert grid.number_of_processes == 2


@pytest.mark.parametrize("name", ["disks_sulsky", "disks_gzip_2ranks", "mpmice_two_levels"])
def test_extents_are_those_that_sus_notes(sus, name):
    archive = Archive(sus(name))
    root = etree.parse(archive.path / archive.timesteps[0].href).getroot()
    checked = 0
    for level, noted in zip(archive.grid().levels, root.iter("Level"), strict=True):
        assert level.total_cells == int(noted.findtext("totalCells"))
        for position, patch in enumerate(noted.iter("Patch")):
            stored = level.extent(position, CELL)
            assert "[{}, {}, {}]".format(*stored.low) == patch.findtext("lowIndex")
            assert "[{}, {}, {}]".format(*stored.high) == patch.findtext("highIndex")
            assert level.extent(position, NODE).size == int(patch.findtext("nnodes"))
            checked += 1
    assert checked >= 4


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"patches": ()}, "no patch"),
        (
            {"patches": (Patch(0, 0, (0, 0, 0), (1, 1, 1)), Patch(2, 0, (1, 0, 0), (2, 1, 1)))},
            "patch 2 stands",
        ),
        ({"patches": (Patch(0, 0, (0, 0, 0), (2, 1, 1)), Patch(1, 0, (1, 0, 0), (3, 1, 1)))}, "overlap"),
        ({"patches": (Patch(0, 0, (0, 0, 0), (0, 1, 1)),)}, "empty"),
        ({"patches": (Patch(0, -1, (0, 0, 0), (1, 1, 1)),)}, "process -1"),
        ({"spacing": (1.0, 0.0, 1.0)}, "spacing"),
        ({"anchor": (0.0, float("nan"), 0.0)}, "anchor"),
        ({"extra_cells": (1, 0, 0), "periodic": (True, False, False)}, "periodic"),
        ({"extra_cells": (-1, 0, 0)}, "extra cells"),
    ],
)
def test_an_impossible_level_is_refused(change, message):
    good = {
        "index": 0,
        "anchor": (0.0, 0.0, 0.0),
        "spacing": (1.0, 1.0, 1.0),
        "extra_cells": (0, 0, 0),
        "periodic": (False, False, False),
        "patches": (Patch(0, 0, (0, 0, 0), (1, 1, 1)),),
    }
    with pytest.raises(ValueError, match=message):
        Level(**(good | change))


def test_levels_stand_in_their_order(grid):
    with pytest.raises(ValueError, match="level 0 stands"):
        Grid((grid.levels[0], grid.levels[0]))
    with pytest.raises(ValueError, match="needs a level"):
        Grid(())
