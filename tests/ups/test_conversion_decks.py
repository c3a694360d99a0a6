"""Decks that convert failed particles: into a copy of their material, or into one that waits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small_decks import HYPO, deck, write

from solver.simulation import Simulation
from ups.archive import Archive
from ups.deck import read_deck
from ups.diagnostics import DeckError
from ups.factory import build
from ups.lint import lint_deck
from ups.plan import plan_command
from ups.session import resume_run, run_deck

COPY = "<create_new_particles>true</create_new_particles>"
WAITING = "<manual_new_material>true</manual_new_material>"
SAVES = (
    *("p.x", "p.velocity", "p.stress", "p.localizedMPM", "p.epsf", "p.timeofloc"),
    *("TotalMass", "TotalMomentum", "KineticEnergy", "ThermalEnergy"),
)
ARCHIVER = '<outputTimestepInterval>5</outputTimestepInterval><checkpoint cycle="0" timestepInterval="10"/>'
TIME = "<max_Timesteps>40</max_Timesteps>"
NULL = "<contact><type>null</type></contact>"
MEETING = "<contact><type>approach</type><mu>0.1</mu></contact>"


def bar(erosion: str = "ZeroStress", model: str = HYPO) -> str:
    """A bar of one material whose halves fly apart, so that it fails in the middle."""
    halves = "".join(
        f"""
      <geom_object>
        <box label="{name}"><min>[{low},0.2,0.0]</min><max>[{high},0.3,0.1]</max></box>
        <res>[2,2,1]</res><velocity>[{velocity},0,0]</velocity><temperature>300</temperature>
      </geom_object>"""
        for name, low, high, velocity in (("left", 0.1, 0.4, -8.0), ("right", 0.4, 0.7, 10.0))
    )
    return f"""
    <material name="bar">
      <density>1000.0</density>{model}
      <damage_model type="Threshold">
        <failure_criteria>MaximumPrincipalStress</failure_criteria>
        <failure_mean>1.0e6</failure_mean><failure_std>1.0e4</failure_std><failure_seed>3</failure_seed>
        <failure_distrib>gauss</failure_distrib>
      </damage_model>
      <erosion algorithm="{erosion}"/>
      <thermal_conductivity>1.0</thermal_conductivity><specific_heat>5.0</specific_heat>{halves}
    </material>"""


DEBRIS = f"""
    <material name="debris">
      <density>1000.0</density>{HYPO.replace("12.e6", "1.e6")}
      <thermal_conductivity>1.0</thermal_conductivity><specific_heat>10.0</specific_heat>
      <geom_object><null/><res>[2,2,1]</res><velocity>[0,0,0]</velocity><temperature>300</temperature></geom_object>
    </material>"""


def converting(materials: str, flags: str) -> str:
    return deck(materials=materials, flags=flags, saves=SAVES, archiver=ARCHIVER, time=TIME)


DECKS = {
    "copy": converting(bar() + MEETING, COPY),
    "waiting": converting(DEBRIS + bar() + MEETING, WAITING),
    "keeping the stress": converting(bar("PreserveStress") + MEETING, COPY),
}


@pytest.mark.parametrize("name", DECKS)
def test_failed_particles_change_their_material(tmp_path: Path, name: str) -> None:
    result = run_deck(read_deck(write(tmp_path, DECKS[name])), output=tmp_path / "a.uda")
    source, target = (1, 0) if name == "waiting" else (0, 1)
    archive = result.archive
    counts = []
    for timestep in archive.timesteps:
        sound, failed = (len(archive.particles(timestep.step, "p.x", m)) for m in (source, target))
        assert sound + failed == 24
        counts.append(failed)
        assert not archive.particles(timestep.step, "p.localizedMPM", source).any()
        assert archive.particles(timestep.step, "p.localizedMPM", target).all()
    assert counts[0] == 0
    assert 0 < counts[-1] < 24
    assert counts == sorted(counts)
    stress = np.abs(archive.particles(archive.timesteps[-1].step, "p.stress", target)).max()
    assert (stress == 0.0) == (name == "copy")


@pytest.mark.parametrize("name", ["copy", "waiting"])
def test_what_is_conserved_stays(tmp_path: Path, name: str) -> None:
    """Mass, momentum and heat of all materials; heat also where the debris has twice the specific heat."""
    result = run_deck(read_deck(write(tmp_path, DECKS[name])), output=tmp_path / "a.uda")
    for label in ("TotalMass", "TotalMomentum", "ThermalEnergy"):
        values = result.history(label)[1]
        np.testing.assert_allclose(values, np.broadcast_to(values[0], values.shape), rtol=1e-12, atol=1e-12)


def test_erosion_works_on_as_without_conversion(tmp_path: Path) -> None:
    """With one velocity for both materials the copy moves as the particles would have moved where they were."""
    single = "<contact><type>single_velocity</type></contact>"
    ends = {}
    for name, flags in (("with", COPY), ("without", "")):
        path = write(tmp_path, converting(bar() + single, flags), f"{name}.ups")
        archive = run_deck(read_deck(path), output=tmp_path / name).archive
        step = archive.timesteps[-1].step
        order = np.argsort(archive.particles(step, "p.particleID"))
        ends[name] = {v: archive.particles(step, v)[order] for v in SAVES[:6]}
    assert len(Archive(tmp_path / "with").particles(-1, "p.x", 1)) > 0
    for label, value in ends["with"].items():
        np.testing.assert_allclose(value, ends["without"][label], rtol=1e-9, atol=1e-9 * np.abs(value).max())


@pytest.mark.parametrize("name", DECKS)
def test_going_on_gives_the_same_bytes(tmp_path: Path, name: str) -> None:
    path = write(tmp_path, DECKS[name])
    run_deck(read_deck(path), output=tmp_path / "straight")
    run_deck(read_deck(path), output=tmp_path / "halves", max_steps=24)
    resume_run(tmp_path / "halves")
    stored = [f for f in (tmp_path / "straight").rglob("*") if f.suffix in (".data", ".dat", ".npz")]
    assert len(stored) > 20
    for file in stored:
        assert (
            file.read_bytes() == (tmp_path / "halves" / file.relative_to(tmp_path / "straight")).read_bytes()
        )


def test_new_and_old_have_velocities_of_their_own(tmp_path: Path) -> None:
    """A piece of debris thrown back at the bar passes through it without contact, and not with it."""
    speeds = {}
    for name, contact in (("null", NULL), ("meeting", MEETING)):
        text = converting(bar() + contact, COPY).replace(TIME, "<max_Timesteps>150</max_Timesteps>")
        simulation = _after_failure(write(tmp_path, text, f"{name}.ups"))
        bodies = simulation.bodies
        bodies[1].particles.velocity[:] = [40.0, 0.0, 0.0]
        bodies[0].keep(bodies[0].particles.velocity[:, 0] > 0.0)
        for _ in range(60):
            simulation.advance(5.0e-5)
        speeds[name] = bodies[1].particles.velocity[:, 0].mean()
    assert speeds["null"] == pytest.approx(40.0, rel=1e-9)
    assert speeds["meeting"] < 30.0


def _after_failure(path: Path) -> Simulation:
    """A simulation just after its first particles failed."""
    simulation = build(read_deck(path))
    while not len(simulation.bodies[1].particles):
        simulation.advance(5.0e-5)
    return simulation


def test_lint_and_plan_know_the_copies(tmp_path: Path) -> None:
    path = write(
        tmp_path, converting(bar() + MEETING.replace("<mu>", "<materials>[0,1]</materials><mu>"), COPY)
    )
    assert [d for d in lint_deck(path).diagnostics if d.severity.name != "NOTE"] == []
    assert "material 1  hypo_elastic (bar (failed)), 0 particles" in plan_command(str(path))[0]


@pytest.mark.parametrize(
    ("materials", "flags", "complaint"),
    [
        (bar() + NULL, WAITING, "waits for the failed particles"),
        (DEBRIS + bar() + NULL, WAITING + COPY, "every material has its copy already"),
    ],
)
def test_decks_that_say_no_conversion_are_refused(
    tmp_path: Path, materials: str, flags: str, complaint: str
) -> None:
    with pytest.raises(DeckError, match=complaint):
        read_deck(write(tmp_path, deck(materials=materials, flags=flags))).require()


def test_both_tags_false_as_in_decks_of_old(tmp_path: Path) -> None:
    off = (COPY + WAITING).replace("true", "false")
    assert [d.message for d in lint_deck(write(tmp_path, deck(flags=off))).diagnostics] == []
