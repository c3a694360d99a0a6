"""Arenisca3 and Arenisca4 against closed forms, plain references and numbers of sus."""

from __future__ import annotations

import numpy as np
import pytest
from point_driver import (
    MATERIAL,
    Driver,
    assert_kernel_agrees,
    assert_turns_with_the_path,
    compiled_update,
    sample_path,
)
from scipy.optimize import brentq

from solver.declare import fields
from solver.materials.arenisca.elasticity import moduli, pores_of
from solver.materials.arenisca.hardening import back_stress_slope, cap_position, pore_pressure
from solver.materials.arenisca.update import weibull_law
from solver.materials.arenisca3 import Arenisca3
from solver.materials.arenisca4 import Arenisca4, lode_factor
from solver.materials.constitutive import DELETE, Step, initial_sound_speed, initialize, state_record
from solver.particles import Particles, new_arrays, state_variables

K, G = 10000.0, 3750.0
CONSTANTS = {
    "PEAKI1": 600.0,
    "FSLOPE": 0.2,
    "STREN": 0.0,
    "YSLOPE": 0.0,
    "BETA_nonassociativity": 1.0,
    "B0": K,
    "B1": 0.0,
    "B2": 0.0,
    "B3": 0.0,
    "B4": 0.0,
    "G0": G,
    "G1": 0.0,
    "G2": 0.0,
    "G3": 0.0,
    "G4": 0.0,
    "p0_crush_curve": -1800.0,
    "p1_crush_curve": 6.0e-4,
    "p2_crush_curve": 0.0,
    "p3_crush_curve": 0.5,
    "CR": 0.5,
    "fluid_B0": 0.0,
    "fluid_pressure_initial": 0.0,
    "T1_rate_dependence": 0.0,
    "T2_rate_dependence": 0.0,
}
RICH = {
    "STREN": 250.0,
    "YSLOPE": 0.05,
    "B1": 6000.0,
    "B2": 500.0,
    "B3": 2000.0,
    "B4": 0.02,
    "fluid_B0": 3000.0,
    "fluid_pressure_initial": 30.0,
    "T1_rate_dependence": 0.05,
    "T2_rate_dependence": 0.3,
}
SOLID = {"p0_crush_curve": -1e99, "p1_crush_curve": -1e99}
ROCK = MATERIAL._replace(density=1050.0)
TRESCA = 2 / np.sqrt(3) * np.cos(np.arcsin(-0.5 * 0.7) / 3)
"""The factor of Mohr and Coulomb without friction, for J2 = 3 and J3 = 0.7."""
MODELS = (Arenisca3, Arenisca4)


def rock(kind=Arenisca3, **changes):
    return kind(**{name: float(value) for name, value in CONSTANTS.items()})._replace(**changes)


def invariants(stress):
    s = stress - np.trace(stress) / 3 * np.eye(3)
    return np.trace(stress), np.sqrt((s * s).sum() / 2), np.linalg.det(s)


# ---- elasticity and hardening ------------------------------------------------------------------------------


def test_moduli_over_pressure_and_compaction():
    model = rock(B1=6000.0, B2=500.0, B3=2000.0, B4=0.02, G1=0.1, G2=0.15)
    for trace, strain in [(-700.0, 0.0), (-100.0, -0.05), (-3000.0, -0.4)]:
        found = moduli(model, pores_of(model), trace, strain, 0.5)
        gained = np.exp(500.0 / trace)
        poisson = 0.1 + 0.15 * gained
        lost = 2000.0 * np.exp(0.02 / strain) if strain < 0 else 0.0
        assert found.bulk == pytest.approx(K + 6000.0 * gained - lost, rel=1e-14)
        stiff = K + 6000.0 * gained
        assert found.shear == pytest.approx(1.5 * stiff * (1 - 2 * poisson) / (1 + poisson), rel=1e-14)
    assert moduli(model, pores_of(model), 50.0, 0.0, 0.5) == (K, G)
    assert moduli(model, pores_of(model), -50.0, 0.01, 0.5) == (K, G)


