from __future__ import annotations

import numpy as np
import pytest

from solver.insertion import read_insertions
from solver.particles import Particles, new_arrays

ROWS = """0     0 -0.175 -1.25 0  20 0 0
0.5   1 -0.175 -1.25 0  20 0 0

0.25  2  1 2 3           4 5 6
"""


@pytest.fixture
def insertions(tmp_path):
    def write(text=ROWS):
        file = tmp_path / "insert.dat"
        file.write_text(text)
        return read_insertions(file)

    return write


def waiting(*colors):
    particles = new_arrays(Particles, len(colors))
    particles.color[:] = colors
    particles.velocity[:] = -1.0
    return particles


def test_particles_of_the_color_are_moved_in_the_step_in_which_their_time_falls(insertions):
    rows, particles = insertions(), waiting(0.0, 2.0, 1.0, 2.0)
    assert rows.apply([particles], 0.2, 0.1) == 2
    np.testing.assert_array_equal(particles.position, [[0, 0, 0], [1, 2, 3], [0, 0, 0], [1, 2, 3]])
    np.testing.assert_array_equal(particles.velocity, [[-1] * 3, [4, 5, 6], [-1] * 3, [4, 5, 6]])
    np.testing.assert_array_equal(particles.displacement, 0.0)


@pytest.mark.parametrize(
    ("time", "dt", "moved"), [(0.25, 0.1, 1), (0.15, 0.1, 0), (0.0, 0.1, 0), (0.3, 0.1, 0)]
)
def test_a_time_belongs_to_the_step_that_starts_with_it(insertions, time, dt, moved):
    assert insertions().apply([waiting(2.0)], time, dt) == moved


def test_all_materials_are_searched_and_rows_of_one_step_add_up(insertions):
    rows = insertions("0.1 7 1 0 0 1 0 0\n0.2 7 0 1 0 0 1 0\n")
    first, second = waiting(7.0), waiting(3.0, 7.0)
    assert rows.apply([first, second], 0.0, 1.0) == 4
    np.testing.assert_array_equal(first.position, [[1.0, 1.0, 0.0]])
    np.testing.assert_array_equal(second.position, [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]])
    np.testing.assert_array_equal(second.velocity[1], [0.0, 1.0, 0.0])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0 1 0 0 0 1 0 0\n0 1 0 0 0 1 0\n", "insert.dat:2: expected 8 numbers"),
        ("time color dx dy dz vx vy vz\n0 1 0 0 0 1 0 0\n", "insert.dat:1: expected 8 numbers"),
        ("\n", "insert.dat: no line of 8 numbers"),
    ],
)
def test_wrong_files_are_named_with_their_line(insertions, text, words):
    with pytest.raises(ValueError, match=words):
        insertions(text)
