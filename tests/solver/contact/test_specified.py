from __future__ import annotations

import math

import numpy as np
import pytest

from solver.contact.motion import Profile, read_profile
from solver.contact.specified import Specified


def holds_master(s, master=0):
    return s.owned_nodes & (s.nodal.mass[master] > 1e-14)


def with_profile(tmp_path, text, **parameters):
    file = tmp_path / "profile.txt"
    file.write_text(text)
    law = Specified(filename="profile.txt", **parameters)
    law.load(lambda name: tmp_path / name)
    return law


def test_other_materials_take_the_masters_velocity_in_the_chosen_directions(scene):
    s = scene()
    before = s.nodal.velocity_star.copy()
    Specified(materials=(0, 1), direction=(1, 0, 1)).apply(2, s)
    expected = before.copy()
    for axis in (0, 2):
        expected[1, holds_master(s), axis] = before[0, holds_master(s), axis]
    np.testing.assert_array_equal(s.nodal.velocity_star, expected)


def test_without_a_list_of_materials_only_the_master_is_acted_on(scene):
    s = scene()
    before = s.nodal.velocity_star.copy()
    Specified(master_material=1, stop_time=-1.0, velocity_after_stop=(1.0, 2.0, 3.0)).apply(2, s)
    np.testing.assert_array_equal(s.nodal.velocity_star[[0, 2]], before[[0, 2]])
    np.testing.assert_array_equal(
        s.nodal.velocity_star[1, holds_master(s, 1)],
        np.broadcast_to([1.0, 2.0, 3.0], (holds_master(s, 1).sum(), 3)),
    )


@pytest.mark.parametrize(("steps", "xpic2", "acts"), [(1, False, False), (2, False, True), (1, True, True)])
def test_part_one_acts_with_two_steps_or_xpic2(scene, steps, xpic2, acts):
    s = scene(xpic2=xpic2)
    before = s.nodal.velocity.copy()
    Specified(materials=(1,), direction=(1, 1, 1), OneOrTwoStep=steps).apply(1, s)
    assert (not np.array_equal(s.nodal.velocity, before)) == acts
    if acts:
        chosen = holds_master(s)
        np.testing.assert_array_equal(s.nodal.velocity[1, chosen], before[0, chosen])


def test_part_one_imposes_only_the_chosen_directions_on_the_master_itself(scene):
    s = scene()
    before = s.nodal.velocity.copy()
    law = Specified(stop_time=-1.0, velocity_after_stop=(7.0, 8.0, 9.0), direction=(0, 1, 0), OneOrTwoStep=2)
    law.apply(1, s)
    chosen = holds_master(s)
    np.testing.assert_array_equal(s.nodal.velocity[0, chosen][:, [0, 2]], before[0, chosen][:, [0, 2]])
    assert (s.nodal.velocity[0, chosen, 1] == 8.0).all()


def test_after_stop_time_velocity_after_stop_is_imposed(scene):
    law = Specified(materials=(1,), direction=(0, 0, 1), stop_time=2.0, velocity_after_stop=(0.0, 0.0, -5.0))
    for time, expected in ((2.0, None), (2.1, -5.0)):
        s = scene(time=time)
        masters = s.nodal.velocity_star[0, holds_master(s), 2].copy()
        law.apply(2, s)
        np.testing.assert_array_equal(
            s.nodal.velocity_star[1, holds_master(s), 2], masters if expected is None else expected
        )


def test_nodes_that_are_not_filled_beyond_the_constraint_are_left_alone(scene):
    s = scene()
    s.node_to_cell_weight[:] = np.where(np.arange(s.grid.number_of_nodes) % 2, 0.125, 0.25)
    filling = (s.nodal.volume * 8.0 * s.node_to_cell_weight).sum(axis=0) / s.grid.cell_volume
    constraint = float(np.median(filling[holds_master(s)]))
    before = s.nodal.velocity_star.copy()
    Specified(materials=(2,), direction=(1, 1, 1), volume_constraint=constraint).apply(2, s)
    full = holds_master(s) & (filling > constraint)
    assert 0 < full.sum() < holds_master(s).sum()
    np.testing.assert_array_equal(s.nodal.velocity_star[2, full], before[0, full])
    np.testing.assert_array_equal(s.nodal.velocity_star[2, ~full], before[2, ~full])