@pytest.mark.parametrize(("kind", "floor"), [(Arenisca3, 1e-5), (Arenisca4, 1e-3)])
def test_disaggregated_rock_is_soft(kind, floor):
    model = rock(kind, Use_Disaggregation_Algorithm=True)
    pores = pores_of(model)
    assert moduli(model, pores, -10.0, -0.2, 0.7).bulk == pytest.approx(K * np.exp(-0.5), rel=1e-14)
    assert moduli(model, pores, -10.0, -0.2, 20.0).shear == pytest.approx(G * floor, rel=1e-14)


def test_saturated_stiffness_lies_between_that_of_dry_rock_and_its_grains():
    model = rock(B1=6000.0, B2=500.0, fluid_B0=3000.0)
    assert K < moduli(model, pores_of(model), -300.0, -0.01, 0.5).bulk < 16000.0
    thin = model._replace(fluid_B0=1e-6)
    assert moduli(thin, pores_of(thin), -300.0, -0.01, 0.5).bulk == pytest.approx(K, rel=1e-9)


def test_crush_curve():
    """Plastic volume strain over X: p3 (exp(p1 (X - p0)) - 1)."""
    model = rock()
    for strain in (0.0, -0.01, -0.2, -0.49):
        cap = cap_position(model, pores_of(model), strain, 0.5)
        assert 0.5 * (np.exp(6e-4 * (cap + 1800.0)) - 1) == pytest.approx(strain, abs=1e-14)
    assert cap_position(model, pores_of(model), -0.5, 0.5) == -1800.0e12
    below, above = (cap_position(model, pores_of(model), e, 0.5) for e in (-1e-7, 1e-7))
    assert (above - below) / 2e-7 == pytest.approx(1 / (0.5 * 6e-4), rel=1e-3)


def test_saturated_cap_is_reached_at_the_strain_of_the_dry_one():
    model = rock(**RICH)
    dry = rock(**RICH)._replace(fluid_B0=0.0)
    for strain in (0.0, -0.1):
        cap = cap_position(dry, pores_of(dry), strain, 0.5)
        dry_bulk = moduli(dry, pores_of(dry), cap / 2, strain, 0.5).bulk
        wet_bulk = moduli(model, pores_of(model), cap / 2, strain, 0.5).bulk
        wet_cap = cap_position(model, pores_of(model), strain, 0.5)
        assert wet_cap / wet_bulk == pytest.approx(cap / dry_bulk, rel=1e-12)


def test_back_stress_keeps_the_mass_of_grains_and_fluid():
    """exp(e) = (1 - phi) exp(zeta / 3 Km) + phi exp((zeta + 3 Pf0) / 3 Kf) for grains and fluid of one pressure."""
    model = rock(**RICH)
    matrix, fluid, porosity, start = 16000.0, 3000.0, 1 - np.exp(-0.5), 30.0

    def strain(zeta):
        solid = (1 - porosity) * np.exp(zeta / (3 * matrix))
        return np.log(solid + porosity * np.exp((zeta + 3 * start) / (3 * fluid)))

    for target in (-0.01, -0.2):
        zeta = brentq(lambda z, e=target: strain(z) - e, -5e4, 200.0, xtol=1e-10)
        slope = 2e-2 / (strain(zeta + 1e-2) - strain(zeta - 1e-2))
        assert back_stress_slope(model, pores_of(model), zeta, target) == pytest.approx(slope, rel=1e-8)
    assert back_stress_slope(model, pores_of(model), 0.0, 0.3) == 0.0


def test_pore_pressure_is_that_of_the_fluid_in_its_share_of_the_volume():
    model = rock(**RICH)
    pores = pores_of(model)
    assert pore_pressure(model, pores, 0.0) == pytest.approx(30.0, rel=1e-13)
    strain, phi = -0.1, 1 - np.exp(-0.5)
    mixture = 3000.0 * (1 - phi) + 16000.0 * phi
    opened = phi * np.exp(strain * 16000.0 / mixture)
    porosity = opened / (opened + (1 - phi) * np.exp(strain * 3000.0 / mixture))
    expected = 30.0 - 3000.0 * np.log(porosity * np.exp(strain) / phi)
    assert pore_pressure(model, pores, strain) == pytest.approx(expected, rel=1e-12)
    assert pore_pressure(model, pores, 0.2) == 0.0


