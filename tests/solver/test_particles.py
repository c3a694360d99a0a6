"""Arrays of particles."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from solver.materials.constitutive import NoState
from solver.particles import Array, Particles, StateVariable, append, keep, new_arrays, state_variables


class State(NamedTuple):
    strain: Annotated[Array, StateVariable("p.strain")]
    stretch: Annotated[Array, StateVariable("p.stretch", "Matrix3", 2.0)]
    damage: Annotated[Array, StateVariable("p.damage", "int", 3)]


def test_arrays_start_from_their_declared_values():
    state = new_arrays(State, 4)
    assert [a.shape for a in state] == [(4,), (4, 3, 3), (4,)]
    assert state.damage.dtype == np.int32
    np.testing.assert_array_equal(state.strain, 0.0)
    np.testing.assert_array_equal(state.stretch, np.tile(2.0 * np.eye(3), (4, 1, 1)))
    np.testing.assert_array_equal(state.damage, 3)


def test_particles_start_undeformed_and_know_their_number():
    particles = new_arrays(Particles, 5)
    assert len(particles) == 5
    np.testing.assert_array_equal(particles.deformation_gradient, np.tile(np.eye(3), (5, 1, 1)))
    assert particles.id.dtype == np.int64
    assert particles.load_curve.shape == (5, 3)
    assert all(array.flags.c_contiguous and len(array) == 5 for array in particles)
    assert len(new_arrays(Particles, 0)) == 0


def test_every_array_of_a_particle_is_declared_under_its_own_label():
    variables = state_variables(Particles)
    assert tuple(variables) == Particles._fields
    labels = [variable.label for variable in variables.values() if variable.label]
    assert len(labels) == len(set(labels))


def test_keep_and_append():
    particles = new_arrays(Particles, 4)
    particles.id[:] = [3, 1, 4, 1]
    particles.position[:] = np.arange(12.0).reshape(4, 3)
    some = keep(particles, np.array([True, False, True, False]))
    np.testing.assert_array_equal(some.id, [3, 4])
    np.testing.assert_array_equal(some.position, [[0, 1, 2], [6, 7, 8]])
    both = append(some, keep(particles, np.array([3])))
    np.testing.assert_array_equal(both.id, [3, 4, 1])
    assert [a.dtype for a in both] == [a.dtype for a in particles]
    assert all(array.flags.c_contiguous for array in both)


def test_kept_particles_do_not_share_memory_with_the_old():
    particles = new_arrays(Particles, 3)
    kept = keep(particles, np.array([True, True, True]))
    kept.mass[0] = 7.0
    assert particles.mass[0] == 0.0


def test_models_without_state_keep_none():
    assert keep(NoState(), np.array([True])) == NoState()
    assert new_arrays(NoState, 3) == NoState()
