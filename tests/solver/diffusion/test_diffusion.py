"""Diffusion against closed forms, with the rates of convergence that it declares."""

from __future__ import annotations

import numpy as np
import pytest
from diffusion_cases import LENGTH, D, creation, nodal_profile, profile, rate_of_convergence, run, slab
from mpm_cases import fill, make_body, make_grid, make_particles, make_simulation, whole_side
from scipy.special import erfc, j0, jn_zeros

from solver.diffusion.constant_rate import ConstantRate
from solver.diffusion.diffusion import Diffusion, new_solute
from solver.diffusion.fick import Fick
from solver.diffusion.non_linear import FluxCurve, FluxTime, NonLinearDiffusion
from solver.diffusion.stress_driven import StressDrivenDiffusion
from solver.interpolation.gimp import Gimp
from solver.interpolation.linear import Linear, LinearAxisymmetric

FICK = Fick(D, 10.0)


def cosine(x, time=0.0):
    return 0.5 + 0.4 * np.cos(np.pi * x / LENGTH) * np.exp(-D * (np.pi / LENGTH) ** 2 * time)


@pytest.mark.parametrize("interpolator", [Linear(), Gimp()])
def test_a_wave_in_a_closed_box_fades_with_the_rate_of_fourier(interpolator):
    sizes, errors, time = (8, 16, 32), [], 60.0
    for cells in sizes:
        simulation = slab(FICK, cells, cosine, interpolator)
        run(simulation, time, share=0.2)
        x, c = profile(simulation)
        errors.append(np.abs(c - cosine(x, time)).max())
    assert errors[-1] < 2e-3
    assert rate_of_convergence(errors, sizes) > 1.7


@pytest.mark.parametrize("interpolator", [Linear(), Gimp()])
def test_nothing_is_lost(interpolator):
    simulation = slab(FICK, 10, lambda x: np.where(x < 0.3, 1.0, 0.0), interpolator)
    before = simulation.bodies[0].solute.concentration.sum()
    run(simulation, 50.0)
    assert simulation.bodies[0].solute.concentration.sum() == pytest.approx(before, rel=1e-12)
    assert simulation.reductions["TotalConc", -1] == pytest.approx(before, rel=1e-12)


def test_a_surface_at_a_given_concentration():
    sizes, errors, time = (20, 40, 80), [], 10.0
    for cells in sizes:
        simulation = slab(FICK, cells, regions=[whole_side("x-", "SD-Type", "Dirichlet", 1.0)])
        run(simulation, time, share=0.2)
        x, c = nodal_profile(simulation)
        errors.append(np.abs(c - erfc(x / np.sqrt(4 * D * time))).max())
    assert errors[-1] < 2e-3
    assert rate_of_convergence(errors, sizes) > 0.9


def test_a_plate_between_two_concentrations_follows_its_series():
    regions = [
        whole_side("x-", "SD-Type", "Dirichlet", 1.0),
        whole_side("x+", "SD-Type", "Dirichlet", 0.0),
    ]
    simulation, time = slab(FICK, 40, regions=regions), 80.0
    run(simulation, time)
    x, c = nodal_profile(simulation)
    n = np.arange(1, 60)[:, None]
    fading = np.exp(-D * (n * np.pi) ** 2 * time) * np.sin(n * np.pi * x) * 2 / (n * np.pi)
    np.testing.assert_allclose(c, 1 - x - fading.sum(axis=0), atol=2e-3)


def test_a_gradient_at_a_face():
    # c = 1 at the left, a slope of -0.5 (inwards) at the right: straight in the end
    regions = [
        whole_side("x-", "SD-Type", "Dirichlet", 1.0),
        whole_side("x+", "SD-Type", "Neumann", 0.5),
    ]
    simulation = slab(FICK, 10, 0.7, Linear(), regions)
    run(simulation, 1500.0)
    x, c = nodal_profile(simulation)
    np.testing.assert_allclose(c, 1 - 0.5 * x, atol=1e-3)


def test_a_wave_in_a_round_rod_fades_with_the_rate_of_bessel():
    # J0(k r) exp(-D k^2 t) with J1(k R) = 0: nothing passes the side
    cells, time = 24, 40.0
    k, h = jn_zeros(1, 1)[0] / LENGTH, LENGTH / cells
    grid = make_grid((cells, 1, 1), (h, h, 1.0), extra=(0, 0, 0))
    where = fill((0.0, 0.0, 0.0), (LENGTH, h, 1.0), (h, h, 1.0), (2, 2, 1))
    particles = make_particles(grid, where, (2, 2, 1))
    particles.volume[:] *= where[:, 0]
    particles.mass[:] *= where[:, 0]
    body = make_body(particles)
    body.solute = new_solute(creation(particles, 0.5 + 0.4 * j0(k * where[:, 0])), FICK, grid)
    simulation = make_simulation(grid, [body], LinearAxisymmetric(), flags={"axisymmetric": True})
    simulation.diffusion = Diffusion([FICK])
    simulation.diffusion.attach(simulation)
    before = (particles.mass * body.solute.concentration).sum()
    run(simulation, time, share=0.2)
    expected = 0.5 + 0.4 * j0(k * where[:, 0]) * np.exp(-D * k**2 * time)
    np.testing.assert_allclose(body.solute.concentration, expected, atol=4e-3)
    assert (particles.mass * body.solute.concentration).sum() == pytest.approx(before, rel=1e-12)
    assert not body.solute.gradient[:, 2].any()


