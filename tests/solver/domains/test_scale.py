"""The model of scale, against what a run sends."""

from __future__ import annotations

import numpy as np
import pytest
from mpm_cases import fill, make_body, make_grid, make_particles, make_simulation
from thread_ranks import on_ranks

from solver.domains.decomposition import Domain
from solver.domains.exchange import ManyRanks
from solver.domains.scale import REDUCTIONS, cost, shared_nodes
from solver.interpolation.linear import Linear
from solver.kernels.transfer import CHANNELS

PERIODIC = {"periodic": (1, 1, 1), "extra": (0, 0, 0)}
CELLS = (15, 15, 15)


def bytes_a_particle(body) -> int:
    return sum(array[:1].nbytes for record in body.records for array in record)


def sent_in_steps(steps: int, speed: float, everywhere: bool = False, interpolator=None):
    """Messages and reductions of each of 27 ranks of a periodic block in some steps, and the bytes of a particle.

    ``everywhere``: all nodes take part, whether particles touch them or not.
    """
    grid = make_grid(CELLS, **PERIODIC)
    corners = [tuple(5 * i for i in place) for place in np.ndindex(3, 3, 3)]
    domains = [Domain(low, tuple(i + 5 for i in low)) for low in corners]

    def run(communicator):
        exchange = ManyRanks(communicator, grid, domains, 1)
        low, high = exchange.grid.own_cells
        body = make_body(make_particles(grid, fill(low, high, grid.spacing, (2, 2, 2))))
        body.particles.velocity[:, 0] = speed
        simulation = make_simulation(exchange.grid, [body], interpolator, exchange=exchange)
        simulation.whole_grid = everywhere
        simulation.balance()  # the ranks agree on the reach once at the start
        communicator.sent.clear()
        communicator.reductions = 0
        for _ in range(steps):
            simulation.advance(0.01)
        return communicator.sent, communicator.reductions, bytes_a_particle(body)

    return on_ranks(len(domains), run)


def test_bytes_and_messages_are_those_of_the_model():
    steps = 2
    found = sent_in_steps(steps, speed=0.0, everywhere=True)
    expected = cost((5, 5, 5), 1, [CHANNELS], found[0][2], leavers=0.0)
    assert expected.neighbours == 26
    for sent, reductions, _ in found:
        assert len(sent) == steps * expected.messages
        assert sum(n for kind, n in sent if kind == "halo") == steps * expected.halo_bytes
        assert sum(n for kind, n in sent if kind == "particles") == steps * expected.particle_bytes
        assert reductions == steps * (REDUCTIONS - 1)  # the third is the run's


def test_rows_of_nodes_that_no_particle_touches_are_not_sent():
    """Linear weights touch the 6 x 6 x 6 nodes of a rank's cells: 2 deep are those that a neighbour stores too."""
    found = sent_in_steps(1, speed=0.0, interpolator=Linear())
    sides = [np.count_nonzero(side) for side in np.array(list(np.ndindex(3, 3, 3))) - 1 if side.any()]
    nodes = sum(2**n * 6 ** (3 - n) for n in sides)
    for sent, _, _ in found:
        assert sum(n for kind, n in sent if kind == "halo") == 8 * (nodes * (1 + CHANNELS) + 26)


def test_particles_that_leave_are_sent_once():
    found = sent_in_steps(
        1, speed=30.0
    )  # 0.3 of a cell: of 25 cells at the cut the layer of 2 x 2 at 0.25 from it
    expected = cost((5, 5, 5), 1, [CHANNELS], found[0][2], leavers=4 * 25)
    assert sum(n for kind, n in found[0][0] if kind == "particles") == expected.particle_bytes


@pytest.mark.parametrize(
    ("cells", "layers", "directions"), [((6, 5, 4), 1, (1, 1, 1)), ((8, 3, 1), 1, (1, 0, 0))]
)
def test_shared_nodes_are_those_of_the_boxes(cells, layers, directions):
    """Counted box by box: the overlap of windows of equal domains beside each other."""
    window = [n + 1 + 2 * layers for n in cells]
    total = 0
    for sides in np.ndindex(3, 3, 3):
        shift = [(s - 1) * n for s, n in zip(sides, cells, strict=True)]
        if not any(shift) or any(s != 1 and not d for s, d in zip(sides, directions, strict=True)):
            continue
        total += np.prod([w - abs(s) for w, s in zip(window, shift, strict=True)])
    assert shared_nodes(cells, layers, directions) == total


def test_a_rank_inside_sends_in_proportion_to_its_surface():
    small, large = (shared_nodes((n, n, n), 1, (1, 1, 1)) for n in (32, 64))
    assert 3.3 < large / small < 4.0