# ---- return to the surface ---------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", MODELS)
@pytest.mark.parametrize("beta", [1.0, 0.6])
def test_drucker_prager_closed_form(kind, beta):
    """Return along K alpha I and G s / beta^2 to sqrt(J2) + alpha I1 = k."""
    alpha, strength = 0.2, 0.2 * 600.0
    model = rock(kind, **SOLID, BETA_nonassociativity=beta)
    strain = np.array([[-0.02, 0.05, 0.004], [0.05, 0.03, -0.006], [0.004, -0.006, -0.008]])
    stress = Driver(model, ROCK).advance(np.eye(3) + strain)
    i1, j, _ = invariants(2 * G * strain + (K - 2 * G / 3) * np.trace(strain) * np.eye(3))
    assert j + alpha * i1 > 2 * strength
    flow = (j + alpha * i1 - strength) / (9 * K * alpha**2 + G / beta**2)
    found = invariants(stress)
    assert found[1] + alpha * found[0] == pytest.approx(strength, rel=1e-5)
    assert found[0] == pytest.approx(i1 - 9 * K * alpha * flow, abs=5e-3 * j)
    assert found[1] == pytest.approx(j - G / beta**2 * flow, abs=5e-3 * j)
    shape = stress - found[0] / 3 * np.eye(3)
    trial = 2 * G * (strain - np.trace(strain) / 3 * np.eye(3))
    np.testing.assert_allclose(shape / found[1], trial / j, atol=1e-9 if kind is Arenisca3 else 5e-3)


@pytest.mark.parametrize("kind", MODELS)
def test_tension_returns_to_the_vertex(kind):
    driver = Driver(rock(kind, **SOLID), ROCK)
    stress = driver.advance(1.05 * np.eye(3))
    np.testing.assert_allclose(stress, 200.0 * np.eye(3), rtol=1e-4, atol=1e-2)
    assert driver.state.plastic_volume_strain[0] == pytest.approx(0.15 - 200.0 / K, rel=1e-4)


@pytest.mark.parametrize("kind", MODELS)
def test_hydrostatic_compression_follows_the_crush_curve(kind):
    driver = Driver(rock(kind), ROCK)
    for k in range(1, 16):
        stress = driver.advance((1 - 8e-3 * k) * np.eye(3))
    strain = driver.state.plastic_volume_strain[0]
    assert strain < -0.05
    assert driver.state.cap[0] == pytest.approx(-1800.0 + np.log(1 + strain / 0.5) / 6e-4, rel=1e-12)
    assert np.trace(stress) == pytest.approx(driver.state.cap[0], rel=1e-3)
    total = np.log(np.linalg.det(driver.particles.deformation_gradient[0]))
    assert driver.state.elastic_volume_strain[0] == pytest.approx(total - strain, rel=1e-12)


def expected_lode_factor(kind, psi, stress):
    _, j, j3 = invariants(stress)
    s = np.clip(-1.5 * np.sqrt(3) * j3 / j**3, -1, 1)
    if kind == 1:
        return 0.5 * (1 + s + (1 - s) / psi)
    theta, sin_phi = np.arcsin(s) / 3, 3 * (1 - psi) / (1 + psi)
    return 2 * np.sqrt(3) / (3 - sin_phi) * (np.cos(theta) - sin_phi * np.sin(theta) / np.sqrt(3))


@pytest.mark.parametrize("law", [0, 1, 3])
@pytest.mark.parametrize("seed", range(4))
def test_stress_ends_on_the_surface_of_its_lode_angle(law, seed):
    psi = 0.8
    strain = np.random.default_rng(seed).normal(size=(3, 3)) * 0.1
    strain = (strain + strain.T) / 2
    strain -= np.trace(strain) / 3 * np.eye(3)
    model = rock(Arenisca4, **SOLID, J3_type=law, J3_psi=psi)
    stress = Driver(model, ROCK).advance(np.eye(3) + strain)
    i1, j, _ = invariants(stress)
    factor = expected_lode_factor(law, psi, stress) if law else 1.0
    assert factor * j == pytest.approx(0.2 * (600.0 - i1), rel=1e-4)
    trial = 2 * G * strain + (K - 2 * G / 3) * np.trace(strain) * np.eye(3)
    np.testing.assert_allclose(stress @ trial, trial @ stress, atol=1e-9 * (trial**2).sum())


