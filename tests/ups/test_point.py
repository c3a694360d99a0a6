"""``run_point``: a material of a deck or of the catalogue along a strain path, and what is written of it."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("numba")

from ups.diagnostics import DeckError
from ups.materials import catalogue
from ups.point import catalogue_material, columns, plot_history, print_history, run_point, write_csv

SHARED = Path(__file__).resolve().parents[3] / "shared" / "reference"

DECK = """<Uintah_specification>
  <SimulationComponent type="mpm"/>
  <Time><maxTime>1</maxTime><initTime>0</initTime><delt_min>0</delt_min><delt_max>1</delt_max>
    <timestep_multiplier>0.5</timestep_multiplier></Time>
  <Grid><Level><Box label="1"><lower>[0,0,0]</lower><upper>[1,1,1]</upper>
    <resolution>[2,2,2]</resolution></Box></Level></Grid>
  <DataArchiver><filebase>x.uda</filebase></DataArchiver>
  <MaterialProperties><MPM>
    <material><density>1000</density><thermal_conductivity>1</thermal_conductivity>
      <specific_heat>5</specific_heat><room_temp>300</room_temp>
      <constitutive_model type="hypo_elastic"><G>3.0e9</G><K>5.0e9</K></constitutive_model>
      <geom_object><box label="b"><min>[0,0,0]</min><max>[1,1,1]</max></box><res>[1,1,1]</res>
        <velocity>[0,0,0]</velocity><temperature>300</temperature></geom_object></material>
  </MPM></MaterialProperties>