def test_the_concentration_stays_within_its_bounds():
    law = Fick(D, 0.8, min_concentration=0.1)
    simulation = slab(law, 10, 0.5, regions=[whole_side("x-", "SD-Type", "Dirichlet", 5.0)])
    run(simulation, 30.0)
    assert simulation.bodies[0].solute.concentration.max() == pytest.approx(0.8)
    simulation = slab(law, 10, 0.5, regions=[whole_side("x-", "SD-Type", "Dirichlet", -5.0)])
    run(simulation, 30.0)
    assert simulation.bodies[0].solute.concentration.min() == pytest.approx(0.1)


def test_constant_rate():
    simulation = slab(ConstantRate(0.02, D, 10.0), 6, 0.1)
    run(simulation, 20.0)
    np.testing.assert_allclose(profile(simulation)[1], 0.1 + 0.4, rtol=1e-12)


@pytest.mark.parametrize("tuning", [0.0, 2.0])
def test_a_diffusivity_that_grows_bends_the_steady_profile(tuning):
    # D exp(a c) c' = const, so that exp(a c) is straight between the ends
    law = NonLinearDiffusion(D, 10.0, False, tuning, 0.0)
    ends = [whole_side("x-", "SD-Type", "Dirichlet", 1.0), whole_side("x+", "SD-Type", "Dirichlet", 0.0)]
    simulation = slab(law, 16, lambda x: 1 - x, regions=ends)
    for _ in range(1500):
        simulation.advance(0.4 * simulation.diffusion.limit(0.0))
    x, c = nodal_profile(simulation)
    expected = 1 - x if tuning == 0 else np.log(np.exp(tuning) + (1 - np.exp(tuning)) * x) / tuning
    np.testing.assert_allclose(c[:-2], expected[:-2], atol=6e-3)
    np.testing.assert_allclose(c, expected, atol=0.04)  # where the profile falls within a cell
    largest = simulation.bodies[0].solute.diffusivity.max()
    assert simulation.diffusion.limit(0.0) == pytest.approx((LENGTH / 16) ** 2 / (2 * largest))


def test_pressure_slows_diffusion():
    law = NonLinearDiffusion(D, 10.0, True, 1.5, 0.7, 0.0, 3.0, 1e-6)
    simulation = slab(law, 4, 0.2)
    simulation.advance(1e-9)
    for pressure, scaled in ((-5e6, 0.0), (2e6, 2.0), (9e6, 3.0)):
        simulation.bodies[0].particles.stress[:] = -pressure * np.eye(3)
        simulation.diffusion.advance(simulation, 1e-9)
        found = simulation.bodies[0].solute.diffusivity
        np.testing.assert_allclose(found, D * np.exp(1.5 * 0.2) * np.exp(-0.7 * scaled), rtol=1e-9)


def test_outwards_the_diffusivity_stays():
    curve = FluxCurve((FluxTime(0.0, "in"), FluxTime(10.0, "out"), FluxTime(20.0, "transition")))
    law = NonLinearDiffusion(D, 10.0, False, 1.0, 0.0, diff_curve=curve)
    simulation = slab(law, 4, 0.5)
    simulation.advance(1e-9)
    solute = simulation.bodies[0].solute
    grown = solute.diffusivity.copy()
    solute.concentration[:] = 0.9
    simulation.time = 15.0
    simulation.diffusion.advance(simulation, 1e-9)
    np.testing.assert_array_equal(solute.diffusivity, grown)
    simulation.time = 25.0
    simulation.diffusion.advance(simulation, 1e-9)
    np.testing.assert_allclose(solute.diffusivity, D * np.exp(solute.concentration))


def test_a_stress_gradient_holds_an_uneven_equilibrium():
    # c / (1 - c) = A exp(Omega sigma / k T)
    law = StressDrivenDiffusion(D, 1.0, partial_atomic_vol=3.0, boltzmann_const=1.0, operating_temp=2.0)
    simulation = slab(law, 20, 0.4)
    particles, solute = simulation.bodies[0].particles, simulation.bodies[0].solute
    simulation.advance(1e-9)
    particles.stress[:] = particles.position[:, 0, None, None] * np.eye(3)
    for _ in range(4000):
        simulation.diffusion.advance(simulation, 0.4 * simulation.diffusion.limit(0.0))
    x, c = particles.position[:, 0], solute.concentration
    level = np.log(c / (1 - c)) - 1.5 * x
    inside = (x > 0.1) & (x < 0.9)
    assert np.ptp(level[inside]) < 0.02
    assert c.mean() == pytest.approx(0.4, rel=1e-9)


def test_flux_and_gradient_on_particles():
    simulation = slab(FICK, 10, lambda x: 0.2 + 0.6 * x)
    simulation.advance(1e-6)
    simulation.advance(1e-6)
    solute = simulation.bodies[0].solute
    inside = np.abs(simulation.bodies[0].particles.position[:, 0] - 0.5) < 0.35
    np.testing.assert_allclose(solute.gradient[inside], [[0.6, 0, 0]] * inside.sum(), atol=1e-6)
    np.testing.assert_allclose(solute.flux, D * solute.gradient, rtol=1e-4, atol=1e-9)


def test_a_body_that_is_not_active_does_not_change():
    simulation = slab(FICK, 10, lambda x: x)
    simulation.bodies[0].activation_time = 1e9
    before = simulation.bodies[0].solute.concentration.copy()
    simulation.advance(1.0)
    np.testing.assert_array_equal(simulation.bodies[0].solute.concentration, before)
