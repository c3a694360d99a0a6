"""Lithium that enters a film, against Carslaw and Jaeger, and the stress that it makes."""

from __future__ import annotations

import numpy as np
import pytest
from film_reference import FLUX, THICKNESS, concentration, displacement, stress_in_plane
from shipped_decks import run_shipped

import ups


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> ups.Result:
    return run_shipped("siliconFilm", tmp_path_factory.mktemp("film"), {"Time/maxTime": 16.0})


def test_all_that_enters_stays(result: ups.Result) -> None:
    mean = result["p.concentration"][-1].mean()
    assert mean == pytest.approx(FLUX * result["p.x"].times[-1] / THICKNESS, rel=0.01)  # the film has grown


def test_the_concentration_follows_the_series(result: ups.Result) -> None:
    time = float(result["p.x"].times[-1])
    nodes = result["g.concentration"][-1][1:21, 1, 1]
    expected = concentration(np.linspace(0.0, 0.95 * THICKNESS, 20), time)
    np.testing.assert_allclose(nodes, expected, atol=0.02 * expected.max())


def test_the_film_is_pressed_where_lithium_is(result: ups.Result) -> None:
    c, stress = result["p.concentration"][-1], result["p.stress"][-1]
    expected = stress_in_plane(c)
    np.testing.assert_allclose(stress[:, 1, 1], expected, atol=0.05 * np.abs(expected).max())
    np.testing.assert_allclose(stress[:, 2, 2], stress[:, 1, 1], rtol=1e-9)
    assert np.abs(stress[:, 0, 0]).max() < 0.1 * np.abs(stress[:, 1, 1]).max()


def test_the_film_grows_thicker(result: ups.Result) -> None:
    time = float(result["p.x"].times[-1])
    moved = result["p.displacement"][-1][:, 0]
    depth = result["p.x"][-1][:, 0] - moved
    expected = [displacement(x, time) for x in depth]
    np.testing.assert_allclose(moved, expected, atol=0.03 * max(expected))
