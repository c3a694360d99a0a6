"""How far particles reach, by the nodes that their shape functions touch."""

from __future__ import annotations

import numpy as np
import pytest
from mpm_cases import make_body
from shape_cases import PLANE, Rows, sample_deformations

from solver.domains.reach import farthest_reach, layers_reached
from solver.grid import Grid, Patch
from solver.interpolation.bspline import BSpline
from solver.interpolation.cpdi import Cpdi, CpdiAxisymmetric
from solver.interpolation.cpti import Cpti
from solver.interpolation.gimp import Gimp, GimpAxisymmetric
from solver.interpolation.linear import Linear, LinearAxisymmetric
from solver.materials.nonlocal_drucker_prager import NonlocalDruckerPrager
from solver.particles import Particles, new_arrays

CELLS = (14, 14, 14)
BOX = Grid((-1.0, 2.0, 0.5), (0.5, 0.25, 1.0), CELLS, (1, 1, 1), (0, 0, 0), (Patch(0, (0, 0, 0), CELLS),))
COUNT = 40


def body_of(grid, stretch, model=None):
    """Particles in the middle of a grid, all of one size of a cell, by ``stretch`` more and deformed."""
    particles = new_arrays(Particles, COUNT)
    away = np.minimum(5.5, 0.4 * np.array(grid.cells)) * np.array(grid.spacing)
    low, high = np.array(grid.anchor) + away, np.array(grid.upper) - away
    particles.position[:] = np.random.default_rng(2).uniform(low, high, (COUNT, 3))
    particles.size[:] = 0.6 * np.eye(3)
    particles.deformation_gradient[:] = stretch * sample_deformations(COUNT, strength=0.2)
    if grid is PLANE:
        particles.deformation_gradient[:, 2, :2] = particles.deformation_gradient[:, :2, 2] = 0.0
    return make_body(particles, model=model)


@pytest.mark.parametrize(
    ("interpolator", "grid", "stretch", "layers"),
    [
        (Linear(), BOX, 3.0, 0),
        (LinearAxisymmetric(), PLANE, 3.0, 0),
        (Gimp(), BOX, 3.0, 1),
        (GimpAxisymmetric(), PLANE, 3.0, 1),
        (BSpline(), BOX, 3.0, 1),
        (Cpdi(), BOX, 1.0, 1),
        (Cpdi(), BOX, 4.0, 2),
        (Cpdi(1.0), BOX, 4.0, 1),
        (CpdiAxisymmetric(), PLANE, 1.0, 1),
        (Cpti(), BOX, 1.0, 1),
        (Cpti(), BOX, 2.5, 2),
    ],
)
def test_all_nodes_of_a_particle_lie_in_its_cell_and_so_many_layers_around(
    interpolator, grid, stretch, layers
):
    body = body_of(grid, stretch)
    p = body.particles
    assert layers_reached(interpolator, [body], grid.spacing, on_corners=False) == layers
    rows = Rows(interpolator, grid, p.position, p.size, p.deformation_gradient, compiled=True)
    nodes, cells = grid.node_positions(), grid.cell_of(p.position)
    far = farthest_reach(interpolator, p.deformation_gradient, p.size)
    for n in range(COUNT):
        touched, weights, _ = rows.used(n)
        places = nodes[touched[weights != 0.0]]
        assert (np.abs(places - p.position[n]) <= (far + 1e-12) * np.array(grid.spacing)).all()
        index = np.round((places - np.array(grid.anchor)) / np.array(grid.spacing))
        assert ((index >= cells[n] - layers) & (index <= cells[n] + 1 + layers)).all()


def test_loads_on_corners_reach_as_far_as_these():
    body = body_of(BOX, 4.0)
    assert layers_reached(Linear(), [body], BOX.spacing, on_corners=True) == 2


@pytest.mark.parametrize(("length", "layers"), [(0.2, 1), (0.3, 2), (0.51, 3)])
def test_a_model_that_looks_around_reaches_as_far_as_it_looks(length, layers):
    """In cells of the least side, 0.25."""
    model = NonlocalDruckerPrager(0.1, 0.1, 1.0, 10.0, 5.0, l_nonlocal=length, h_nonlocal=-1.0)
    body = body_of(BOX, 1.0, model)
    assert layers_reached(Linear(), [body], BOX.spacing, on_corners=False) == layers
    idle = body_of(BOX, 1.0, model._replace(h_nonlocal=0.0))
    assert layers_reached(Linear(), [idle], BOX.spacing, on_corners=False) == 0


def test_a_rank_without_particles_reaches_no_layer():
    body = body_of(BOX, 1.0)
    body.keep(np.zeros(COUNT, bool))
    assert layers_reached(Cpdi(), [body], BOX.spacing, on_corners=True) == 0
