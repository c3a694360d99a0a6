"""Conditions on the faces of the domain, node by node."""

from __future__ import annotations

import numpy as np
import pytest
from mpm_cases import make_grid, whole_side

from solver.boundary_conditions import BoundaryConditions, Condition, Region
from solver.grid import FACES, Grid, Patch

CELLS = (4, 3, 5)
WIND = (1.5, -2.0, 0.5)


def random_vectors(grid, seed=0):
    return np.random.default_rng(seed).normal(size=(grid.number_of_nodes, 3))


def lines(grid):
    """Indices (nodes, 3) of the nodes in storage order."""
    return np.rint((grid.node_positions() - grid.anchor) / np.array(grid.spacing)).astype(int)


def within(grid):
    """Whether nodes belong to the domain itself, not to its extra layers."""
    return ((lines(grid) >= 0) & (lines(grid) <= grid.cells)).all(axis=1)


def on_face(grid, face, layer=0):
    """Whether nodes lie on the plane of a face, or ``layer`` planes further out."""
    axis, plus = FACES.index(face) // 2, face.endswith("+")
    return lines(grid)[:, axis] == (grid.cells[axis] + layer if plus else -layer)


def inwards(grid, face, layers=1):
    """What to add to a node's index to move away from a face into the domain."""
    axis, plus = FACES.index(face) // 2, face.endswith("+")
    stride = [1, grid.index.nodes[0], grid.index.nodes[0] * grid.index.nodes[1]][axis]
    return -layers * stride if plus else layers * stride


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("extra_nodes", [False, True], ids=["linear", "gimp"])
def test_prescribed_velocity_holds_on_the_face_and_its_extra_layer(face, extra_nodes):
    grid = make_grid(CELLS, extra=(int(extra_nodes),) * 3)
    velocity = random_vectors(grid)
    expected = velocity.copy()
    expected[on_face(grid, face) & within(grid)] = WIND
    if extra_nodes:
        expected[on_face(grid, face, layer=1)] = WIND
    BoundaryConditions(
        [whole_side(face, "Velocity", "Dirichlet", WIND)], grid, 1, extra_nodes
    ).apply_velocity(velocity, 0)
    np.testing.assert_array_equal(velocity, expected)