@pytest.mark.parametrize("law", [1, 3])
def test_strength_in_compression_over_extension(law):
    """psi: sqrt(J2) counts once in triaxial compression and 1 / psi times in extension."""
    model = rock(Arenisca4, J3_type=law, J3_psi=0.8)
    for sign, factor in [(-1.0, 1.0), (1.0, 1.25)]:
        s = sign * np.array([2.0, -1.0, -1.0])
        assert lode_factor(model, (s * s).sum() / 2, s.prod()) == pytest.approx(factor, rel=1e-12)
    assert lode_factor(model._replace(J3_psi=1.0), 3.0, 0.7) == pytest.approx(1.0 if law == 1 else TRESCA)


@pytest.mark.parametrize("stretches", [(0.9, 1.05, 1.05), (1.1, 0.95, 0.95), (1.2, 1.2, 1.2)])
def test_equal_principal_stresses_stay_equal_and_inside(stretches):
    """Where rounding alone tells principal stresses apart."""
    model = rock(Arenisca4, **SOLID, J3_type=3, J3_psi=0.8)
    noise = 1e-17 * np.array([[1, 2, 3], [2, 4, 5], [3, 5, 1]])
    stress = Driver(model, ROCK).advance(np.diag(stretches) + noise)
    assert stress[1, 1] == pytest.approx(stress[2, 2], rel=1e-9)
    assert np.abs(stress - np.diag(np.diag(stress))).max() < 1e-6
    i1, j, _ = invariants(stress)
    factor = expected_lode_factor(3, 0.8, stress) if j > 1e-3 else 1.0
    assert factor * j == pytest.approx(0.2 * (600.0 - i1), rel=2e-3, abs=1e-2)


# ---- the update as a whole ---------------------------------------------------------------------------------


def test_rate_dependence_lies_between_static_and_elastic():
    path = [np.diag([1 - 2e-3 * k, 1.0, 1.0]) for k in range(1, 21)]
    static = Driver(rock(), ROCK).follow(path, 1e-3)[-1]
    elastic = Driver(rock(FSLOPE=1e3, p0_crush_curve=-1e9), ROCK).follow(path, 1e-3)[-1]
    slow = rock(T1_rate_dependence=1e-9, T2_rate_dependence=0.1)
    np.testing.assert_allclose(Driver(slow, ROCK).follow(path, 1e-3)[-1], static, rtol=1e-3)
    fast = rock(T1_rate_dependence=1e9, T2_rate_dependence=0.1)
    np.testing.assert_allclose(Driver(fast, ROCK).follow(path, 1e-3)[-1], elastic, rtol=1e-6)


def test_overstress_decays_with_the_relaxation_time():
    """At a constant strain rate the overstress falls by exp(-dt/tau) over what the trial stress adds."""
    rate, dt = 2.0, 1e-3
    model = rock(T1_rate_dependence=0.02, T2_rate_dependence=0.5, PEAKI1=100.0, FSLOPE=0.05)
    driver = Driver(model, ROCK)
    F, over = np.eye(3), []
    old = static_old = np.zeros((3, 3))
    tau = 0.02 * rate**-0.5
    for _ in range(25):
        F = np.diag([1 - rate * dt, 1.0, 1.0]) @ F
        stress = driver.advance(F, dt)
        static = driver.state.static_stress[0].copy()
        strain = np.diag([-rate * dt, 0, 0])
        added = 2 * G * strain + (K - 2 * G / 3) * np.trace(strain) * np.eye(3) - (static - static_old)
        decay = np.exp(-dt / tau)
        over = added * (1 - decay) * tau / dt + (old - static_old) * decay
        np.testing.assert_allclose(stress - static, over, rtol=0, atol=1e-7 * np.abs(stress).max())
        old, static_old = stress, static
    assert np.abs(over).max() > 10.0


@pytest.mark.parametrize("kind", MODELS)
def test_turned_path(kind):
    model = rock(kind, **RICH)
    assert_turns_with_the_path(model, sample_path(15, 0.5), dt=0.01, material=ROCK, rtol=1e-6)


@pytest.mark.parametrize("kind", MODELS)
def test_kernel(kind):
    model = rock(kind, **RICH)
    if kind is Arenisca4:
        model = model._replace(J3_type=3, J3_psi=0.8)
    assert_kernel_agrees(model, sample_path(8, 0.6), dt=0.01, material=ROCK, viscosity=True, rtol=1e-9)