def test_normal_only_takes_away_what_goes_against_the_normal(scene):
    s = scene()
    normal = np.random.default_rng(3).normal(size=(s.grid.number_of_nodes, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    law = Specified(materials=(1,), normal_only=True)
    law.normals = lambda scene: normal
    before = s.nodal.velocity_star.copy()
    law.apply(2, s)
    approach = np.einsum("nk,nk->n", normal, before[1] - before[0])
    expected = before[1] - np.minimum(approach, 0.0)[:, None] * normal
    chosen = holds_master(s)
    assert (approach[chosen] < 0).any()
    assert (approach[chosen] > 0).any()
    np.testing.assert_allclose(s.nodal.velocity_star[1, chosen], expected[chosen], atol=1e-14)
    np.testing.assert_array_equal(s.nodal.velocity_star[0], before[0])


def test_with_normal_only_the_master_follows_its_profile(scene, tmp_path):
    s = scene()
    law = with_profile(tmp_path, "0 1 2 3\n1 1 2 3\n", materials=(1,), normal_only=True)
    law.apply(2, s)
    velocity = s.nodal.velocity_star[0, holds_master(s)]
    np.testing.assert_array_equal(velocity, np.broadcast_to([1.0, 2.0, 3.0], velocity.shape))


def test_reactions_are_the_internal_forces_of_the_materials_acted_on(scene):
    s = scene()
    before = s.nodal.velocity_star.copy()
    Specified(materials=(1, 2), direction=(1, 1, 1)).apply(2, s)
    chosen = holds_master(s)
    force = -s.nodal.internal_force[:, chosen].sum(axis=1)
    change = s.nodal.velocity_star - before
    transmitted = -(s.nodal.mass[..., None] * change).sum(axis=(0, 1)) / s.dt
    label = "RigidReactionForce"
    np.testing.assert_allclose(s.reductions[label, 1], force[1])
    np.testing.assert_allclose(s.reductions[label, 2], force[2])
    np.testing.assert_allclose(s.reductions[label, 0], force[1] + force[2])
    np.testing.assert_allclose(s.reductions[label, -1], force[1] + force[2])
    np.testing.assert_allclose(s.reductions["SumTransmittedForce", -1], transmitted)
    np.testing.assert_allclose(s.reductions["SumTransmittedForce", 0], transmitted)
    np.testing.assert_array_equal(s.reductions["SumTransmittedForce", 1], 0.0)
    np.testing.assert_array_equal(s.reductions["RigidReactionTorque", -1], 0.0)


def test_reactions_of_several_laws_add_up(scene):
    s = scene()
    law = Specified(materials=(1,), direction=(1, 1, 1))
    law.apply(2, s)
    once = s.reductions["RigidReactionForce", 1].copy()
    law.apply(2, s)
    np.testing.assert_allclose(s.reductions["RigidReactionForce", 1], 2.0 * once)


def test_torque_is_taken_about_the_origin_of_rotation(scene, tmp_path):
    text = "0 0 0 0  1 2 3  0 0 0\n9 0 0 0  1 2 3  0 0 0\n"
    law = with_profile(tmp_path, text, materials=(1,), include_rotation=True)
    s = scene()
    law.apply(2, s)
    chosen = holds_master(s)
    arms = s.node_positions[chosen] - [1.0, 2.0, 3.0]
    expected = np.cross(arms, -s.nodal.internal_force[1, chosen]).sum(axis=0)
    np.testing.assert_allclose(s.reductions["RigidReactionTorque", 1], expected)


def test_velocity_of_a_profile_is_interpolated_in_time(scene, tmp_path):
    law = with_profile(tmp_path, "1 0 0 0\n2 4 -2 8\n\n5 1 1 1\n", materials=(1,), direction=(1, 1, 1))
    expected = {0.0: [0, 0, 0], 1.25: [1, -0.5, 2], 2.0: [4, -2, 8], 3.5: [2.5, -0.5, 4.5], 7.0: [1, 1, 1]}
    for time, velocity in expected.items():
        s = scene(time=time)
        law.apply(2, s)
        for m in (0, 1):
            np.testing.assert_allclose(
                s.nodal.velocity_star[m, holds_master(s)],
                np.broadcast_to(np.array(velocity, float), (holds_master(s).sum(), 3)),
                atol=1e-15,
            )


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_rotation_about_a_coordinate_axis_keeps_points_on_their_circle(scene, tmp_path, axis):
    omega = [0.0, 0.0, 0.0]
    omega[axis] = 3.0
    row = "{} 0.5 0 0  0.1 0.2 0.3  {} {} {}\n"
    law = with_profile(
        tmp_path,
        row.format(0, *omega) + row.format(1, *omega),
        materials=(1,),
        direction=(1, 1, 1),
        include_rotation=True,
    )
    s = scene(dt=0.25)
    law.apply(2, s)
    chosen = holds_master(s)
    arms = s.node_positions[chosen] - [0.1, 0.2, 0.3]
    b, c = (axis + 1) % 3, (axis + 2) % 3
    angle = 3.0 * 0.25
    turned = arms.copy()
    turned[:, b] = math.cos(angle) * arms[:, b] - math.sin(angle) * arms[:, c]
    turned[:, c] = math.sin(angle) * arms[:, b] + math.cos(angle) * arms[:, c]
    expected = (turned - arms) / 0.25 + [0.5, 0.0, 0.0]
    np.testing.assert_allclose(s.nodal.velocity_star[1, chosen], expected, atol=1e-13)


def test_rotation_about_an_oblique_axis_is_omega_cross_r(scene, tmp_path):
    row = "{} 0 0 0  0.1 0.2 0.3  1 2 3\n"
    law = with_profile(
        tmp_path,
        row.format(0) + row.format(1),
        materials=(1,),
        direction=(1, 1, 1),
        include_rotation=True,
        OneOrTwoStep=2,
    )
    s = scene()
    chosen = holds_master(s)
    expected = np.cross([1.0, 2.0, 3.0], s.node_positions[chosen] - [0.1, 0.2, 0.3])
    law.apply(1, s)
    law.apply(2, s)
    np.testing.assert_allclose(s.nodal.velocity[1, chosen], expected, atol=1e-14)
    np.testing.assert_allclose(s.nodal.velocity_star[1, chosen], expected, atol=1e-14)


def test_a_condition_sends_the_profile_to_its_next_row_once(scene, tmp_path):
    law = with_profile(
        tmp_path,
        "0 1 0 0\n10 1 0 0\n11 5 0 0\n20 5 0 0\n",
        direction=(1, 0, 0),
        condition="zminus",
        conditionValue=100.0,
        conditionAction="GoToNextEntry",
    )

    def velocity(time, force):
        s = scene(time=time, face_forces={"zminus": force})
        law.apply(2, s)
        return s.nodal.velocity_star[0, holds_master(s), 0][0]

    assert velocity(1.0, (0.0, 0.0, 99.0)) == 1.0
    assert law.condition_met_at is None
    assert velocity(2.0, (0.0, -101.0, 0.0)) == 1.0
    assert law.condition_met_at == 2.0
    assert velocity(2.5, (0.0, 0.0, 0.0)) == pytest.approx(3.0)
    assert velocity(3.0, (0.0, 0.0, 500.0)) == pytest.approx(5.0)
    assert law.condition_met_at == 2.0


def test_a_profile_sent_to_rest_drops_the_rows_it_passes_over():
    profile = Profile(
        np.array([0.0, 4.0, 5.0, 6.0, 8.0]),
        np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, 0], [3, 0, 0.0]]),
    )
    changed = profile.advanced(1.0, to_rest=True)
    np.testing.assert_array_equal(changed.times, [0.0, 1.0, 3.0])
    np.testing.assert_array_equal(changed.at(1.0), [0.0, 0.0, 0.0])
    np.testing.assert_array_equal(changed.at(2.0), [1.5, 0.0, 0.0])
    assert profile.advanced(7.0, to_rest=True) is profile


