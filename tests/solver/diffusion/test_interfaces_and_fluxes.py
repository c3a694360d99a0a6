"""What passes between materials, and through their surfaces."""

from __future__ import annotations

import numpy as np
import pytest
from diffusion_cases import LENGTH, D, creation, nodal_profile, profile, run, slab
from mpm_cases import fill, make_body, make_grid, make_particles, make_simulation

from solver.diffusion.diffusion import Diffusion, new_solute
from solver.diffusion.fick import Fick
from solver.diffusion.interface.common import CommonInterface
from solver.diffusion.interface.null import NullInterface
from solver.diffusion.interface.simple import SimpleInterface
from solver.geometry.box import Box
from solver.geometry.cylinder import Cylinder
from solver.geometry.sphere import Sphere
from solver.loads.curve import LoadCurve, TimePoint
from solver.loads.scalar_flux import ScalarFlux
from solver.loads.surface import LoadedSurface

FICK = Fick(D, 10.0)
HALVES = ((0.0, 0.5), (0.5, 1.0))


def step(x):
    return np.where(x < 0.5, 1.0, 0.0)


def test_common_materials_are_as_one():
    whole = slab(FICK, 20, step)
    parts = slab(FICK, 20, step, parts=HALVES, interfaces=[CommonInterface()])
    for simulation in (whole, parts):
        run(simulation, 40.0)
    (x, c), (y, d) = profile(whole), profile(parts)
    np.testing.assert_allclose(d[np.argsort(y, kind="stable")], c[np.argsort(x, kind="stable")], atol=2e-12)


def test_nothing_passes_a_null_interface():
    for interfaces in ([], [NullInterface()]):
        simulation = slab(FICK, 20, step, parts=HALVES, interfaces=interfaces)
        run(simulation, 40.0)
        x, c = profile(simulation)
        np.testing.assert_allclose(c, step(x), atol=1e-14)


def test_the_simple_interface_mixes_and_keeps_the_substance():
    simulation = slab(FICK, 20, step, parts=HALVES, interfaces=[SimpleInterface()])
    before = profile(simulation)[1].sum()
    simulation.advance(1e-3)
    (left, right), (mass_left, mass_right) = simulation.diffusion.nodal.star, simulation.nodal.mass
    shared = (mass_left > 1e-100) & (mass_right > 1e-100)
    np.testing.assert_allclose(left[shared], right[shared], rtol=1e-12)
    run(simulation, 400.0)
    x, c = profile(simulation)
    assert c.sum() == pytest.approx(before, rel=1e-12)
    assert c[x < 0.45].max() - c[x > 0.55].min() < 0.1


def test_only_listed_materials_exchange():
    thirds = ((0.0, 0.4), (0.4, 0.7), (0.7, 1.0))
    simulation = slab(
        FICK, 20, lambda x: np.where(x < 0.4, 1.0, 0.0), parts=thirds, interfaces=[CommonInterface((0, 1))]
    )
    run(simulation, 100.0)
    last = simulation.bodies[2].solute.concentration
    assert simulation.bodies[1].solute.concentration.min() > 0.01
    np.testing.assert_allclose(last, 0.0, atol=1e-99)


def test_a_material_that_does_not_exist():
    with pytest.raises(ValueError, match="lists 3"):
        CommonInterface((0, 3)).check(2)


# ---- fluxes ------------------------------------------------------------------------------------------------


def flux(piece, load, curve=1):
    points = (TimePoint(time=0.0, load=load), TimePoint(time=1.0e3, load=load))
    return ScalarFlux(geom_object=LoadedSurface(piece), load_curve=LoadCurve(id=curve, time_point=points))


