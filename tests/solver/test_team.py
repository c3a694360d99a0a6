"""Threads share the work of a step, and change nothing of its results."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest
from mpm_cases import advance, fill, make_body, make_grid, make_particles, make_simulation

from solver import team
from solver.interpolation.bspline import BSpline
from solver.interpolation.cpdi import Cpdi
from solver.interpolation.cpti import Cpti
from solver.interpolation.gimp import Gimp, GimpAxisymmetric
from solver.interpolation.linear import Linear
from solver.kernels import chunks
from solver.team import Team, node_blocks

SPACE = make_grid((9, 8, 7), (0.5, 0.25, 0.4), (-1.0, 2.0, 0.5))
BARE = make_grid((9, 8, 7), (0.5, 0.25, 0.4), (-1.0, 2.0, 0.5), extra=(0, 0, 0))
DISK = make_grid((9, 8, 1), (0.5, 0.25, 0.4), (0.0, 2.0, 0.0), extra=(1, 1, 0))
DT = 0.01


def block_of(grid, per_cell=(2, 2, 2)):
    """Particles with random velocities that fill the inside of a grid."""
    low, high = np.array(grid.anchor), np.array(grid.upper)
    inset = np.array(grid.spacing) * (np.array(grid.cells) > 1)
    particles = make_particles(grid, fill(low + inset, high - inset, grid.spacing, per_cell), per_cell)
    random = np.random.default_rng(4)
    particles.velocity[:] = random.normal(size=particles.velocity.shape)
    particles.deformation_gradient[:] += random.uniform(-0.1, 0.1, particles.deformation_gradient.shape)
    stress = random.normal(size=particles.stress.shape)
    particles.stress[:] = stress + stress.transpose(0, 2, 1)
    return particles


CASES = {
    "gimp": (Gimp(), SPACE, {}),
    "gimp-xpic": (Gimp(), SPACE, {"XPIC2": True}),
    "linear": (Linear(), BARE, {}),
    "spline": (BSpline(), SPACE, {}),
    "cpdi": (Cpdi(), SPACE, {}),
    "cpti": (Cpti(), SPACE, {}),
    "axisymmetric": (GimpAxisymmetric(), DISK, {"axisymmetric": True}),
}


@pytest.mark.parametrize("name", CASES)
def test_results_do_not_depend_on_the_number_of_threads(name, monkeypatch):
    """Bit for bit, with more threads than there are rows of nodes, too."""
    monkeypatch.setattr(team, "LEAST_PARTICLES", 1)
    interpolator, grid, flags = CASES[name]
    results = []
    for threads in (1, 2, 3, 16):
        per_cell = (2, 2, 1) if grid is DISK else (2, 2, 2)
        body = make_body(block_of(grid, per_cell))
        assert len(body.particles) > 1.5 * chunks.CHUNK or grid is DISK
        simulation = make_simulation(grid, [body], interpolator, flags=flags, team=Team(threads))
        advance(simulation, DT, 3)
        results.append((body.particles, dict(simulation.reductions), simulation.nodal))
    for particles, reductions, nodal in results[1:]:
        for field, one, other in zip(particles._fields, results[0][0], particles, strict=True):
            np.testing.assert_array_equal(one, other, err_msg=field)
        for one, other in zip(results[0][2], nodal, strict=True):
            np.testing.assert_array_equal(one, other)
        assert all(np.array_equal(value, reductions[key]) for key, value in results[0][1].items())


def test_blocks_divide_the_nodes_and_the_particles_evenly():
    random = np.random.default_rng(0)
    corner = random.uniform((-1.0, 2.0, 0.5), (0.0, 2.5, 3.0), (1000, 3))
    blocks = node_blocks(SPACE, corner, 3)
    covered = np.zeros(SPACE.index.nodes, dtype=int)
    shares = []
    for block in blocks:
        box = tuple(slice(low, high) for low, high in zip(block.low, block.high, strict=True))
        covered[box] += 1
        node = np.floor((corner - SPACE.anchor) / SPACE.spacing).astype(int) + 1
        shares.append(((node >= block.low) & (node < block.high)).all(axis=1).mean())
    assert (covered == 1).all()
    assert min(shares) > 1 / 3 - 1 / 6  # a cell along z holds a sixth of them


def test_rows_of_nodes_are_never_divided():
    """A row lies along x; threads that added to parts of one would be in each other's way."""
    along_x = np.random.default_rng(0).uniform((-1.0, 2.0, 0.5), (3.5, 2.1, 0.6), (100, 3))
    for block in node_blocks(SPACE, along_x, 4):
        assert (block.low[0], block.high[0]) == (0, SPACE.index.nodes[0])


def test_few_particles_are_left_to_one_thread():
    assert Team(8).size_for(10) == 1
    assert Team(8).size_for(3 * team.LEAST_PARTICLES) == 3
    assert Team(2).size_for(10**6) == 2
    with pytest.raises(ValueError, match="at least 1"):
        Team(0)


def test_shares_are_whole_and_run_in_several_threads():
    seen = {}
    together = threading.Barrier(3, timeout=30)

    def note(first, last):
        together.wait()
        seen[first, last] = threading.get_ident()

    Team(3).share(10, 3, note)
    assert sorted(seen) == [(0, 3), (3, 6), (6, 10)]
    assert len(set(seen.values())) == 3


def test_a_fault_in_a_thread_is_raised_where_it_was_started():
    def fail(first, last):
        if first:
            raise RuntimeError("no")

    with pytest.raises(RuntimeError, match="no"):
        Team(2).share(10, 2, fail)


def test_a_task_that_raises_is_told_once_all_have_ended():
    """Nobody still writes to arrays that the caller then looks at."""
    begun, ended = threading.Event(), threading.Event()

    def fails():
        begun.wait(10.0)
        raise ValueError("the first")

    def works():
        begun.set()
        time.sleep(0.2)
        ended.set()

    with pytest.raises(ValueError, match="the first"):
        Team(2).run([fails, works])
    assert ended.is_set()
