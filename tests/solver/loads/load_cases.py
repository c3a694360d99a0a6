"""Bodies and loads that the tests of this folder share."""

from __future__ import annotations

import numpy as np

from solver.creation import Creation, GeometryObject, ParticleIds, create_particles
from solver.grid import Grid, Patch
from solver.loads.curve import LoadCurve, TimePoint
from solver.loads.loads import Loads
from solver.materials.constitutive import Material

STEEL = Material(7800.0, 460.0, 460.0, 45.0, 294.0, 1800.0, 0.0)


def make_grid(cells=(10, 10, 10), spacing=(0.1, 0.1, 0.1), anchor=(0.0, 0.0, 0.0)):
    return Grid(anchor, spacing, cells, (1, 1, 1), (0, 0, 0), (Patch(0, (0, 0, 0), cells),))


def body(piece, grid, res=(2, 2, 2), axisymmetric=False) -> Creation:
    shape = GeometryObject(pieces=(piece,), res=res, velocity=(0.0, 0.0, 0.0), temperature=300.0)
    return create_particles(
        [shape], grid, STEEL, ParticleIds(grid), axisymmetric=axisymmetric, find_surface=True
    )


def curve(load=1.0, number=1, **more):
    """A curve of the same load at all times."""
    return LoadCurve(number, (TimePoint(0.0, load), TimePoint(1.0, load)), **more)


def applied(loads, grid, *creations, time=0.0, **options):
    """The loads after they were prepared for bodies and applied once."""
    acting = Loads(loads, grid, **options)
    acting.prepare(creations)
    acting.apply(time, [creation.particles for creation in creations])
    return acting


def carriers(creation, number=1):
    return (creation.particles.load_curve == number).any(axis=1)


def total_force(creation):
    return creation.particles.external_force.sum(axis=0)


def total_moment(creation, about=(0.0, 0.0, 0.0)):
    particles = creation.particles
    return np.cross(particles.position - np.array(about), particles.external_force).sum(axis=0)