</Uintah_specification>
"""


@pytest.fixture
def deck(tmp_path):
    path = tmp_path / "elastic.ups"
    path.write_text(DECK)
    return path


@pytest.fixture
def history(deck):
    return run_point(deck, mode="uniaxial-strain", strain=0.1, strain_rate=10.0, steps=5)


def code(action):
    """The code of the diagnostic that an action raises."""
    with pytest.raises(DeckError) as caught:
        action()
    return next(iter(caught.value.diagnostics)).code


def test_a_material_of_a_deck(history):
    assert history.stress[-1, 0, 0] == pytest.approx((5.0e9 + 4.0e9) * 0.1, rel=1e-12)
    assert history.temperature[0] == 300.0


def test_a_table_of_deformation(deck, tmp_path):
    table = tmp_path / "path.txt"
    table.write_text("# t F\n0 1 0 0 0 1 0 0 0 1\n2 1.2 0 0 0 1 0 0 0 1\n")
    history = run_point(deck, table=table, steps=50)
    assert history.time[-1] == 2.0
    assert history.stress[-1, 0, 0] == pytest.approx(9.0e9 * np.log(1.2), rel=1e-12)


def test_copper_at_4000_per_second_and_696_kelvin():
    """Johnson and Cook's closed form at the plastic strain and temperature that the point has.

    sigma = (A + B ep^n) (1 + C ln r) (1 - T*^m); the stress follows the flow stress of the step before it.
    """
    history = run_point(
        "OFHC copper", strain=0.3, strain_rate=4000.0, temperature=696.0, models={"eos": "default_hypo"}
    )
    ep, T = history.plastic_strain, history.temperature
    flow = (90.0e6 + 292.0e6 * ep**0.31) * (1 + 0.025 * np.log(4000.0))
    flow *= 1 - ((T - 298.0) / (1356.0 - 298.0)) ** 1.09
    late = ep > 0.02
    np.testing.assert_allclose(history.equivalent_stress[late], flow[late], rtol=5e-3)
    work = np.trapezoid(history.equivalent_stress, ep)
    assert T[-1] - 696.0 == pytest.approx(0.9 * work / (8960.0 * 383.0), rel=2e-2)


@pytest.mark.skipif(not SHARED.is_dir(), reason="the reference runs are not here")
@pytest.mark.parametrize("model", ["jc", pytest.param("mts", marks=pytest.mark.slow)])
def test_heating_of_copper_in_sus(model):
    """The one-element copper tests end in free vibration: temperatures agree at equal plastic strain.

    The element starts under 4000/s uniaxial strain, so a few kelvin of the rise are elastic.
    """
    reference = np.load(SHARED / f"adi_cu_{model}" / "particles.npz")
    last = sorted({name.split("/")[0] for name in reference})[-1]
    ep, T = (reference[f"{last}/1/{name}"][0] for name in ("p.plasticStrain", "p.temperature"))
    history = run_point(
        SHARED / f"adi_cu_{model}" / "deck.ups", material=1, strain=0.6, strain_rate=3000.0, temperature=696.0
    )
    rise = np.interp(ep, history.plastic_strain, history.temperature) - 696.0
    assert rise == pytest.approx(T - 696.0, rel=0.1)


def test_every_material_can_be_built_with_each_of_its_flow_models():
    built = 0
    for entry in catalogue():
        for flow in entry.models.get("flow_model", ()):
            section = catalogue_material(entry.name, {"flow": flow})
            assert section.constitutive_model.yield_condition is not None
            built += 1
    assert built >= 18
    assert type(catalogue_material("PBX 9501").constitutive_model).__name__ == "ViscoScram"


def test_flow_stresses_are_of_the_order_of_metals_and_grow_with_strain():
    from solver.materials.flow_stress import flow_stress
    from solver.materials.plasticity_state import PlasticityState

    for entry in catalogue():
        for flow in entry.models.get("flow_model", ()):
            section = catalogue_material(entry.name, {"flow": flow})
            model = section.constitutive_model
            states = [
                PlasticityState(
                    ep,
                    1000.0,
                    1000.0,
                    300.0,
                    0.0,
                    section.density,
                    section.density,
                    0.0,
                    model.bulk_modulus,
                    model.shear_modulus,
                    section.melt_temp,
                    section.specific_heat,
                )
                for ep in (0.01, 0.3)
            ]
            small, large = (flow_stress(model.flow_model, state) for state in states)
            assert 3.0e7 < small <= large < 4.0e9, (entry.name, flow)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "flow"), [(e.name, flow) for e in catalogue() for flow in e.models.get("flow_model", ("",))]
)
def test_every_material_is_compressed_to_a_tenth(name, flow):
    """Stress is compressive and of the order of the flow stress; plastic work heats."""
    history = run_point(
        name, strain=-0.1, strain_rate=1000.0, steps=400, models={"flow": flow} if flow else None
    )
    assert -4.0e9 < history.stress[-1, 0, 0] < -1.0e6
    left = np.abs(history.stress[-1, 1, 1] / history.stress[-1, 0, 0])
    assert left < 0.02  # the return to the yield surface ends within a thousandth or jumps past zero
    if history.plastic_strain is not None:
        assert 0.05 < history.plastic_strain[-1] < 0.1
        assert history.temperature[-1] > history.temperature[0]


def test_models_that_belong_together_are_chosen_together():
    assert (
        type(
            catalogue_material(
                "annealed copper", {"flow": "mts_model"}
            ).constitutive_model.shear_modulus_model
        ).__name__
        == "MechanicalThresholdShear"
    )
    chosen = catalogue_material("annealed copper", {"flow": "mts_model", "shear": "np_shear"})
    assert type(chosen.constitutive_model.shear_modulus_model).__name__ == "NadalLePoacShear"
    heated = catalogue_material("annealed copper", {"specific_heat": "copper_Cp"}).constitutive_model
    assert heated.compute_specific_heat
    assert type(heated.specific_heat_model).__name__ == "CopperSpecificHeat"


def test_csv_holds_every_column(history, tmp_path):
    path = tmp_path / "out.csv"
    write_csv(history, path)
    with path.open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 6
    assert float(rows[-1]["stress_xx"]) == history.stress[-1, 0, 0]
    assert float(rows[-1]["F_xx"]) == pytest.approx(np.exp(0.1))
    assert set(rows[0]) == set(columns(history))


def test_a_plot_is_a_png(history, tmp_path):
    path = tmp_path / "out.png"
    plot_history(history, path, "elastic")
    assert path.read_bytes().startswith(b"\x89PNG")


def test_the_table_shows_start_and_end(history):
    out = io.StringIO()
    print_history(history, file=out)
    assert " 600 " in out.getvalue()  # 2 G ln F, MPa
    assert " -500 " in out.getvalue()  # -K ln F


def test_faults_are_diagnostics(deck, history, tmp_path):
    bad = tmp_path / "bad.txt"
    bad.write_text("0 1 2\n")
    words = tmp_path / "words.txt"
    words.write_text("zero one\n")
    assert code(lambda: run_point("unobtainium")) == "UPS410"
    assert code(lambda: run_point(deck, material=3)) == "UPS402"
    assert code(lambda: run_point(deck, material=-1)) == "UPS402"
    assert code(lambda: run_point(deck, mode="sideways")) == "UPS209"
    assert code(lambda: run_point(deck, models={"flow": "johnson_cook"})) == "UPS410"
    assert code(lambda: run_point("tantalum", models={"flow": "johnson_cook"})) == "UPS209"
    assert code(lambda: run_point("tantalum", models={"flaw": "johnson_cook"})) == "UPS410"
    assert code(lambda: run_point("PBX 9501", models={"flow": "johnson_cook"})) == "UPS410"
    assert code(lambda: run_point(deck, strain=0.0)) == "UPS601"
    assert code(lambda: run_point(deck, table=tmp_path / "none.txt")) == "UPS408"
    assert code(lambda: run_point(deck, table=bad)) == "UPS207"
    assert code(lambda: run_point(deck, table=words)) == "UPS203"
    assert code(lambda: run_point(tmp_path / "none.ups")) == "UPS001"
    assert code(lambda: write_csv(history, tmp_path / "no" / "out.csv")) == "UPS408"
    assert code(lambda: plot_history(history, tmp_path / "no" / "out.png")) == "UPS408"
