"""Every constitutive model, from its tag, along every strain path: what is looked at before hours are spent.

The update runs as plain Python here, which is what numba compiles; that both agree is tested model by model.
"""

from __future__ import annotations

import csv

import numpy as np
import pytest

pytest.importorskip("numba")

from model_samples import SAMPLES

import solver.point_driver
from solver.declare import FAMILIES
from ups.diagnostics import DeckError
from ups.point import MODES, columns, plot_history, run_point, write_csv

DECK = """<Uintah_specification>
  <SimulationComponent type="mpm"/>
  <Time><maxTime>1</maxTime><initTime>0</initTime><delt_min>0</delt_min><delt_max>1</delt_max>
    <timestep_multiplier>0.5</timestep_multiplier></Time>
  <Grid><Level><Box label="1"><lower>[0,0,0]</lower><upper>[1,1,1]</upper>
    <resolution>[2,2,2]</resolution></Box></Level></Grid>
  <DataArchiver><filebase>x.uda</filebase></DataArchiver>
  <MaterialProperties><MPM>
    <material><density>1000</density><thermal_conductivity>1</thermal_conductivity>
      <specific_heat>500</specific_heat><room_temp>300</room_temp>
      <constitutive_model type="{model}">{constants}</constitutive_model>
      <geom_object><box label="b"><min>[0,0,0]</min><max>[1,1,1]</max></box><res>[1,1,1]</res>
        <velocity>[0,0,0]</velocity><temperature>300</temperature></geom_object></material>
  </MPM></MaterialProperties>
</Uintah_specification>
"""
FLUIDS = {"water", "TH_water", "murnaghanMPM", "ideal_gas", "program_burn", "jwlpp_mpm", "rigid"}
"""Models without strength: nothing that is stretched in one direction has to be stress-free in the others."""

BURNING = {"program_burn", "jwlpp_mpm"}
"""Models that bring energy of their own."""


@pytest.fixture(autouse=True)
def plain_python(monkeypatch):
    """Update the point without compiling."""
    plain = solver.point_driver.update_trials.py_func
    monkeypatch.setattr(solver.point_driver, "update_trials", plain)


@pytest.fixture
def deck(tmp_path):
    def write(model):
        path = tmp_path / f"{model}.ups"
        path.write_text(DECK.format(model=model, constants=SAMPLES[model]))
        return path

    return write


def test_there_is_a_sample_of_every_model():
    assert SAMPLES.keys() == FAMILIES["constitutive_model"].models.keys()


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("model", SAMPLES)
def test_every_model_answers_every_path(model, mode, deck):
    # stress by bisection of a return that jumps takes long in plain Python: rock stays elastic there
    elastic = mode == "uniaxial-stress" and model.startswith("Arenisca")
    strain = -0.0001 if elastic else -0.02
    history = run_point(deck(model), mode=mode, strain=strain, strain_rate=100.0, steps=8)
    assert np.isfinite(history.stress).all()
    assert history.temperature[-1] > 250.0
    assert all(np.isfinite(values).all() for values in history.state.values())
    assert history.stress[-1].any() or model in ("rigid",) or mode in ("uniaxial-stress", "simple-shear")
    if mode == "uniaxial-stress" and model not in FLUIDS:
        lateral = np.abs(history.stress[1:, [1, 2], [1, 2]])
        assert (lateral <= 1e-6 * np.abs(history.stress).max() + 1e-3).mean() > 0.8  # all but a jump at yield
        assert history.stress[-1, 0, 0] < 0.0
    if mode == "hydrostatic" and model != "rigid":
        # a gas, and what starts in a pressure of its own, has one to begin with
        assert history.pressure[-1] > history.pressure[0]


@pytest.mark.parametrize("model", SAMPLES)
def test_every_model_goes_through_a_closed_cycle(model, deck):
    history = run_point(
        deck(model), mode="uniaxial-strain", strain=(-0.004, 0.002, 0.0), strain_rate=50.0, steps=24
    )
    np.testing.assert_allclose(history.strain[[8, 20, 24]], [-0.004, 0.002, 0.0], atol=1e-12)
    np.testing.assert_allclose(history.deformation_gradient[-1], np.eye(3), atol=1e-12)
    assert np.isfinite(history.stress).all()
    if model in BURNING:
        return
    stress = history.stress[:, 0, 0]
    work = np.cumsum(0.5 * (stress[1:] + stress[:-1]) * np.diff(history.strain))
    lag = np.abs(np.diff(stress)).max() * np.abs(np.diff(history.strain)).max()
    # a cycle makes no energy, but for the error of the trapezia, and in a gas heat that comes a step late
    error = 0.25 if model == "ideal_gas" else 0.02
    assert work[-1] >= -error * np.abs(work).max() - lag


@pytest.mark.parametrize("model", ["comp_neo_hook_plastic", "camclay", "trans_iso_hyper"])
def test_any_table_of_deformation(model, deck, tmp_path):
    twist = np.array([[1.0, 0.03, 0.0], [-0.01, 0.98, 0.02], [0.0, 0.0, 1.01]])
    rows = [[0.0, *np.eye(3).ravel()], [1e-3, *twist.ravel()], [2e-3, *np.eye(3).ravel()]]
    table = tmp_path / "path.txt"
    np.savetxt(table, rows)
    history = run_point(deck(model), table=table, steps=20)
    np.testing.assert_allclose(history.deformation_gradient[10], twist, atol=1e-12)
    assert np.isfinite(history.stress).all()


@pytest.mark.parametrize("model", SAMPLES)
def test_stress_temperature_and_state_are_written(model, deck, tmp_path):
    history = run_point(deck(model), mode="uniaxial-strain", strain=-0.01, strain_rate=10.0, steps=3)
    write_csv(history, tmp_path / "point.csv")
    with (tmp_path / "point.csv").open() as file:
        rows = list(csv.reader(file))
    assert rows[0] == list(columns(history))
    assert len(rows) == 5
    assert {"time", "strain", "temperature", "stress_xx", "F_zz"} <= set(rows[0])
    state = [name for name in history.state if name not in rows[0]]
    assert all(f"{name}_xx" in rows[0] or f"{name}_x" in rows[0] for name in state)


def test_a_picture(deck, tmp_path):
    history = run_point(
        deck("camclay"), mode="simple-shear", strain=(0.1, -0.1, 0.0), strain_rate=1.0, steps=30
    )
    plot_history(history, tmp_path / "clay.png", "clay")
    assert (tmp_path / "clay.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("strain", [(0.1, 0.1), (0.1, 0.2, 0.3, 0.0), ()])
def test_paths_that_make_no_sense(deck, strain):
    with pytest.raises(DeckError):
        run_point(deck("hypo_elastic"), strain=strain, steps=3)