SUS = {
    Arenisca3: (
        [[-738.49675104946459, 14.942766691249407, -0.059538512097186518],
         [14.942766691249398, -532.26007825913746, 29.051368960581662],
         [-0.059538512097186469, 29.051368960581680, -417.20468157462818]],
        [[-1143.8627367286899, 19.915765355046034, -0.25949813910806929],
         [19.915765355046048, -872.26912738048952, 36.566796603548937],
         [-0.25949813910806951, 36.566796603548951, -728.56750417651006]],
        -1723.3560549970005,
        -1052.9457517663284,
    ),
    Arenisca4: (
        [[-738.49510659423038, 14.942327697320028, -0.059750395263206052],
         [14.942327697320014, -532.26491389165199, 29.045861894384551],
         [-0.059750395263206857, 29.045861894384554, -417.23119410678544]],
        [[-1143.8564873030894, 19.908381102405560, -0.25999402594551679],
         [19.908381102405624, -872.36339947909846, 36.541160423356118],
         [-0.25999402594552029, 36.541160423356118, -728.76080879950985]],
        -1723.3342447394425,
        -1052.8321050613567,
    ),
}  # fmt: skip
"""Stress after 40 and 100 steps, cap and back stress after 100, as sus computes them."""


def prescribed(start, end, steps, dt):
    """Velocity gradients and deformation gradients as Uintah prescribes them between two gradients in time 1."""
    F = start
    for k in range(1, steps + 1):
        planned = start + (end - start) * (k - 1) * dt
        L = (end - start) @ np.linalg.inv(planned)
        F = (np.eye(3) + L * dt + (L * dt) @ (L * dt) / 2) @ F
        yield L, F


@pytest.mark.parametrize("kind", MODELS)
def test_numbers_of_sus(kind):
    driver = Driver(rock(kind, **RICH), ROCK)
    p, dt, stresses = driver.particles, 0.01, []
    step = Step(dt, 0.0, 1.0, False, 0.2, 2.0, False)
    end = np.array([[0.9, 0.01, 0.0], [0.0, 0.97, 0.02], [0.0, 0.0, 1.01]])
    for L, F in prescribed(np.eye(3), end, 100, dt):
        old, old_volume = p.deformation_gradient.copy(), p.volume[0]
        p.deformation_gradient[0], p.velocity_gradient[0] = F, L
        p.volume[0] = 2.0 * np.linalg.det(F)
        compiled_update()(driver.model, driver.state, p, old, old_volume, ROCK, step, driver.answer)
        stresses.append(p.stress[0].copy())
    after_40, after_100, cap, zeta = SUS[kind]
    np.testing.assert_allclose(stresses[39], after_40, rtol=1e-10, atol=1e-8)
    np.testing.assert_allclose(stresses[99], after_100, rtol=1e-10, atol=1e-8)
    assert driver.state.cap[0] == pytest.approx(cap, rel=1e-11)
    assert driver.state.zeta[0] == pytest.approx(zeta, rel=1e-11)


@pytest.mark.parametrize("kind", MODELS)
def test_speeds(kind):
    model = rock(kind, B1=6000.0, B2=500.0)
    expected = np.sqrt((16000.0 + 4 * G / 3) / 1050.0)
    np.testing.assert_allclose(initial_sound_speed(model, np.array([1050.0]), 300.0), expected)
    driver = Driver(model, ROCK)
    driver.advance(np.eye(3))
    assert driver.sound_speed == pytest.approx(expected, rel=1e-13)


def test_strain_energy_is_the_work_of_the_step():
    strain = np.diag([1e-4, -2e-4, 5e-5])
    driver = Driver(rock(), ROCK)
    stress = driver.advance(np.eye(3) + strain)
    assert driver.strain_energy == pytest.approx(
        (strain * stress / 2).sum() * driver.particles.volume[0], rel=1e-9
    )


