"""Conversion of failed particles keeps what they are and have, and moves nothing else."""

from __future__ import annotations

import numpy as np
from mpm_cases import MATERIAL, make_body, make_grid, make_particles

from solver.conversion import convert_failed_particles
from solver.materials.constitutive import DELETE, state_record
from solver.materials.damage.threshold import Threshold
from solver.materials.elastic_plastic import ElasticPlastic
from solver.materials.erosion.zero_stress import ZeroStress
from solver.materials.failure import new_failure
from solver.materials.failure_criterion.principal_stress import MaximumPrincipalStress
from solver.materials.flow_stress.isotropic_hardening import IsotropicHardening
from solver.materials.hyperelastic_plastic import HyperElasticPlastic
from solver.particles import new_arrays, state_variables

PLASTIC = ElasticPlastic(160.0e9, 80.0e9, IsotropicHardening(1.0e9, 1.0e8))
SPLIT = HyperElasticPlastic(160.0e9, 80.0e9, IsotropicHardening(1.0e9, 1.0e8))
N = 12
GONE, FAILED = 3, [1, 4, 5]


def bodies():
    """A body of particles that differ in everything, three of them failed, and one that takes them."""
    rng = np.random.default_rng(11)
    made = []
    for index, count in enumerate((N, 2)):
        particles = make_particles(make_grid((4, 4, 4)), rng.uniform(1.0, 3.0, (count, 3)))
        for name in state_variables(type(particles)):
            array = getattr(particles, name)
            whole = array.dtype.kind == "i"
            array[...] = rng.integers(1, 9, array.shape) if whole else rng.uniform(1, 2, array.shape)
        particles.localized[:] = 0
        particles.id[:] = 100 * index + np.arange(count)
        damage = Threshold(MaximumPrincipalStress(), 1.0e6)
        failure = new_failure(damage, ZeroStress(), count)
        failure.damage_state.strength[:] = rng.uniform(1, 2, count)
        failure.erosion_state.failure_time[:] = rng.uniform(0, 1, count)
        made.append(make_body(particles, index, failure=failure))
    made[0].particles.localized[FAILED] = 1
    made[0].particles.localized[GONE] = DELETE
    return made


def totals(bodies):
    """Mass, momentum, kinetic energy and heat of all particles."""
    mass = momentum = kinetic = heat = 0.0
    for body in bodies:
        p = body.particles
        mass = mass + p.mass.sum()
        momentum = momentum + p.mass @ p.velocity
        kinetic = kinetic + 0.5 * p.mass @ (p.velocity**2).sum(axis=1)
        heat = heat + body.material.specific_heat * (p.mass @ p.temperature)
    return np.array([mass, *momentum, kinetic, heat])


def test_failed_particles_go_with_all_they_have():
    before, after = bodies(), bodies()
    assert convert_failed_particles(after, {0: 1}) == len(FAILED)
    assert after[0].particles.id.tolist() == [i for i in range(N) if i not in FAILED]
    assert after[1].particles.id.tolist() == [100, 101, *FAILED]
    for old, there, new in zip(before[0].records, before[1].records, after[1].records, strict=True):
        for a, b, c in zip(old, there, new, strict=True):
            np.testing.assert_array_equal(c, np.concatenate([b, a[FAILED]]))


def test_mass_momentum_and_energy_stay():
    case = bodies()
    before = totals(case)
    convert_failed_particles(case, {0: 1})
    np.testing.assert_allclose(totals(case), before, rtol=1e-14)


def test_heat_stays_where_the_new_material_takes_more_of_it():
    case = bodies()
    case[1].material = MATERIAL._replace(specific_heat=2.5 * MATERIAL.specific_heat)
    hot = case[0].particles.temperature[FAILED].copy()
    before = totals(case)
    convert_failed_particles(case, {0: 1})
    np.testing.assert_allclose(totals(case), before, rtol=1e-14)
    np.testing.assert_allclose(case[1].particles.temperature[2:], hot / 2.5, rtol=1e-14)


def test_nothing_moves_before_it_fails_or_once_it_has_moved():
    case = bodies()
    convert_failed_particles(case, {0: 1})
    assert convert_failed_particles(case, {0: 1}) == 0
    assert DELETE in case[0].particles.localized


def test_several_materials_may_share_one_that_waits():
    case = bodies()
    case[1].particles.localized[0] = 1
    case.append(make_body(make_particles(make_grid((4, 4, 4)), np.zeros((0, 3))), 2))
    assert convert_failed_particles(case, {0: 2, 1: 2}) == len(FAILED) + 1
    assert case[2].particles.id.tolist() == [*FAILED, 100]


def test_another_model_takes_over_what_it_knows_and_starts_the_rest_anew():
    """Plastic strain has one label in both models; the split of the second is new."""
    case = bodies()
    flowing = make_body(case[0].particles, 0, model=PLASTIC, failure=case[0].failure)
    flowing.state = new_arrays(state_record(PLASTIC), N)
    flowing.state.plastic_strain[:] = np.arange(N)
    waiting = make_body(case[1].particles, 1, model=SPLIT)
    waiting.state = new_arrays(state_record(SPLIT), 2)
    stress = flowing.particles.stress[FAILED].copy()
    times = flowing.failure.erosion_state.failure_time[FAILED].copy()
    convert_failed_particles([flowing, waiting], {0: 1})
    np.testing.assert_array_equal(waiting.particles.stress[2:], stress)
    np.testing.assert_array_equal(waiting.state.plastic_strain, [0.0, 0.0, *FAILED])
    np.testing.assert_array_equal(waiting.failure.erosion_state.failure_time[2:], times)
    np.testing.assert_array_equal(waiting.state.elastic_stretch, np.tile(np.eye(3), (2 + len(FAILED), 1, 1)))
    assert len(waiting.failure.damage_state) == 0
