"""Decks with cohesive zones: read, run, stored, gone on with, and the work that pulling them apart takes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small_decks import deck, material, write

from ups.archive import Archive
from ups.convert import convert
from ups.deck import read_deck
from ups.factory import build
from ups.inspect.compare import compare_archives
from ups.lint import lint_deck
from ups.plan import plan_command
from ups.session import resume_run, run_deck

OPENING, STRENGTH = 1.0e-3, 200.0
"""delta_n and sig_max of the zones."""
AREA = 0.3 * 0.1
"""Of the interface."""

ZONES = f"""
    <cohesive_zone name="glue">
      <delta_n>{OPENING}</delta_n><delta_t>2.0e-3</delta_t>
      <sig_max>{STRENGTH}</sig_max><tau_max>150.0</tau_max>
      <delta_n_fail>1.0</delta_n_fail><delta_t_fail>1.0</delta_t_fail>
      <cz_filename>zones.txt</cz_filename>
    </cohesive_zone>"""
NO_CONTACT = "<contact><type>null</type></contact>"
LABELS = ("cz.force", "cz.separation", "cz.failed", "cz.CZID", "g.mass")


def blocks(left: str, right: str) -> str:
    """Two blocks that touch at x = 0.4, by their velocities."""
    return (
        material("[0.1,0.1,0.0]", "[0.4,0.4,0.1]", left, name="left")
        + material("[0.4,0.1,0.0]", "[0.7,0.4,0.1]", right, name="right")
        + ZONES
        + NO_CONTACT
    )


def glued(folder: Path, left: str, right: str, zones: str = "", **parts: str) -> Path:
    """A deck of two blocks with six zones between them, and the file of the zones."""
    rows = "".join(f"0.4 {y} 0.05 {AREA / 6} 1 0 0 0 1 0 0 1\n" for y in np.arange(0.125, 0.4, 0.05))
    (folder / "zones.txt").write_text(zones or rows)
    flags = "<use_cohesive_zones>true</use_cohesive_zones>"
    return write(folder, deck(materials=blocks(left, right), flags=flags, **parts))


def pulled(path: Path, steps: int) -> dict[str, np.ndarray]:
    """Histories of a run: energy, momentum and the sums over zones of force . d(separation)."""
    simulation = build(read_deck(path))
    (tied,) = simulation.cohesive_zones
    rows, work, strain, dt = [], 0.0, 0.0, 0.4 * simulation.initial_time_step()
    for _ in range(steps):
        before = tied.zones
        stable = simulation.advance(dt)
        after = tied.zones
        pull = 0.5 * (before.force + after.force)
        work += float((pull * (after.separation - before.separation)).sum())
        strain += simulation.reductions["StrainEnergy", -1]
        kinetic = simulation.reductions["KineticEnergy", -1]
        momentum = simulation.reductions["TotalMomentum", -1]
        rows.append((kinetic + strain, *momentum, work, after.separation[:, 0].min()))
        dt = 0.4 * stable
    energy, px, py, pz, works, opening = np.array(rows).T
    return {"energy": energy, "momentum": np.array([px, py, pz]), "work": works, "opening": opening}


def test_pulling_apart_takes_the_work_of_separation(tmp_path: Path) -> None:
    """e sig_max d_n an area, and that is what the bodies lose."""
    run = pulled(glued(tmp_path, "[-0.1,0,0]", "[0.1,0,0]"), 450)
    assert run["opening"][-1] > 10 * OPENING
    assert run["work"][-1] == pytest.approx(np.e * STRENGTH * OPENING * AREA, rel=5e-3)
    start = 2 * 0.5 * 9.0 * 0.1**2
    assert start - run["energy"][-1] == pytest.approx(run["work"][-1], rel=1e-2)
    assert np.abs(run["momentum"]).max() < 1e-12


def test_sliding_takes_the_work_of_sliding(tmp_path: Path) -> None:
    run = pulled(glued(tmp_path, "[0,-0.1,0]", "[0,0.1,0]"), 450)
    assert run["work"][-1] == pytest.approx(np.sqrt(np.e / 2) * 150.0 * 2e-3 * AREA, rel=2e-2)
    assert np.abs(run["momentum"]).max() < 1e-12


def test_zones_hold_bodies_together(tmp_path: Path) -> None:
    """Slow bodies do not part: the opening swings below d_n and comes back."""
    run = pulled(glued(tmp_path, "[-0.01,0,0]", "[0.01,0,0]"), 300)
    assert 0.0 < run["opening"].max() < OPENING
    assert run["opening"][-1] < 0.5 * run["opening"].max()


def test_an_archive_holds_zones_as_a_material_after_the_others(tmp_path: Path) -> None:
    saves = ("p.x", "p.velocity", *LABELS)
    path = glued(tmp_path, "[-0.1,0,0]", "[0.1,0,0]", saves=saves, patches="[1,2,1]")
    result = run_deck(read_deck(path), output=tmp_path / "a.uda")
    archive = result.archive
    step = archive.timesteps[-1].step
    assert archive.materials(step, "p.x") == [0, 1, 2]
    assert archive.materials(step, "p.particleID") == [0, 1]
    assert archive.materials(step, "cz.force") == [2]
    assert archive.materials(step, "g.mass") == [0, 1, 3]
    force = archive.particles(step, "cz.force", 2)
    assert force.shape == (6, 3)
    assert (force[:, 0] > 0.0).all()
    np.testing.assert_allclose(archive.particles(step, "p.x", 2)[:, 0], 0.4, atol=1e-12)
    assert len(np.unique(archive.particles(step, "cz.CZID", 2))) == 6
    convert(result.directory, tmp_path / "zones.csv", variables=["cz.force"])
    assert "cz.force" in (tmp_path / "zones.csv").read_text().splitlines()[0]
    convert(result.directory, tmp_path / "vtk")
    assert list((tmp_path / "vtk").rglob("*.vt*"))


def test_zones_are_compared_and_followed_by_their_own_numbers(tmp_path: Path) -> None:
    path = glued(tmp_path, "[-0.1,0,0]", "[0.1,0,0]", saves=("p.x", "p.velocity", *LABELS))
    ours = run_deck(read_deck(path), output=tmp_path / "a.uda").archive
    split = path.read_text().replace("[2,2,1]</patches>", "[1,5,1]</patches>")
    theirs = run_deck(read_deck(write(tmp_path, split, "split.ups")), output=tmp_path / "b.uda").archive
    same = compare_archives(ours.path, theirs.path)
    assert (same.obstacles, same.differences) == ([], [])
    step = ours.timesteps[-1].step
    numbers = ours.particles(step, "cz.CZID", 2)
    track = ours.follow("cz.force", numbers[:2])
    np.testing.assert_array_equal(track.values[-1], ours.particles(step, "cz.force", 2)[:2])


def test_going_on_gives_the_same_bytes(tmp_path: Path) -> None:
    archiver = (
        '<outputTimestepInterval>5</outputTimestepInterval><checkpoint cycle="0" timestepInterval="10"/>'
    )
    time = "<max_Timesteps>30</max_Timesteps>"
    saves = ("p.x", "KineticEnergy", *LABELS)
    path = glued(tmp_path, "[-0.1,0,0]", "[0.1,0.02,0]", saves=saves, archiver=archiver, time=time)
    run_deck(read_deck(path), output=tmp_path / "straight")
    run_deck(read_deck(path), output=tmp_path / "halves", max_steps=14)
    resume_run(tmp_path / "halves")
    files = [f.relative_to(tmp_path / "straight") for f in (tmp_path / "straight").rglob("*.data")]
    assert len(files) > 6
    for file in [*files, Path("KineticEnergy.dat")]:
        assert (tmp_path / "straight" / file).read_bytes() == (tmp_path / "halves" / file).read_bytes()


def test_plan_counts_the_zones(tmp_path: Path) -> None:
    text, _ = plan_command(str(glued(tmp_path, "[0,0,0]", "[0,0,0]", saves=("cz.force",))))
    assert "material 2  6 cohesive zones (glue)" in text


def test_faults_are_diagnostics(tmp_path: Path) -> None:
    path = glued(tmp_path, "[0,0,0]", "[0,0,0]", zones="0.4 0.2 0.05 0.005 1 0 0 0 1 0 0 7\n")
    assert "names the materials 0 and 7" in _complaint(path)
    (tmp_path / "zones.txt").unlink()
    assert "zones.txt" in _complaint(path)
    away = glued(tmp_path, "[0,0,0]", "[0,0,0]", zones="9 9 9 0.005 1 0 0 0 1 0 0 1\n")
    read_in = read_deck(away)
    build(read_in)
    assert [d.code for d in read_in.diagnostics if "no zone" in d.message] == ["UPS411"]


def _complaint(path: Path) -> str:
    from ups.diagnostics import DeckError

    with pytest.raises(DeckError) as problem:
        build(read_deck(path))
    return str(problem.value)


def test_lint_sees_zones_that_are_switched_off(tmp_path: Path) -> None:
    glued(tmp_path, "[0,0,0]", "[0,0,0]")
    text = deck(materials=blocks("[0,0,0]", "[0,0,0]"))
    found = [
        d for d in lint_deck(write(tmp_path, text, "off.ups")).diagnostics if "cohesive_zone" in d.message
    ]
    assert [(d.code, d.severity.name) for d in found] == [("UPS425", "WARNING")]
    on = glued(tmp_path, "[0,0,0]", "[0,0,0]", saves=('cz.force" material="2', 'g.mass" material="3'))
    assert [d.message for d in lint_deck(on).diagnostics] == []
    beyond = glued(tmp_path, "[0,0,0]", "[0,0,0]", saves=('cz.force" material="4',))
    assert "names material 4" in " ".join(d.message for d in lint_deck(beyond).diagnostics)


def test_a_turning_zone_turns_with_its_bodies(tmp_path: Path) -> None:
    """Two blocks that spin as one about the middle of the interface: normals turn, and nothing opens."""
    path = glued(tmp_path, "[0,0,0]", "[0,0,0]")
    path.write_text(path.read_text().replace("<cz_filename>", "<do_rotation>true</do_rotation><cz_filename>"))
    simulation = build(read_deck(path))
    spin = 2.0
    for body in simulation.bodies:
        arm = body.particles.position - np.array([0.4, 0.25, 0.0])
        body.particles.velocity[:] = np.cross([0.0, 0.0, spin], arm)
    dt = 0.2 * simulation.initial_time_step()
    for _ in range(10):
        simulation.advance(dt)
    normal = simulation.cohesive_zones[0].zones.normal
    inside = slice(2, -2)  # nodes at the rim have the velocity of particles on one side of them
    angle = np.arctan2(normal[inside, 1], normal[inside, 0])
    np.testing.assert_allclose(angle, spin * 10 * dt, rtol=0.05)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-12)


def test_the_archive_of_a_run_without_zones_counts_all_materials_as_before(tmp_path: Path) -> None:
    result = run_deck(read_deck(write(tmp_path, deck(saves=("g.mass",)))), output=tmp_path / "a.uda")
    assert Archive(result.directory).materials(-1, "g.mass") == [0, 1, 2]
