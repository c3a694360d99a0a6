"""Heat between two half spaces, against the error functions of Carslaw and Jaeger."""

from __future__ import annotations

import numpy as np
import pytest
from heat_reference import COLD, HOT, INTERFACE, exact, nodal_temperature
from shipped_decks import run_shipped

import ups


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> ups.Result:
    return run_shipped("heatTwoMaterials", tmp_path_factory.mktemp("heat"), {"Time/maxTime": 1.62e-7})


def test_the_interface_takes_its_temperature_and_keeps_it(result: ups.Result) -> None:
    assert pytest.approx(375.74, abs=0.01) == INTERFACE
    assert nodal_temperature(result)[40] == pytest.approx(INTERFACE, abs=0.01 * (HOT - COLD))


def test_temperature_follows_the_error_function(result: ups.Result) -> None:
    x = np.linspace(-4.0e-5, 4.0e-5, 81)
    deviation = nodal_temperature(result) - exact(x, float(result["g.temperature"].times[-1]))
    assert np.abs(deviation).max() < 0.03 * (HOT - COLD)
    assert np.sqrt(np.mean(deviation**2)) < 0.01 * (HOT - COLD)


def test_no_heat_is_lost(result: ups.Result) -> None:
    heat = result["ThermalEnergy"]
    assert heat == pytest.approx(heat[0], rel=1e-10)
