"""What is saved, as what, for which materials, and when: as sus does it."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from small_decks import CONTACT, LEFT, PLASTIC, SAVES, deck, material, write

from solver.domains.exchange import OneRank
from solver.grid import Grid, Patch
from ups.archive import Archive
from ups.deck import Checkpoint, DataArchiver, read_deck
from ups.diagnostics import Diagnostics, Severity
from ups.output import parse_indices, plan_output, reduction_format
from ups.patches import archive_grid
from ups.quantities import on_lattice
from ups.schedule import Schedule
from ups.session import run_deck


def run(tmp_path: Path, text: str) -> Archive:
    return Archive(run_deck(read_deck(write(tmp_path, text)), output=tmp_path / "a.uda").directory)


def planned(tmp_path: Path, text: str) -> tuple[dict[str, tuple[int, ...]], Diagnostics]:
    """Label -> materials of what a deck saves, and what there is to say about it."""
    read = read_deck(write(tmp_path, text))
    plan = plan_output(read.require(), read.reader.place, read.diagnostics)
    return {item.variable.name: item.materials for item in [*plan.fields, *plan.histories]}, read.diagnostics


# ---- when ----


def dumps(schedule: Schedule, times: list[float], last: bool = True) -> list[int]:
    """The steps that are due of those that end at the given times."""
    found = []
    for step, time in enumerate(times, start=1):
        if schedule.due(time, step, 0.0, last and step == len(times)):
            found.append(step)
            schedule.done(time, step, 0.0)
    return found


def section(**values: object) -> DataArchiver:
    return DataArchiver(filebase="a.uda", **values)  # type: ignore[arg-type]  # whatever the test is about


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        # as sus wrote them (t00001, t00004, ... and with the state at the start t00000, t00003, ...)
        ({"outputTimestepInterval": 3}, [1, 4, 7, 10]),
        ({"outputTimestepInterval": 3, "outputInitTimestep": True}, [3, 6, 9]),
        ({"outputTimestepInterval": 3, "outputLastTimestep": True}, [1, 4, 7, 10, 11]),
        # by time: the first step, then the first to reach each multiple; 5 steps of 1, then 6 of 0.25
        ({"outputInterval": 2.0}, [1, 2, 4, 8]),
        ({"outputInterval": 0.1}, list(range(1, 12))),
        ({"outputInterval": 4.0, "outputLastTimestep": True}, [1, 4, 11]),
    ],
)
def test_output_is_due(values: dict[str, object], expected: list[int]) -> None:
    times = [1.0, 2.0, 3.0, 4.0, 5.0, 5.25, 5.5, 6.0, 6.25, 6.5, 6.75]
    schedule = Schedule.of_output(section(**values))
    if values.get("outputInitTimestep"):
        schedule.done(0.0, 0, 0.0)
    assert dumps(schedule, times) == expected


def test_checkpoints_begin_after_a_whole_interval() -> None:
    times = [float(n) for n in range(1, 12)]
    assert dumps(Schedule.of_checkpoints(Checkpoint(timestepInterval=3)), times) == [4, 7, 10]
    assert dumps(Schedule.of_checkpoints(Checkpoint(interval=3.0)), times) == [3, 6, 9]
    assert dumps(Schedule.of_checkpoints(Checkpoint(timestepInterval=9, lastTimestep=True)), times) == [
        10,
        11,
    ]
    assert dumps(Schedule.of_checkpoints(None), times) == []


def test_checkpoints_by_wall_time() -> None:
    schedule = Schedule.of_checkpoints(Checkpoint(walltimeStart=10, walltimeIntervalHours=0.01))
    assert not schedule.due(1.0, 1, 9.0, False)
    assert schedule.due(1.0, 1, 10.5, False)
    schedule.done(1.0, 1, 100.0)
    assert schedule.next_wall == pytest.approx(118.0)


# ---- what ----


def test_archive_of_two_materials(tmp_path: Path) -> None:
    fields = ("p.velocity", "p.scalefactor", "g.mass", "g.stressFS", "g.velocity_star", "NC_CCweight")
    labels = (*fields, "TotalMass", "TotalMomentum", "StrainEnergy", "AccStrainEnergy")
    archive = run(tmp_path, deck(saves=labels))
    assert [t.step for t in archive.timesteps] == [1, 4, 7]
    types = {name: variable.type_name for name, variable in archive.variables.items()}
    assert types == {
        "p.x": "ParticleVariable<Point>",
        "p.particleID": "ParticleVariable<long64>",
        "p.velocity": "ParticleVariable<Vector>",
        "p.scalefactor": "ParticleVariable<Matrix3>",
        "g.mass": "NCVariable<double>",
        "g.stressFS": "NCVariable<Matrix3>",
        "g.velocity_star": "NCVariable<Vector>",
        "NC_CCweight": "NCVariable<double>",
    }
    assert archive.materials(1, "g.mass") == [0, 1, 2]
    assert archive.materials(1, "g.velocity_star") == [0, 1]
    assert archive.materials(1, "NC_CCweight") == [0]
    assert set(archive.reductions) == {"StrainEnergy", "AccStrainEnergy"} | {
        f"{label}{end}" for label in ("TotalMass", "TotalMomentum") for end in ("", "_0", "_1")
    }
    assert (tmp_path / "a.uda" / "blocks.ups").read_text() == (tmp_path / "blocks.ups").read_text()
    assert (tmp_path / "a.uda" / "input.xml.orig").exists()


def test_values_of_sums_and_nodes(tmp_path: Path) -> None:
    labels = (
        "p.x",
        "p.mass",
        "p.volume",
        "p.stress",
        "g.mass",
        "g.volume",
        "g.stressFS",
        *SAVES[4:],
        "TotalMass",
    )
    archive = run(tmp_path, deck(saves=labels, archiver="<outputTimestepInterval>1</outputTimestepInterval>"))
    sums = archive.reductions
    np.testing.assert_allclose(
        sums["AccStrainEnergy"].values, np.cumsum(sums["StrainEnergy"].values), rtol=1e-15
    )
    np.testing.assert_array_equal(
        sums["TotalMass"].values, sums["TotalMass_0"].values + sums["TotalMass_1"].values
    )
    for m in (0, 1):
        mass = archive.particles(5, "p.mass", m).sum()
        assert archive.grid_variable(5, "g.mass", m).values.sum() == pytest.approx(mass, rel=1e-13)
        # stress at the nodes is of the particles as they were before the step
        volume, stress = archive.particles(4, "p.volume", m), archive.particles(4, "p.stress", m)
        nodal_volume = archive.grid_variable(5, "g.volume", m).values
        nodal_stress = archive.grid_variable(5, "g.stressFS", m).values
        total = (nodal_volume[..., None, None] * nodal_stress).sum(axis=(0, 1, 2))
        expected = (volume[:, None, None] * stress).sum(axis=0)
        np.testing.assert_allclose(total, expected, rtol=1e-12, atol=1e-9 * np.abs(expected).max())


def test_one_material_has_no_file_of_its_own(tmp_path: Path) -> None:
    archive = run(tmp_path, deck(materials=LEFT, saves=("KineticEnergy", "TotalMass")))
    assert set(archive.reductions) == {"KineticEnergy", "TotalMass"}
    assert not archive.variables


def test_every_patch_has_an_entry_for_every_material(tmp_path: Path) -> None:
    archive = run(tmp_path, deck(patches="[4,1,1]"))
    table = (tmp_path / "a.uda" / "t00001" / "l0" / "p00000.xml").read_text()
    assert table.count("<variable>p.stress</variable>") == 8
    assert archive.particle_count(1, 0) == archive.particle_count(1, 1) == 36


def test_a_material_without_particles(tmp_path: Path) -> None:
    outside = material("[5,5,5]", "[6,6,6]", "[0,0,0]")
    archive = run(tmp_path, deck(materials=LEFT + outside + CONTACT, saves=(*SAVES, "TotalMass")))
    assert archive.materials(1, "p.stress") == [0, 1]
    assert archive.particles(1, "p.stress", 1).shape == (0, 3, 3)
    assert archive.reductions["TotalMass_1"].values[-1] == pytest.approx(0.0, abs=1e-190)


def test_state_at_the_start(tmp_path: Path) -> None:
    text = deck(archiver="<outputInitTimestep/>" + "<outputTimestepInterval>3</outputTimestepInterval>",
                saves=(*SAVES, "g.mass", "p.scalefactor"))  # fmt: skip
    archive = run(tmp_path, text)
    assert [t.step for t in archive.timesteps] == [0, 3, 6]
    assert archive.timesteps[0].time == archive.timesteps[0].old_delt == 0.0
    # sus knows neither of these before the first step
    assert not {"g.mass", "p.scalefactor"} & set(archive.labels(0))
    assert archive.reductions["AccStrainEnergy"].times[0] == 0.0
    assert archive.reductions["KineticEnergy"].times[0] > 0.0


def test_single_precision_and_compression(tmp_path: Path) -> None:
    text = deck(archiver="<outputTimestepInterval>3</outputTimestepInterval><outputDoubleAsFloat/>"
                '<compression>gzip</compression><checkpoint timestepInterval="3"/>',
                saves=("p.x", "p.mass"))  # fmt: skip
    archive = run(tmp_path, text)
    assert archive.variables["p.mass"].element == "float"
    assert archive.checkpoints is not None
    assert archive.checkpoints.variables["p.mass"].element == "double"
    table = (archive.path / "t00001" / "l0" / "p00000.xml").read_text()
    assert table.count("<compression>gzip</compression>") == table.count("<Variable ")


def test_columns_and_frequency_of_histories(tmp_path: Path) -> None:
    archiver = EVERY + "<frequency>3</frequency><onTimeStep>2</onTimeStep><timeStep>true</timeStep>"
    run(tmp_path, deck(archiver=archiver))
    lines = (tmp_path / "a.uda" / "KineticEnergy.dat").read_text().splitlines()
    assert [int(line[:10]) for line in lines] == [2, 5, 8]
    assert reduction_format(section(frequency=3, onTimeStep=7)).on_timestep == 1


EVERY = "<outputTimestepInterval>1</outputTimestepInterval>"


# ---- which ----


def test_filters_by_material_and_level(tmp_path: Path) -> None:
    saves = """
      <save label="p.x"/><save label="p.stress" material="1"/><save label="g.mass" material="0,2"/>
      <save label="KineticEnergy" material="1"/><save label="p.velocity" levels="-1"/>
      <save label="p.volume" levels="1-3"/><save label="TotalMass" levels="0"/>"""
    found, diagnostics = planned(tmp_path, deck(saves=(), archiver=EVERY + saves))
    assert found == {
        "p.x": (0, 1),
        "p.particleID": (0, 1),
        "p.stress": (1,),
        "g.mass": (0, 2),
        "p.velocity": (0, 1),
        "KineticEnergy": (1,),
        "TotalMass": (-1, 0, 1),
    }
    assert not diagnostics


def test_a_label_that_is_saved_once_a_material(tmp_path: Path) -> None:
    saves = '<save label="p.stress" material="1"/><save label="p.stress" material="0"/>'
    found, _ = planned(tmp_path, deck(saves=(), archiver=EVERY + saves))
    assert found["p.stress"] == (0, 1)


def test_a_variable_that_only_some_materials_have(tmp_path: Path) -> None:
    right = material("[0.4,0.1,0.0]", "[0.7,0.4,0.1]", "[0,0,0]", PLASTIC)
    found, diagnostics = planned(
        tmp_path, deck(materials=LEFT + right + CONTACT, saves=("p.x", "p.plasticStrain"))
    )
    assert found["p.plasticStrain"] == (1,)
    assert not [d for d in diagnostics if d.severity is Severity.ERROR]


@pytest.mark.parametrize(
    ("save", "severity", "message", "suggestion"),
    [
        (
            'label="p.stres"',
            Severity.ERROR,
            "there is no variable 'p.stres' to save",
            "did you mean p.stress?",
        ),
        (
            'label="KineticEnergi"',
            Severity.ERROR,
            "no variable 'KineticEnergi'",
            "did you mean KineticEnergy?",
        ),
        ('label="p.plasticStrain"', Severity.WARNING, "not computed for this deck", None),
        ('label="BndyForce_xminus"', Severity.WARNING, "not computed for this deck", None),
        ('label="p.stress" material="7"', Severity.ERROR, "no material 7: the deck has 0 to 1", None),
        ('label="p.stress" material="one"', Severity.ERROR, "'one' is not a list of numbers", None),
        ('label="g.velocity_star" material="2"', Severity.WARNING, "not there for material 2", None),
    ],
)
def test_doubtful_saves(
    tmp_path: Path, save: str, severity: Severity, message: str, suggestion: str | None
) -> None:
    _, diagnostics = planned(tmp_path, deck(saves=(), archiver=EVERY + f"<save {save}/>"))
    (diagnostic,) = [d for d in diagnostics if d.severity is not Severity.NOTE][:1]
    assert diagnostic.severity is severity
    assert message in diagnostic.message
    assert diagnostic.suggestion == suggestion
    assert diagnostic.location is not None
    assert (
        f"<save {save}/>" in (tmp_path / "blocks.ups").read_text().splitlines()[diagnostic.location.line - 1]
    )


def test_output_of_nothing(tmp_path: Path) -> None:
    (diagnostic,) = planned(tmp_path, deck(saves=()))[1]
    assert diagnostic.severity is Severity.ERROR
    assert "no <save" in diagnostic.message


def test_checkpoints_without_an_interval(tmp_path: Path) -> None:
    (diagnostic,) = planned(tmp_path, deck(archiver=EVERY + '<checkpoint cycle="2"/>'))[1]
    assert diagnostic.severity is Severity.WARNING
    assert "no checkpoint is written" in diagnostic.message


@pytest.mark.parametrize(
    ("text", "expected"),
    [("", None), ("all", None), ("2", {2}), ("0, 2-4", {0, 2, 3, 4}), ("-1", {-1}), ("-3--1", {-3, -2, -1})],
)
def test_lists_of_indices(text: str, expected: set[int] | None) -> None:
    assert parse_indices(text) == expected


# ---- the lattice ----


@pytest.mark.parametrize(
    ("extra", "periodic"), [((0, 0, 0), (0, 0, 0)), ((1, 1, 1), (0, 0, 0)), ((0, 1, 1), (1, 0, 0))]
)
def test_nodes_of_an_archive(extra: tuple[int, int, int], periodic: tuple[int, int, int]) -> None:
    patches = (Patch(0, (0, 0, 0), (2, 3, 1)), Patch(1, (2, 0, 0), (4, 3, 1)))
    grid = Grid((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (4, 3, 1), extra, periodic, patches)
    simulation = SimpleNamespace(grid=grid, exchange=OneRank(grid))
    nodes = on_lattice(simulation, grid.node_positions())
    whole = archive_grid(grid).levels[0].whole("NCVariable")
    assert nodes.shape == (*whole.shape, 3)
    np.testing.assert_array_equal(nodes[0, 0, 0], whole.low)
    np.testing.assert_array_equal(nodes[-1, -1, -1], np.array(whole.high) - 1)
