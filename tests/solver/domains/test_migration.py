from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpm_cases import make_grid

from solver.domains.decomposition import Domain
from solver.domains.migration import Room, joined, owners, packed, unpacked

HALVES = (Domain((0, 0, 0), (2, 3, 1)), Domain((2, 0, 0), (4, 3, 1)))


class Some(NamedTuple):
    position: np.ndarray
    number: np.ndarray
    matrix: np.ndarray


def some(numbers) -> tuple[Some]:
    n = np.array(numbers, np.int32)
    return (Some(n[:, None] * [1.0, 2.0, 3.0], n, np.full((len(n), 3, 3), n[:, None, None] / 7.0)),)


def same(a, b) -> bool:
    return all(np.array_equal(x, y) for x, y in zip(a[0], b[0], strict=True))


@pytest.mark.parametrize(
    ("x", "periodic", "owner"),
    [
        (0.5, 0, 0),
        (1.999, 0, 0),
        (2.0, 0, 1),
        (3.9, 0, 1),
        (-0.1, 0, 0),
        (4.2, 0, 1),
        (-0.1, 1, 1),
        (4.2, 1, 0),
    ],
)
def test_a_position_belongs_to_the_rank_of_its_cell(x, periodic, owner):
    grid = make_grid((4, 3, 1), periodic=(periodic, 0, 0), extra=(1 - periodic, 1, 1))
    assert owners(grid, HALVES, np.array([[x, 1.5, 0.5]])).tolist() == [owner]


def test_particles_arrive_as_they_were_sent():
    bodies = [some([3, 1, 4]), some([1, 5])]
    chosen = [np.array([0, 2]), np.array([], int)]
    first, second = unpacked(bodies, packed(bodies, chosen))
    assert same(first, some([3, 4]))
    assert same(second, some([]))
    assert first[0].number.dtype == np.int32


def test_parts_are_joined_in_order():
    assert same(joined([some([1]), some([]), some([2, 3])]), some([1, 2, 3]))


@given(
    start=st.integers(0, 12),
    steps=st.lists(st.tuples(st.sets(st.integers(0, 40)), st.integers(0, 9)), max_size=5),
)
def test_a_room_holds_who_stayed_and_who_came(start, steps):
    room = Room()
    records, expected, following = some(range(start)), set(range(start)), start
    for leaving, coming in steps:
        gone = np.array(sorted(p for p in leaving if p < len(records[0].number)), int)
        expected -= set(records[0].number[gone].tolist())
        newcomers = some(range(following, following + coming))
        expected |= set(newcomers[0].number.tolist())
        following += coming
        records = room.exchanged(records, gone, newcomers)
        assert sorted(records[0].number.tolist()) == sorted(expected)
        assert same(records, some(records[0].number))


def test_a_few_particles_come_and_go_without_a_copy_of_all():
    room = Room()
    records = room.exchanged(some(range(100)), np.array([], int), some([]))
    again = room.exchanged(records, np.array([5, 7]), some([200]))
    assert np.shares_memory(records[0].matrix, again[0].matrix)


def test_records_that_somebody_replaced_are_taken_as_they_are():
    room = Room()
    room.exchanged(some(range(10)), np.array([], int), some([]))
    assert same(room.exchanged(some([7, 8]), np.array([0]), some([9])), some([9, 8]))
