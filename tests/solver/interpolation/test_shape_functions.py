"""What all interpolators have in common, and their agreement with the dense reference."""

from __future__ import annotations

import numpy as np
import pytest
import reference
from shape_cases import GRID, SIZES, Rows, on_faces, sample_deformations, sample_positions

from solver.declare import FAMILIES
from solver.interpolation.bspline import BSpline
from solver.interpolation.cpdi import Cpdi, CpdiAxisymmetric
from solver.interpolation.cpti import Cpti
from solver.interpolation.gimp import Gimp, GimpAxisymmetric
from solver.interpolation.linear import Linear, LinearAxisymmetric
from solver.interpolation.shape import MOST_NODES

CASES = [
    pytest.param((Linear(), reference.linear), id="linear"),
    pytest.param((Gimp(), reference.gimp), id="gimp"),
    pytest.param((Cpdi(), reference.cpdi), id="cpdi"),
    pytest.param((Cpti(), reference.cpti), id="cpti"),
    pytest.param((BSpline(), reference.bspline), id="bspline"),
]
POSITIONS = np.concatenate([sample_positions(GRID, margin=1.5), on_faces(GRID)])
DEFORMATIONS = np.concatenate([sample_deformations(25), np.broadcast_to(np.eye(3), (64, 3, 3))])


@pytest.fixture(params=CASES, scope="module")
def case(request):
    interpolator, formula = request.param
    rows = Rows(interpolator, GRID, POSITIONS, SIZES, DEFORMATIONS, compiled=True)
    return interpolator, formula, rows


def test_agrees_with_the_equations(case):
    _, formula, rows = case
    size = np.broadcast_to(SIZES, (len(POSITIONS), 3, 3))
    S, G = formula(GRID, POSITIONS, size, DEFORMATIONS)
    got_S, got_G = rows.dense()
    np.testing.assert_allclose(got_S, S, atol=1e-13)
    np.testing.assert_allclose(got_G, G, atol=1e-12)


def test_weights_are_a_partition_of_unity(case):
    S, G = case[2].dense()
    np.testing.assert_allclose(S.sum(axis=1), 1.0, rtol=1e-13)
    np.testing.assert_allclose(G.sum(axis=1), 0.0, atol=1e-12)


def test_linear_fields_are_reproduced(case):
    S, G = case[2].dense()
    nodes = GRID.node_positions()
    np.testing.assert_allclose(S @ nodes, POSITIONS, atol=1e-13)
    np.testing.assert_allclose(
        np.einsum("ni,pnj->pij", nodes, G), np.broadcast_to(np.eye(3), (len(G), 3, 3)), atol=1e-12
    )


def test_weights_are_not_negative_and_few(case):
    rows = case[2]
    assert rows.counts.max() <= MOST_NODES
    assert all((rows.used(p)[1] >= 0.0).all() for p in range(len(POSITIONS)))
    assert all((rows.used(p)[0] >= 0).all() for p in range(len(POSITIONS)))
    assert rows.nodes.max() < GRID.number_of_nodes


def test_python_and_compiled_forms_agree(case):
    interpolator, _, rows = case
    plain = Rows(interpolator, GRID, POSITIONS[20:30], SIZES, DEFORMATIONS[20:30])
    np.testing.assert_array_equal(plain.nodes, rows.nodes[20:30])
    np.testing.assert_allclose(plain.weights, rows.weights[20:30], atol=1e-15)
    np.testing.assert_allclose(plain.gradients, rows.gradients[20:30], atol=1e-13)


@pytest.mark.parametrize("interpolator", [Linear(), Gimp(), BSpline()])
def test_gradients_are_derivatives_of_weights(interpolator):
    positions = sample_positions(GRID, margin=1.5, seed=3)
    step = 1e-6
    _, G = Rows(interpolator, GRID, positions, SIZES).dense()
    for axis in range(3):
        forward, backward = (
            Rows(interpolator, GRID, positions + sign * step * np.eye(3)[axis], SIZES).dense()[0]
            for sign in (1, -1)
        )
        np.testing.assert_allclose(G[..., axis], (forward - backward) / (2 * step), atol=1e-8)


@pytest.mark.parametrize("interpolator", [Gimp(), Cpdi(), BSpline()])
def test_boundary_particles_use_the_layer_of_extra_nodes(interpolator):
    corner = np.array(GRID.anchor) + 0.01 * np.array(GRID.spacing)
    nodes, weights, _ = Rows(interpolator, GRID, corner, SIZES).used(0)
    outside = (GRID.node_positions()[nodes] < np.array(GRID.anchor) - 1e-12).any(axis=1)
    assert weights[outside].sum() > 0.1
    np.testing.assert_allclose(weights.sum(), 1.0)


def test_linear_touches_the_nodes_of_its_cell_alone():
    corner = np.array(GRID.anchor) + 0.01 * np.array(GRID.spacing)
    nodes, _, _ = Rows(Linear(), GRID, corner, SIZES).used(0)
    assert len(nodes) == 8
    assert (GRID.node_positions()[nodes] >= GRID.anchor).all()


@pytest.mark.parametrize(
    ("name", "plane", "body_of_revolution"),
    [
        ("linear", Linear(), LinearAxisymmetric()),
        ("gimp", Gimp(), GimpAxisymmetric()),
        ("cpdi", Cpdi(2.0), CpdiAxisymmetric()),
        ("fast_cpdi", Cpdi(2.0), CpdiAxisymmetric()),
        ("cpti", Cpti(2.0), None),
        ("3rdorderBS", BSpline(), None),
    ],
)
def test_decks_choose_the_form_by_symmetry(name, plane, body_of_revolution):
    record = FAMILIES["interpolator"].models[name]
    chosen = record.for_deck(False, 2.0)
    assert chosen == plane
    assert type(chosen) is type(plane)
    if body_of_revolution is None:
        with pytest.raises(ValueError, match="axisymmetric"):
            record.for_deck(True, 2.0)
    else:
        assert type(record.for_deck(True, 2.0)) is type(body_of_revolution)
