from __future__ import annotations

import numpy as np
import pytest

from solver.contact.null import NullContact
from solver.contact.single_velocity import SingleVelocity


def test_null_contact_changes_nothing(scene):
    s = scene()
    before = s.nodal.velocity.copy(), s.nodal.velocity_star.copy()
    for part in (1, 2):
        NullContact().apply(part, s)
    np.testing.assert_array_equal(s.nodal.velocity, before[0])
    np.testing.assert_array_equal(s.nodal.velocity_star, before[1])


@pytest.mark.parametrize("part", [1, 2])
@pytest.mark.parametrize("materials", [(), (0, 2), (1, 7)])
def test_listed_materials_move_with_their_centre_of_mass(scene, part, materials):
    s = scene()
    listed = [m for m in materials if m < 3] or [0, 1, 2]
    velocity, mass = s.velocity(part), s.nodal.mass
    common = np.einsum("mn,mnk->nk", mass[listed], velocity[listed]) / mass[listed].sum(axis=0)[:, None]
    expected = velocity.copy()
    for m in listed:
        expected[m, s.owned_nodes] = common[s.owned_nodes]

    SingleVelocity(materials=materials).apply(part, s)

    np.testing.assert_allclose(velocity, expected, rtol=1e-13)


def test_momentum_of_each_node_is_kept(scene):
    s = scene()
    momentum = np.einsum("mn,mnk->nk", s.nodal.mass, s.nodal.velocity)
    SingleVelocity().apply(1, s)
    np.testing.assert_allclose(np.einsum("mn,mnk->nk", s.nodal.mass, s.nodal.velocity), momentum, atol=1e-14)


def test_one_step_acts_after_the_forces_only(scene):
    s = scene()
    law = SingleVelocity(OneOrTwoStep=1)
    before = s.nodal.velocity.copy()
    law.apply(1, s)
    np.testing.assert_array_equal(s.nodal.velocity, before)
    law.apply(2, s)
    np.testing.assert_allclose(
        s.nodal.velocity_star[0, s.owned_nodes], s.nodal.velocity_star[1, s.owned_nodes]
    )


def test_nodes_with_the_excluded_material_are_left_alone(scene):
    s = scene()
    before = s.nodal.velocity.copy()
    SingleVelocity(materials=(0, 1), ExcludeMaterial=2).apply(1, s)
    excluded = s.owned_nodes & (s.nodal.mass[2] > 1e-99)
    np.testing.assert_array_equal(s.nodal.velocity[:, excluded], before[:, excluded])
    free = s.owned_nodes & ~excluded
    np.testing.assert_array_equal(s.nodal.velocity[0, free], s.nodal.velocity[1, free])


def test_an_excluded_material_that_does_not_exist_is_an_error():
    with pytest.raises(ValueError, match="<ExcludeMaterial> 3 names no material: the deck has 0 to 1"):
        SingleVelocity(ExcludeMaterial=3).check(2)
    SingleVelocity(ExcludeMaterial=1).check(2)