@pytest.mark.parametrize("kind", MODELS)
def test_particles_out_of_bounds_are_removed(kind):
    driver = Driver(rock(kind), ROCK, start=np.diag([150.0, 1.0, 1.0]))
    driver.advance(np.diag([150.0, 1.0, 1.0]))
    assert driver.localized == DELETE
    few = Driver(rock(kind, subcycling_characteristic_number=1.0, STREN=1e-3, YSLOPE=1e-8), ROCK)
    stress = few.advance(np.diag([0.9, 1.0, 1.0]))
    assert few.localized == DELETE
    np.testing.assert_array_equal(stress, 0.0)
    sound = Driver(rock(kind), ROCK)
    sound.advance(np.diag([0.999, 1.0, 1.0]))
    assert sound.localized == 0


# ---- start and parameters ----------------------------------------------------------------------------------


def started(model, count=4000, volume=0.5):
    particles = new_arrays(Particles, count)
    particles.volume[:], particles.mass[:] = volume, volume * 1050.0 * 0.8
    state = new_arrays(state_record(model), count)
    initialize(model, state, particles, ROCK, np.zeros(count, int))
    return particles, state


def test_start_under_pore_pressure():
    particles, state = started(rock(**RICH), 3)
    np.testing.assert_array_equal(particles.stress, np.broadcast_to(-30.0 * np.eye(3), (3, 3, 3)))
    np.testing.assert_array_equal(state.static_stress, particles.stress)
    np.testing.assert_array_equal(state.zeta, -90.0)
    np.testing.assert_array_equal(state.peak_i1, 600.0)
    _, loose = started(rock(Use_Disaggregation_Algorithm=True), 3)
    np.testing.assert_allclose(loose.crush_limit, np.log(1 / 0.8))


def test_strength_of_weibull_and_its_size_effect():
    """Mean and variance of Weibull's distribution; half the reference volume raises strength by 2^(1/4)."""
    _, state = started(rock(PEAKI1IDIST="weibull, 500, 4, 1.0, 7"))
    mean = 500.0 * 2**0.25
    assert state.peak_i1.mean() == pytest.approx(mean, rel=0.02)
    assert state.peak_i1.std() / state.peak_i1.mean() == pytest.approx(0.2805, rel=0.05)
    _, alike = started(rock(PEAKI1IDIST="weibull, 500, 4, 1.0, 0"), 3)
    np.testing.assert_allclose(alike.peak_i1, mean)


def test_text_of_a_distribution():
    assert weibull_law("") is None
    assert weibull_law("45e6") is None
    assert weibull_law('"Weibull, 45e6, 4, 0.0001, 2"') == (45e6, 4.0, 1e-4, 2)
    for text in ("weibull, 45e6, 4", "weibull, a, 4, 1, 0", "weibull, 1, 0, 1, 0", "strong"):
        assert [name for name, _ in rock(PEAKI1IDIST=text).faults()] == ["PEAKI1IDIST"]


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({}, None),
        (RICH, None),
        ({"FSLOPE": 0.0, "STREN": 250.0, "PEAKI1": 0.0}, None),
        ({"STREN": 250.0, "PEAKI1": 0.0}, None),
        ({"FSLOPE": 0.0}, "STREN"),
        ({"FSLOPE": 0.0, "STREN": 250.0}, "FSLOPE"),
        ({"STREN": 250.0}, "YSLOPE"),
        ({"STREN": 250.0, "YSLOPE": 0.3}, "FSLOPE"),
        ({"STREN": 20.0, "YSLOPE": 0.05}, "STREN"),
        ({"T1_rate_dependence": 1.0}, "T1_rate_dependence"),
        ({"Use_Disaggregation_Algorithm": True, "fluid_B0": 1e3}, "Use_Disaggregation_Algorithm"),
    ],
)
def test_faults(changes, fault):
    assert [name for name, _ in rock(**changes).faults()] == ([fault] if fault else [])


def test_unknown_lode_law():
    assert [name for name, _ in rock(Arenisca4, J3_type=2).faults()] == ["J3_type"]


def test_labels_and_bounds():
    labels = {v.label for v in state_variables(state_record(rock())).values()}
    assert {"p.evp", "p.eve", "p.ep", "p.CapX", "p.Zeta", "p.P3", "p.StressQS", "p.PorePressure"} <= labels
    declared = {f.name: f.parameter for f in fields(Arenisca4)}
    assert (declared["p0_crush_curve"].lt, declared["B0"].gt, declared["CR"].gt) == (0.0, 0.0, 0.0)
    assert declared["principal_stress_cutoff"].ignored
    assert declared["G3"].ignored