def test_a_flux_through_a_face_fills_a_slab_as_it_must():
    # long after the start: c = q t / L + q L / D ((3 y^2 - L^2) / (6 L^2)), y from the closed end
    q, time, h = 2.0e-4, 600.0, LENGTH / 20
    face = Box(min=(-1e-4, 0.0, 0.0), max=(1e-4, h, h))
    simulation = slab(FICK, 20, fluxes=[flux(face, q)])
    run(simulation, time)
    assert profile(simulation)[1].mean() == pytest.approx(q * time / LENGTH, rel=1e-10)
    x, c = nodal_profile(simulation)
    y = LENGTH - x
    expected = q * time / LENGTH + q * LENGTH / D * (3 * y**2 - LENGTH**2) / (6 * LENGTH**2)
    np.testing.assert_allclose(c, expected, atol=2e-3)


def filled(piece, load):
    """A block of 8^3 cells that holds the piece, all of whose particles may carry loads."""
    grid = make_grid((8, 8, 8), (0.25, 0.25, 0.25), (-1.0, -1.0, -1.0), (0, 0, 0))
    where = fill((-1.0,) * 3, (1.0,) * 3, (0.25,) * 3, (2, 2, 2))
    where = where[piece.inside(where)]
    particles = make_particles(grid, where)
    near = load.near(where, (0.125,) * 3)
    outermost = np.zeros(len(where), bool)
    for axis in range(3):
        for side in (-0.125, 0.125):
            moved = where.copy()
            moved[:, axis] += side
            outermost |= ~piece.inside(moved)
    particles.load_curve[near & outermost, 0] = load.load_curve.id
    body = make_body(particles)
    body.solute = new_solute(creation(particles), FICK, grid)
    simulation = make_simulation(grid, [body])
    simulation.diffusion = Diffusion([FICK], (), [load])
    simulation.diffusion.attach(simulation)
    simulation.advance(1e-3)
    return body


BALL = Sphere(origin=(0.0, 0.0, 0.0), radius=0.9)
ROD = Cylinder(bottom=(0.0, 0.0, -1.0), top=(0.0, 0.0, 1.0), radius=0.9)
END = Cylinder(bottom=(0.0, 0.0, -1.0), top=(0.0, 0.0, -0.99), radius=0.9, cylinder_end=True)


@pytest.mark.parametrize(
    ("body", "surface", "area"),
    [
        (BALL, BALL, 4 * np.pi * 0.9**2),
        (ROD, ROD, 2 * np.pi * 0.9 * 2),
        (ROD, END, np.pi * 0.81),
    ],
)
def test_curved_surfaces_take_about_their_area(body, surface, area):
    made = filled(body, flux(surface, 0.5))
    taken = (made.solute.external_rate * made.particles.volume).sum() / 0.5
    assert taken == pytest.approx(area, rel=0.3)  # made of steps


def test_an_edge_takes_both_fluxes():
    grid = make_grid((2, 2, 1), (0.5, 0.25, 1.0), extra=(0, 0, 0))
    where = fill((0.0, 0.0, 0.0), (1.0, 0.5, 1.0), (0.5, 0.25, 1.0), (2, 2, 1))
    right = flux(Box(min=(0.999, 0.0, 0.0), max=(1.001, 0.5, 1.0)), 3.0, 1)
    top = flux(Box(min=(0.0, 0.499, 0.0), max=(1.0, 0.501, 1.0)), 5.0, 2)
    particles = make_particles(grid, where, (2, 2, 1))
    for place, load in enumerate((right, top)):
        particles.load_curve[load.near(where, (0.25, 0.125, 1.0)), place] = load.load_curve.id
    body = make_body(particles)
    body.solute = new_solute(creation(particles), FICK, grid)
    diffusion = Diffusion([FICK], (), [right, top])
    diffusion._soak(body, 0.0)
    corner = int(np.argmax(where[:, :2].sum(axis=1)))
    expected = (3.0 * 0.125 + 5.0 * 0.25) / (0.25 * 0.125)
    assert body.solute.external_rate[corner] == pytest.approx(expected)
    inside = int(np.argmin(where[:, :2].sum(axis=1)))
    assert body.solute.external_rate[inside] == 0.0