@pytest.mark.parametrize("face", FACES)
def test_symmetry_without_extra_nodes_stops_motion_through_the_face(face):
    grid = make_grid(CELLS, extra=(0, 0, 0))
    velocity = random_vectors(grid)
    expected = velocity.copy()
    expected[on_face(grid, face), FACES.index(face) // 2] = 0.0
    BoundaryConditions([whole_side(face, "Symmetric", "symmetry")], grid, 1, False).apply_symmetry(
        velocity, 0
    )
    np.testing.assert_array_equal(velocity, expected)


@pytest.mark.parametrize("cells", [CELLS, (4, 3, 1)])
@pytest.mark.parametrize("face", FACES)
def test_symmetry_with_extra_nodes_mirrors_the_layer_inside(face, cells):
    """Above z it does so only in a domain one cell thick, as documented."""
    grid = make_grid(cells)
    axis = FACES.index(face) // 2
    velocity = random_vectors(grid)
    expected = velocity.copy()
    expected[on_face(grid, face), axis] = 0.0
    if face != "z+" or cells[2] == 1:
        outer = np.flatnonzero(on_face(grid, face, layer=1))
        mirrored = expected[outer + inwards(grid, face, 2)]
        mirrored[:, axis] *= -1.0
        expected[outer] = mirrored
    BoundaryConditions([whole_side(face, "Symmetric", "symmetry")], grid, 1, True).apply_symmetry(velocity, 0)
    np.testing.assert_array_equal(velocity, expected)


def test_a_mirror_symmetric_field_stays_as_it_is():
    grid = make_grid((4, 3, 1))
    x, y, z = grid.node_positions().T
    velocity = np.stack([x * (2 + y), 1 + x**2 + 0 * y, np.cos(x) + 0 * z], axis=1)
    before = velocity.copy()
    BoundaryConditions([whole_side("x-", "Symmetric", "symmetry")], grid, 1, True).apply_symmetry(velocity, 0)
    np.testing.assert_allclose(velocity, before, atol=1e-15)


@pytest.mark.parametrize("extra_nodes", [False, True])
def test_where_faces_meet_the_later_face_wins(extra_nodes):
    grid = make_grid(CELLS, extra=(int(extra_nodes),) * 3)
    regions = [
        whole_side("y-", "Velocity", "Dirichlet", (2.0,) * 3),
        whole_side("x-", "Velocity", "Dirichlet", (1.0,) * 3),
    ]
    velocity = np.zeros((grid.number_of_nodes, 3))
    BoundaryConditions(regions, grid, 1, extra_nodes).apply_velocity(velocity, 0)
    assert (velocity[grid.flat(0, 0, 1)] == 2.0).all()
    assert (velocity[grid.flat(0, 1, 1)] == 1.0).all()
    if extra_nodes:
        assert (velocity[grid.flat(-1, -1, 1)] == 2.0).all()


def in_circle(points):
    return np.hypot(points[:, 1] - 1.5, points[:, 2] - 2.5) < 1.2


def test_a_circle_and_the_rest_of_the_side():
    grid = make_grid(CELLS, extra=(0, 0, 0))
    regions = [
        Region("x-", (Condition("Velocity", "Dirichlet", -1, (1.0, 1.0, 1.0)),), in_circle),
        whole_side("x-", "Velocity", "Dirichlet", (2.0, 2.0, 2.0)),
    ]
    face = on_face(grid, "x-")
    inside = face & in_circle(grid.node_positions())
    assert 0 < inside.sum() < face.sum()
    for order in (regions, regions[::-1]):
        velocity = np.zeros((grid.number_of_nodes, 3))
        BoundaryConditions(order, grid, 1, False).apply_velocity(velocity, 0)
        np.testing.assert_array_equal(velocity[:, 0], 1.0 * inside + 2.0 * (face & ~inside))


def test_a_circle_sets_the_whole_extra_layer():
    """Uintah sets all extra nodes of a face whatever part of it a condition covers."""
    grid = make_grid(CELLS)
    region = Region("x-", (Condition("Velocity", "Dirichlet", -1, WIND),), in_circle)
    velocity = np.zeros((grid.number_of_nodes, 3))
    BoundaryConditions([region], grid, 1, True).apply_velocity(velocity, 0)
    inside = on_face(grid, "x-") & within(grid) & in_circle(grid.node_positions())
    expected = np.where((inside | on_face(grid, "x-", layer=1))[:, None], WIND, 0.0)
    np.testing.assert_array_equal(velocity, expected)


def test_a_condition_of_a_material_goes_before_that_of_all():
    grid = make_grid(CELLS, extra=(0, 0, 0))
    conditions = (
        Condition("Velocity", "Dirichlet", 1, (1.0,) * 3),
        Condition("Velocity", "Dirichlet", -1, (3.0,) * 3),
    )
    for order in (conditions, conditions[::-1]):
        boundary = BoundaryConditions([Region("z+", order)], grid, 2, False)
        fields = np.zeros((2, grid.number_of_nodes, 3))
        for material in range(2):
            boundary.apply_velocity(fields[material], material)
        assert (fields[0][on_face(grid, "z+")] == 3.0).all()
        assert (fields[1][on_face(grid, "z+")] == 1.0).all()


def test_a_material_without_conditions_is_left_alone():
    grid = make_grid(CELLS)
    boundary = BoundaryConditions(
        [whole_side("x-", "Velocity", "Dirichlet", WIND, material=0)], grid, 2, True
    )
    velocity = random_vectors(grid)
    before = velocity.copy()
    boundary.apply_velocity(velocity, 1)
    boundary.apply_symmetry(velocity, 0)
    np.testing.assert_array_equal(velocity, before)


@pytest.mark.parametrize("label", ["Velocity", "Symmetric", "Pressure"])
def test_conditions_on_gradients_of_motion_have_no_effect(label):
    grid = make_grid(CELLS)
    boundary = BoundaryConditions([whole_side("x-", label, "Neumann", WIND)], grid, 1, True)
    velocity = random_vectors(grid)
    before = velocity.copy()
    boundary.apply_velocity(velocity, 0)
    boundary.apply_symmetry(velocity, 0)
    np.testing.assert_array_equal(velocity, before)


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("extra_nodes", [False, True], ids=["linear", "gimp"])
def test_prescribed_temperature(face, extra_nodes):
    grid = make_grid(CELLS, extra=(int(extra_nodes),) * 3)
    temperature = random_vectors(grid)[:, 0].copy()
    expected = temperature.copy()
    expected[on_face(grid, face) & within(grid)] = 350.0
    if extra_nodes:
        expected[on_face(grid, face, layer=1)] = 350.0
    boundary = BoundaryConditions([whole_side(face, "Temperature", "Dirichlet", 350.0)], grid, 1, extra_nodes)
    boundary.apply_temperature(temperature, 0)
    np.testing.assert_array_equal(temperature, expected)


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("extra_nodes", [False, True], ids=["linear", "gimp"])
def test_prescribed_gradient_of_temperature(face, extra_nodes):
    """On the face T is that of the node inside less gradient times spacing; the extra layer follows it."""
    grid = make_grid(CELLS, (0.5, 0.25, 2.0), extra=(int(extra_nodes),) * 3)
    drop = 8.0 * grid.spacing[FACES.index(face) // 2]
    temperature = random_vectors(grid)[:, 0].copy()
    expected = temperature.copy()
    inner = np.flatnonzero(on_face(grid, face) & within(grid))
    expected[inner] = temperature[inner + inwards(grid, face)] - drop
    if extra_nodes:
        outer = np.flatnonzero(on_face(grid, face, layer=1))
        expected[outer] = expected[outer + inwards(grid, face)] - drop
    boundary = BoundaryConditions([whole_side(face, "Temperature", "Neumann", 8.0)], grid, 1, extra_nodes)
    boundary.apply_temperature(temperature, 0)
    np.testing.assert_array_equal(temperature, expected)


def test_faces_across_which_the_domain_repeats_have_no_conditions():
    grid = make_grid(CELLS, periodic=(1, 0, 0))
    regions = [whole_side(face, "Velocity", "Dirichlet", WIND) for face in ("x-", "x+")]
    velocity = random_vectors(grid)
    before = velocity.copy()
    BoundaryConditions(regions, grid, 1, True).apply_velocity(velocity, 0)
    np.testing.assert_array_equal(velocity, before)


def every_condition():
    regions = [whole_side(f, "Symmetric", "symmetry") for f in ("x-", "y+", "z-", "z+")]
    regions += [whole_side(f, "Velocity", "Dirichlet", WIND) for f in ("x+", "y-")]
    regions += [Region("x+", (Condition("Velocity", "Dirichlet", -1, (7.0, 7.0, 7.0)),), in_circle)]
    regions += [
        whole_side("x-", "Temperature", "Neumann", 3.0),
        whole_side("z+", "Temperature", "Dirichlet", 9.0),
    ]
    return regions


@pytest.mark.parametrize("patches", [(2, 1, 1), (1, 3, 1), (1, 1, 2), (2, 3, 2)])
@pytest.mark.parametrize("extra_nodes", [False, True], ids=["linear", "gimp"])
def test_patches_do_not_matter(patches, extra_nodes):
    answers = []
    for cut in ((1, 1, 1), patches):
        grid = make_grid(CELLS, extra=(int(extra_nodes),) * 3, patches=cut)
        boundary = BoundaryConditions(every_condition(), grid, 1, extra_nodes)
        velocity, temperature = random_vectors(grid), random_vectors(grid, 1)[:, 0].copy()
        boundary.apply_velocity(velocity, 0)
        boundary.apply_symmetry(velocity, 0)
        boundary.apply_temperature(temperature, 0)
        answers.append((velocity, temperature, boundary.node_to_cell_weight()))
    for one, several in zip(*answers, strict=True):
        np.testing.assert_array_equal(several, one)


def test_conditions_on_a_domain_that_is_no_box_reach_each_boundary_patch():
    corners = [((0, 0, 0), (2, 2, 1)), ((0, 2, 0), (2, 4, 1)), ((2, 2, 0), (4, 4, 1))]
    patches = tuple(Patch(n, low, high) for n, (low, high) in enumerate(corners))
    grid = Grid((0.0,) * 3, (1.0,) * 3, (4, 4, 1), (0, 0, 0), (0, 0, 0), patches)
    velocity = np.zeros((grid.number_of_nodes, 3))
    BoundaryConditions(
        [whole_side("y-", "Velocity", "Dirichlet", (1.0,) * 3)], grid, 1, False
    ).apply_velocity(velocity, 0)
    i, j, _ = lines(grid).T
    expected = ((j == 0) & (i <= 2)) | ((j == 2) & (i >= 2))
    np.testing.assert_array_equal(velocity[:, 0] == 1.0, expected)


def test_node_weights_double_on_each_symmetry_face():
    grid = make_grid((3, 3, 3))
    regions = [whole_side(f, "Symmetric", "symmetry") for f in ("x-", "y-", "z-")]
    weight = grid.as_box(BoundaryConditions(regions, grid, 1, True).node_to_cell_weight())
    assert weight[2, 2, 2] == 0.125
    assert weight[1, 2, 2] == 0.25
    assert weight[1, 1, 2] == 0.5
    assert weight[1, 1, 1] == 1.0
    assert weight[4, 4, 4] == 0.125