@pytest.mark.parametrize(
    ("text", "rotation", "message"),
    [
        ("0 0 0 0\n1 0 0 x\n", False, "profile.txt:2: not a row of numbers; each row is: t vx vy vz"),
        ("0 0 0 0\n\n1 0 0\n", False, "profile.txt:3: 3 numbers where a row has 4"),
        ("0 0 0 0\n1 0 0 0\n", True, "profile.txt:1: 4 numbers where a row has 10"),
        ("0 0 0 0\n2 0 0 0\n2 0 0 0\n", False, "profile.txt:3: time 2 is not after the one before it"),
        ("0 0 0 0\n1 nan 0 0\n", False, "profile.txt:2: every number must be finite"),
        ("0 0 0 0\n", False, "profile.txt: a profile needs at least two rows"),
        ("", False, "profile.txt: a profile needs at least two rows"),
    ],
)
def test_a_bad_profile_is_reported_with_file_and_line(tmp_path, text, rotation, message):
    file = tmp_path / "profile.txt"
    file.write_text(text)
    with pytest.raises(ValueError, match=r"profile\.txt") as error:
        read_profile(file, rotation)
    assert message in str(error.value)


def test_a_binary_profile_is_reported(tmp_path):
    file = tmp_path / "profile.txt"
    file.write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(ValueError, match=r"profile.txt: a profile is a text file"):
        read_profile(file, False)


def test_a_master_that_does_not_exist_is_an_error():
    with pytest.raises(ValueError, match="<master_material> 2 names no material: the deck has 0 to 1"):
        Specified(master_material=2).check(2)


def test_the_master_becomes_rigid_and_no_alpha_material():
    law = Specified(master_material=1)
    assert law.made_rigid == (1,)
    assert law.never_alpha == (1,)
