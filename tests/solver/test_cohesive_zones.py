"""Cohesive zones against the energies of their law and against forces by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

from solver.cohesive_zones import (
    STEPS_TO_RELEASE,
    CohesiveZone,
    CohesiveZones,
    ZoneState,
    has_failed,
    read_zones,
    tractions,
)
from solver.creation import ParticleIds
from solver.declare import fields
from solver.grid import Grid, Patch
from solver.nodal import new_nodal_fields
from solver.particles import new_arrays

LAW = CohesiveZone(2e-3, 3e-3, 240.0, 150.0, "zones.txt")
GRID = Grid(
    (0.0, -1.0, 0.0),
    (0.5, 0.5, 0.5),
    (4, 4, 2),
    (1, 1, 1),
    (0, 0, 0),
    (Patch(0, (0, 0, 0), (2, 4, 2)), Patch(1, (2, 0, 0), (4, 4, 2))),
)
ROW = "0.7 -0.1 0.2 0.01 0 1 0 1 0 0 0 1\n"


def pull(opening, first=0.0, second=0.0, law=LAW):
    return [float(t[0]) for t in tractions(law, *(np.array([d]) for d in (opening, first, second)))]


# ---- the law -----------------------------------------------------------------------------------------------


def test_strengths_and_where_they_are_reached():
    openings = np.linspace(0, 0.02, 4001)
    normal, _, _ = tractions(LAW, openings, 0 * openings, 0 * openings)
    assert normal.max() == pytest.approx(240.0, rel=1e-6)
    assert openings[normal.argmax()] == pytest.approx(LAW.delta_n, abs=5e-6)
    _, first, second = tractions(LAW, 0 * openings, openings, openings)
    assert first.max() == pytest.approx(150.0, rel=1e-6)
    assert openings[first.argmax()] == pytest.approx(LAW.delta_t / np.sqrt(2), abs=5e-6)
    np.testing.assert_array_equal(first, second)


def test_work_of_separation():
    """e sig_max d_n in opening and sqrt(e/2) tau_max d_t in sliding."""
    work = quad(lambda d: pull(d)[0], 0, 0.1)[0]
    assert work == pytest.approx(np.e * 240.0 * 2e-3, rel=1e-6)
    work = quad(lambda d: pull(0.0, d)[1], 0, 0.1)[0]
    assert work == pytest.approx(np.sqrt(np.e / 2) * 150.0 * 3e-3, rel=1e-6)


def test_tractions_have_a_potential():
    """In opening and first sliding with r = 0: d(T_n)/d(D_1) = d(T_1)/d(D_n)."""
    h = 1e-8
    for opening, sliding in [(1e-3, 2e-3), (3e-3, -1e-3), (-2e-4, 1e-3)]:
        by_sliding = (pull(opening, sliding + h)[0] - pull(opening, sliding - h)[0]) / (2 * h)
        by_opening = (pull(opening + h, sliding)[1] - pull(opening - h, sliding)[1]) / (2 * h)
        assert by_sliding == pytest.approx(by_opening, rel=1e-5)


def test_penetration_pushes_back():
    assert pull(-1e-3)[0] < -240.0
    assert pull(0.0) == [0.0, 0.0, 0.0]


def test_failure():
    def failed(opening=0.0, first=0.0, second=0.0, law=LAW):
        return bool(has_failed(law, *(np.array([d]) for d in (opening, first, second)))[0])

    assert not failed(7.9e-3, 11.9e-3, -11.9e-3)
    assert failed(8.1e-3)
    assert failed(first=-12.1e-3)
    assert failed(second=12.1e-3)
    assert failed(2.5e-3, law=LAW._replace(delta_n_fail=2e-3))
    assert not failed(first=0.1, law=LAW._replace(delta_t_fail=1.0))


# ---- zones in a grid ---------------------------------------------------------------------------------------


def zones_of(tmp_path, text, materials=2):
    file = tmp_path / "zones.txt"
    file.write_text(text)
    return read_zones(file, GRID, materials, ParticleIds(GRID))


def scene(tmp_path, text=ROW):
    nodal = new_nodal_fields(GRID, 2)
    rng = np.random.default_rng(3)
    nodal.mass[:] = rng.uniform(1.0, 2.0, nodal.mass.shape)
    return CohesiveZones(LAW, zones_of(tmp_path, text)), nodal


def step(zones, nodal, dt, grid=GRID):
    nodal.external_force[:] = 0.0
    zones.act(grid, nodal, dt, nodal.external_force)
    zones.settle(grid)


def test_opening_in_a_linear_velocity_field(tmp_path):
    zones, nodal = scene(tmp_path)
    x = GRID.node_positions()
    top = 0.1 * np.array([x[:, 0], 2 * x[:, 1] + 1, -x[:, 2]]).T
    nodal.velocity[1] = top
    step(zones, nodal, 0.01)
    velocity = 0.1 * np.array([0.7, 0.8, -0.2])
    z = zones.zones
    np.testing.assert_allclose(z.separation[0], velocity * 0.01, rtol=1e-12)
    np.testing.assert_allclose(z.top_displacement, z.separation)
    np.testing.assert_array_equal(z.bottom_displacement, 0.0)
    np.testing.assert_allclose(z.position[0], np.array([0.7, -0.1, 0.2]) + velocity * 0.005, rtol=1e-12)
    opening, first, second = z.separation[0] @ np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1.0]]).T
    normal, along, across = pull(opening, first, second)
    np.testing.assert_allclose(z.force[0], 0.01 * np.array([along, normal, across]), rtol=1e-12)


def test_forces_are_equal_and_opposite_and_go_by_weight_and_mass(tmp_path):
    zones, nodal = scene(tmp_path)
    nodal.velocity[1] = [0.0, 0.1, 0.0]
    nodal.mass[0, GRID.flat(1, 1, 0)] = 1e-200
    before = zones.zones.position[0].copy()
    step(zones, nodal, 0.01)
    force = zones.zones.force[0]
    assert force[1] > 0.0
    np.testing.assert_allclose(nodal.external_force[0].sum(axis=0), force, rtol=1e-12)
    np.testing.assert_allclose(nodal.external_force[1].sum(axis=0), -force, rtol=1e-12)
    assert not nodal.external_force[0, GRID.flat(1, 1, 0), 1] > 1e-100
    x = GRID.node_positions()
    weights = np.clip(1 - np.abs(x - before) / 0.5, 0, None).prod(axis=1) * nodal.mass[1]
    np.testing.assert_allclose(nodal.external_force[1, :, 1], -force[1] * weights / weights.sum(), rtol=1e-9)


def test_velocity_is_that_of_the_nodes_with_mass(tmp_path):
    zones, nodal = scene(tmp_path)
    nodal.mass[1] = 1e-200
    some = GRID.flat(1, 1, 0)
    nodal.mass[1, some], nodal.velocity[1] = 1.0, [9.0, 9.0, 9.0]
    nodal.velocity[1, some] = [0.1, 0.0, 0.0]
    step(zones, nodal, 0.01)
    np.testing.assert_allclose(zones.zones.top_displacement[0], [1e-3, 0, 0], rtol=1e-12)


def test_a_failed_zone_lets_go_while_it_opens(tmp_path):
    zones, nodal = scene(tmp_path)
    nodal.velocity[1] = [0.0, 1.0, 0.0]
    step(zones, nodal, 9e-3)
    assert zones.zones.failed[0] == 1
    full = 0.01 * pull(9e-3)[0]
    assert zones.zones.force[0, 1] == pytest.approx(full, rel=1e-12)
    nodal.velocity[1] = 0.0
    step(zones, nodal, 1e-3)
    assert zones.zones.failed[0] == 2
    assert zones.zones.force[0, 1] == pytest.approx(full * (1 - 2 / STEPS_TO_RELEASE), rel=1e-12)
    nodal.velocity[1] = [0.0, -1.0, 0.0]
    step(zones, nodal, 1e-3)
    assert zones.zones.failed[0] == 2
    nodal.velocity[1] = 0.0
    zones.zones.failed[0] = STEPS_TO_RELEASE
    step(zones, nodal, 1e-3)
    assert zones.zones.failed[0] == STEPS_TO_RELEASE
    np.testing.assert_array_equal(zones.zones.force, 0.0)


def test_a_step_that_is_repeated_moves_zones_once(tmp_path):
    zones, nodal = scene(tmp_path)
    nodal.velocity[:] = [0.0, 0.1, 0.0]
    zones.act(GRID, nodal, 0.01, nodal.external_force)
    step(zones, nodal, 0.005)
    assert zones.zones.position[0, 1] == pytest.approx(-0.1 + 5e-4, rel=1e-12)
    zones.settle(GRID)
    assert zones.zones.position[0, 1] == pytest.approx(-0.1 + 5e-4, rel=1e-12)


def test_zones_that_leave_the_domain_are_gone(tmp_path):
    zones, nodal = scene(tmp_path, ROW + "1.9 0.9 0.2 0.01 0 1 0 1 0 0 0 1\n")
    nodal.velocity[:] = [0.0, 10.0, 0.0]
    step(zones, nodal, 0.02)
    assert len(zones.zones.area) == 1
    step(zones, nodal, 0.5)
    step(zones, nodal, 0.5)
    assert len(zones.zones.area) == 0


def test_a_body_that_is_gone_is_not_pulled_and_does_not_pull(tmp_path):
    zones, nodal = scene(tmp_path)
    nodal.velocity[1] = [0.0, 0.1, 0.0]
    step(zones, nodal, 0.01)
    assert zones.zones.force[0, 1] > 0.0
    nodal.mass[1] = 1e-200
    step(zones, nodal, 0.01)
    assert np.abs(nodal.external_force).max() == 0.0


def test_zones_go_round_where_the_domain_repeats():
    """In a domain of 2 x 2 x 1 that repeats in x, a zone in the last cell acts on the first node too."""
    grid = Grid((0.0, -1.0, 0.0), (0.5, 0.5, 0.5), (4, 4, 2), (0, 1, 1), (1, 0, 0), GRID.patches)
    nodal = new_nodal_fields(grid, 2)
    nodal.mass[:] = 1.0
    nodal.velocity[1] = [1.0, 0.0, 0.0]
    state = new_arrays(ZoneState, 1)
    state.position[:], state.area[:], state.top[:] = [1.9, 0.1, 0.2], 0.01, 1
    state.normal[:], state.tangent[:] = [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]
    zones = CohesiveZones(LAW, state)
    step(zones, nodal, 1e-3, grid)
    force = zones.zones.force[0]
    np.testing.assert_allclose(nodal.external_force[0].sum(axis=0), force, rtol=1e-12)
    assert (
        nodal.external_force[0, grid.flat(0, 2, 0), 0]
        > 0.5 * nodal.external_force[0, grid.flat(3, 2, 0), 0]
        > 0
    )
    assert nodal.external_force[0, grid.flat(4, 2, 0), 0] == 0.0
    nodal.velocity[:] = [1.0, 0.0, 0.0]
    step(zones, nodal, 0.2, grid)
    assert zones.zones.position[0, 0] == pytest.approx(0.1005)


@pytest.mark.parametrize("spin", [[0.0, 0.0, 2.0], [1.0, -0.5, 0.7]])
def test_a_zone_turns_rigidly_with_its_bodies(tmp_path, spin):
    """In a rigid rotation normal, tangent and separation turn by its angle, and tractions stay what they were."""
    nodal = new_nodal_fields(GRID, 2)
    nodal.mass[:] = 1.5
    zones = CohesiveZones(LAW._replace(do_rotation=True), zones_of(tmp_path, ROW))
    nodal.velocity[1] = [1.0, 2.0, -1.0]
    step(zones, nodal, 1e-3)
    before = zones.zones
    nodal.velocity[:] = np.cross(spin, GRID.node_positions())
    for _ in range(50):
        step(zones, nodal, 1e-2)
    Q = Rotation.from_rotvec(0.5 * np.array(spin)).as_matrix()
    for name in ("normal", "tangent", "separation", "force"):
        turned = getattr(before, name) @ Q.T
        np.testing.assert_allclose(getattr(zones.zones, name), turned, atol=1e-9 * np.abs(turned).max())


# ---- files -------------------------------------------------------------------------------------------------


def test_file(tmp_path):
    outside = "7 0 0 0.01 0 1 0 1 0 0 0 1\n"
    z = zones_of(tmp_path, ROW + outside + "0.6 -0.2 0.1 0.02 0 0 1 0 1 0 1 0\n")
    np.testing.assert_array_equal(z.area, [0.01, 0.02])
    np.testing.assert_array_equal(z.bottom, [0, 1])
    np.testing.assert_array_equal(z.top, [1, 0])
    cell = (1 << 16) | (1 << 32)
    np.testing.assert_array_equal(z.id, [cell, cell + 1])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (ROW + "1 2 3\n", "zones.txt:2: expected 12 numbers"),
        (ROW.replace("0 1\n", "0 5\n"), "row 1 names the materials 0 and 5"),
        (ROW.replace("0 1\n", "0.5 1\n"), "row 1 names the materials 0.5 and 1"),
        (ROW + "a\n", "zones.txt:2"),
    ],
)
def test_bad_files(tmp_path, text, message):
    with pytest.raises(ValueError, match=message):
        zones_of(tmp_path, text)


def test_declaration():
    declared = {f.name: f for f in fields(CohesiveZone)}
    assert declared["sig_max"].required
    assert not declared["delta_n_fail"].required
    assert declared["delta_t"].parameter.gt == 0.0
