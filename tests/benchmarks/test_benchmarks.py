"""The benchmarks measure what they say: decks, medians, ratios, history and picture."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks import history, memory, suite
from benchmarks.__main__ import as_json
from benchmarks.block import INTERPOLATORS, MODELS, block_deck, cells_for
from benchmarks.measure import WARM_UP, Sampler, measure
from solver.performance.machine import Calibration, Machine
from solver.performance.phases import Phase
from solver.performance.report import Report, make_report
from solver.performance.work import Work
from ups.deck import read_deck
from ups.factory import build
from ups.run import Run

PAGE = Path(__file__).resolve().parents[2] / "docs" / "performance.md"
MACHINE = Machine(2.4e9, 1.6e9)
SMALL = """<Uintah_specification><SimulationComponent type="mpm"/><Meta><title>small</title></Meta>
<Time><maxTime>1</maxTime><initTime>0</initTime><delt_min>0</delt_min><delt_max>1</delt_max>
<timestep_multiplier>0.1</timestep_multiplier></Time>
<Grid><BoundaryConditions/><Level><Box label="1"><lower>[0,0,0]</lower><upper>[4,4,4]</upper>
<resolution>[4,4,4]</resolution><extraCells>[1,1,1]</extraCells></Box></Level></Grid>
<MPM><interpolator>gimp</interpolator></MPM><PhysicalConstants><gravity>[0,0,0]</gravity></PhysicalConstants>
<MaterialProperties><MPM><material><density>1</density><thermal_conductivity>1</thermal_conductivity>
<specific_heat>1</specific_heat><constitutive_model type="hypo_elastic"><K>1</K><G>1</G></constitutive_model>
<geom_object><box><min>[1,1,1]</min><max>[3,3,3]</max></box><res>[2,2,2]</res><velocity>[0,0,0]</velocity>
<temperature>300</temperature></geom_object></material><contact><type>null</type></contact></MPM></MaterialProperties>
<DataArchiver><filebase>small.uda</filebase><outputTimestepInterval>100</outputTimestepInterval><save label="p.x"/>
</DataArchiver></Uintah_specification>"""


def report(seconds: float, machine: Machine = MACHINE) -> Report:
    """Of 10 particles in 1 step, all of it stress of 48 bytes and 8 operations."""
    times = dict.fromkeys(Phase, 0.0) | {Phase.STRESS: 10 * seconds}
    return make_report(
        times,
        {Phase.STRESS: Work(480.0, 80.0)},
        machine,
        particles=10,
        particle_steps=10,
        steps=1,
        threads=1,
    )


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("interpolator", INTERPOLATORS)
def test_blocks_are_good_decks_of_the_size_asked_for(model: str, interpolator: str) -> None:
    deck = read_deck("block.ups", text=block_deck(model, interpolator, 1728))
    assert [str(d) for d in deck.diagnostics] == []
    (body,) = build(deck).bodies
    assert len(body.particles) == 1728
    assert body.particles.mass.sum() == pytest.approx(8930 * 0.01**3)


def test_sizes_are_met_closely() -> None:
    assert [8 * cells_for(n) ** 3 for n in (64_000, 512_000, 8_000_000)] == [64_000, 512_000, 8_000_000]


def test_a_measurement_has_the_medians_of_its_steps() -> None:
    found = measure(read_deck("small.ups", text=SMALL), steps=5, threads=1)
    assert (found.steps, found.particle_steps) == (5, 5 * 64)
    assert found.phase(Phase.STRESS).bytes == pytest.approx(512)
    assert found.seconds > 0.0
    assert all(limit > 0.0 for limit in found.machine)


def test_warm_up_is_left_out(tmp_path: Path) -> None:
    sampler = Sampler(1)
    deck = read_deck("small.ups", text=SMALL)
    run = Run(build(deck), deck.require().Time, [sampler])
    sampler.begin(run)
    for _ in range(WARM_UP + 2):
        run.simulation.advance(1e-3)
        sampler.after_step(run)
    assert len(sampler.samples) == 2
    assert len(sampler.machines) == 1


def test_the_calibration_finds_a_machine() -> None:
    """No machine is slower than that, or faster."""
    machine = Calibration().measure(1)
    assert 1e8 < machine.bandwidth < 1e13
    assert 1e8 < machine.flops < 1e13


def test_ratios_do_not_depend_on_the_machine() -> None:
    """A triad of 24 bytes lasts 10 ns here, a multiply-add of 16 operations 10 ns."""
    assert history.ratios(report(1e-6)) == pytest.approx((100.0, 100.0))
    assert history.ratios(report(0.5e-6, Machine(4.8e9, 3.2e9))) == pytest.approx((100.0, 100.0))


def test_the_history_grows_and_tells_changes(tmp_path: Path) -> None:
    file = tmp_path / "history.json"
    assert history.last(file) == {}
    history.append("one", {"a": report(1e-6)}, file)
    history.append("two", {"b": report(2e-6)}, file)
    assert history.last(file) == {"a": (100.0, 100.0), "b": (200.0, 200.0)}
    text = history.changes({"a": report(1.25e-6), "c": report(1e-6)}, history.last(file))
    assert "a: 125 triads (+25%), 125 multiply-adds (+25%)" in text
    assert "c: 100 triads, 100 multiply-adds; new" in text


def test_the_kept_history_knows_the_quick_cases() -> None:
    assert {case.name for case in suite.quick_blocks()} <= set(history.last())


def test_results_are_json() -> None:
    results = json.loads(json.dumps(as_json({"a": report(1e-6)})))
    assert results["cases"]["a"]["ratios"]["triads"] == pytest.approx(100.0)
    assert results["machine"]["cores"] >= 1


def test_the_roofline_is_drawn(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from benchmarks.roofline import draw

    draw({"a": report(1e-6)}, tmp_path / "roofline.png")
    assert (tmp_path / "roofline.png").read_bytes().startswith(b"\x89PNG")


def test_reference_decks_are_those_with_particles_enough(shared: Path) -> None:
    names = {case.name for case in suite.reference_decks()}
    assert {"taylor_impact", "foam_crush"} <= names
    assert "const_neo_hookean" not in names


def test_the_page_has_the_bytes_of_every_model() -> None:
    assert memory.table() in PAGE.read_text()
