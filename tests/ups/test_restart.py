"""A run that goes on from a checkpoint ends bit for bit where the uninterrupted one ends."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from small_decks import CONTACT, LEFT, PLASTIC, SAVES, deck, material, write

from solver import simulation, sorting
from ups.archive import Archive
from ups.deck import read_deck
from ups.diagnostics import DeckError
from ups.session import resume_run, run_deck

CHECKPOINTS = '<outputTimestepInterval>3</outputTimestepInterval><checkpoint cycle="0" timestepInterval="5"/>'
FLOWING = material("[0.4,0.1,0.0]", "[0.7,0.4,0.1]", "[-20.0,0.0,0.0]", PLASTIC, "right")
LOADS = """
  <PhysicalBC><MPM><pressure>
    <geom_object><box label="pushed"><min>[0.69,0.1,0.0]</min><max>[0.7,0.4,0.1]</max></box></geom_object>
    <load_curve><id>1</id><time_point><time>0</time><load>1e4</load></time_point>
      <time_point><time>1</time><load>2e4</load></time_point></load_curve>
  </pressure></MPM></PhysicalBC>"""

DIFFUSING = (
    material(
        "[0.1,0.1,0.0]",
        "[0.4,0.4,0.1]",
        "[1.0,0.0,0.0]",
        """<constitutive_model type="gao_elastic"><bulk_modulus>32.e6</bulk_modulus>
      <shear_modulus>12.e6</shear_modulus><alpha>0.02</alpha></constitutive_model>
    <diffusion_model type="non_linear1"><diffusivity>2.0</diffusivity><max_concentration>1.0</max_concentration>
      <use_pressure>true</use_pressure><tuning1>1.0</tuning1><tuning2>0.3</tuning2><tuning3>0.0</tuning3>
      <tuning4>3.0</tuning4><tuning5>1e-4</tuning5></diffusion_model>""",
    )
    .replace("<color>", "")
    .replace("</geom_object>", "<concentration>0.2</concentration></geom_object>")
)
SOAKING = (
    LOADS.replace("pressure>", "scalar_flux>").replace("0.69,", "0.3999,").replace("0.7,0.4", "0.4001,0.4")
)

NONLOCAL = """<constitutive_model type="nonlocal_drucker_prager"><bulk_modulus>32.e6</bulk_modulus>
  <shear_modulus>12.e6</shear_modulus><alpha>0.1</alpha><alpha_p>0.0</alpha_p><k_o>1.e5</k_o>
  <h_nonlocal>-1.e6</h_nonlocal><l_nonlocal>0.15</l_nonlocal></constitutive_model>"""

DECKS = {
    "nonlocal": deck(
        archiver=CHECKPOINTS,
        time="<max_Timesteps>12</max_Timesteps>",
        materials=material("[0.2,0.1,0.0]", "[0.6,0.4,0.1]", "[0,0,0]", NONLOCAL)
        + LEFT.replace("[0.1,0.1,0.0]", "[0.0,0.1,0.0]").replace("[0.4,0.4,0.1]", "[0.2,0.4,0.1]")
        + CONTACT,
        saves=(*SAVES, "p.plasticStrain", "eta_nl"),
    ),
    "diffusing": deck(
        archiver=CHECKPOINTS,
        time="<max_Timesteps>12</max_Timesteps>",
        materials=DIFFUSING,
        flags="<use_load_curves>true</use_load_curves><do_scalar_diffusion>true</do_scalar_diffusion>",
        extra=SOAKING.replace("1e4", "1e-1").replace("2e4", "2e-1"),
        saves=("p.x", "p.concentration", "p.flux", "p.area", "p.swelling", "g.concentration", "TotalConc"),
    ),
    "contact": deck(archiver=CHECKPOINTS, time="<max_Timesteps>12</max_Timesteps>"),
    "plastic": deck(
        archiver=CHECKPOINTS,
        time="<max_Timesteps>12</max_Timesteps>",
        materials=LEFT + FLOWING + CONTACT,
        saves=(*SAVES, "p.plasticStrain", "g.stressFS"),
    ),
    "by time, loaded": deck(
        archiver='<outputInterval>0.7e-3</outputInterval><checkpoint cycle="3" interval="1.1e-3"/>',
        max_time="4e-3",
        time="<clamp_time_to_output>true</clamp_time_to_output><max_delt_increase>0.1</max_delt_increase>",
        flags="<use_load_curves>true</use_load_curves>",
        extra=LOADS,
        patches="[3,1,1]",
    ),
}


def contents(archive: Path) -> dict[str, bytes]:
    """Every history, and the data of every time step and checkpoint."""
    files = [f for f in archive.rglob("*") if f.suffix in (".dat", ".data", ".npz")]
    return {str(f.relative_to(archive)): f.read_bytes() for f in files}


@pytest.mark.parametrize("name", DECKS)
def test_stopping_and_going_on_gives_the_same_bytes(tmp_path: Path, name: str) -> None:
    path = write(tmp_path, DECKS[name])
    straight = run_deck(read_deck(path), output=tmp_path / "straight")
    middle = Archive(straight.directory).checkpoints.timesteps[0].step
    run_deck(read_deck(path), output=tmp_path / "halves", max_steps=middle + 1)
    on = resume_run(tmp_path / "halves")
    assert on.steps == straight.steps > middle + 1
    expected, found = contents(tmp_path / "straight"), contents(tmp_path / "halves")
    assert expected.keys() == found.keys()
    assert [f for f in expected if expected[f] != found[f]] == []


def test_particles_are_sorted_when_the_uninterrupted_run_sorts_them(tmp_path: Path, monkeypatch) -> None:
    """With an order that turns round each time, so that a look too many or too few would show."""
    monkeypatch.setattr(sorting, "LEAST_PARTICLES", 0)
    monkeypatch.setattr(sorting, "STEPS_BETWEEN_LOOKS", 3)
    monkeypatch.setattr(sorting, "LARGEST_DISORDER", -1.0)
    monkeypatch.setattr(simulation, "in_order_of_cells", lambda grid, x: np.arange(len(x))[::-1])
    path = write(tmp_path, DECKS["contact"].replace("<save", '<save label="p.particleID"/><save', 1))
    run_deck(read_deck(path), output=tmp_path / "straight")
    for stop in (7, 11):  # goes on from the checkpoints 6, where it looks, and 11
        halves = tmp_path / f"halves{stop}"
        run_deck(read_deck(path), output=halves, max_steps=stop)
        resume_run(halves)
        assert contents(tmp_path / "straight") == contents(halves)
    archive = Archive(tmp_path / "straight")
    orders = [archive.particles(t.step, "p.particleID", 0).tolist() for t in archive.timesteps]
    first, second, third, _ = orders
    assert first == third != second
    assert sorted(first) == sorted(second)


def test_the_plastic_deck_flows(tmp_path: Path) -> None:
    result = run_deck(read_deck(write(tmp_path, DECKS["plastic"])), output=tmp_path / "a")
    assert Archive(result.directory).particles(-1, "p.plasticStrain", 1).max() > 0.0


def test_going_on_into_a_new_archive_leaves_the_old_one(tmp_path: Path) -> None:
    path = write(tmp_path, DECKS["contact"])
    run_deck(read_deck(path), output=tmp_path / "straight")
    before = contents(tmp_path / "straight")
    on = resume_run(tmp_path / "straight", step=6, output=tmp_path / "new")
    assert contents(tmp_path / "straight") == before
    old, new = Archive(tmp_path / "straight"), Archive(on.directory)
    assert [t.step for t in new.timesteps] == [7, 10]
    assert new.index.restarts[0].step == 6
    for label in ("p.x", "p.stress"):
        np.testing.assert_array_equal(old.particles(-1, label), new.particles(-1, label))
    np.testing.assert_array_equal(
        old.reductions["AccStrainEnergy"].values[6:], new.reductions["AccStrainEnergy"].values
    )


def test_a_run_that_was_killed_while_writing_goes_on(tmp_path: Path) -> None:
    path = write(tmp_path, DECKS["contact"])
    run_deck(read_deck(path), output=tmp_path / "straight")
    run_deck(read_deck(path), output=tmp_path / "killed", max_steps=8)
    killed = tmp_path / "killed"
    # what a process leaves that dies while it writes: half a line, half a step, half a checkpoint
    with (killed / "KineticEnergy.dat").open("a") as history:
        history.write("0.004\t12")
    (killed / "t00010.partial").mkdir()
    (killed / "t00010.partial" / "timestep.xml").write_text("<Uintah_tim")
    shutil.copytree(killed / "t00007", killed / "t00010")
    (killed / "checkpoints" / "t00011.partial").mkdir()
    (killed / "checkpoints" / "index.partial").write_text("<Uintah")
    resume_run(killed)
    expected, found = contents(tmp_path / "straight"), contents(killed)
    assert [f for f in expected if expected[f] != found.get(f)] == []


def test_what_a_contact_law_and_the_faces_remember_is_kept(tmp_path: Path) -> None:
    profile = tmp_path / "motion.txt"
    profile.write_text("0.0 20 0 0\n1.0 20 0 0\n2.0 0 0 0\n3.0 0 0 0\n")
    law = """<contact><type>specified</type><master_material>0</master_material><materials>[0,1]</materials>
      <direction>[1,1,0]</direction><filename>motion.txt</filename>
      <condition>xplus</condition><conditionValue>1e-12</conditionValue>
      <conditionAction>GoToZeroVelocity</conditionAction></contact>"""
    right = material("[0.5,0.0,0.0]", "[0.8,0.5,0.1]", "[0.0,0.0,0.0]", name="right")
    left = LEFT.replace("0.4,0.4,0.1]</max>", "0.5,0.4,0.1]</max>")
    text = deck(
        archiver=CHECKPOINTS,
        time="<max_Timesteps>14</max_Timesteps>",
        materials=left + right + law,
        flags="<boundary_traction_faces>[xplus]</boundary_traction_faces>",
        saves=("p.velocity", "BndyForce_xplus", "BndyTraction_xplus", "RigidReactionForce"),
    )
    path = write(tmp_path, text)
    straight = run_deck(read_deck(path), output=tmp_path / "straight")
    run_deck(read_deck(path), output=tmp_path / "halves", max_steps=11)
    resume_run(tmp_path / "halves")
    # the force on the face stopped the master, which would have gone on with 20
    assert np.abs(straight.history("BndyForce_xplus")[1]).max() > 1.0e-12
    velocity = straight.series("p.velocity", 0)
    start = np.tile([20.0, 0.0, 0.0], (len(velocity[0]), 1))
    np.testing.assert_allclose(velocity[0], start, atol=1e-12)
    np.testing.assert_allclose(velocity[-1], 0.0, atol=1e-12)
    assert contents(tmp_path / "straight") == contents(tmp_path / "halves")


def test_the_end_can_be_put_off(tmp_path: Path) -> None:
    run_deck(read_deck(write(tmp_path, DECKS["contact"])), output=tmp_path / "a")
    on = resume_run(tmp_path / "a", overrides=[("Time/max_Timesteps", "15")])
    assert on.steps == 15
    assert "<max_Timesteps>15<" in (tmp_path / "a" / "input.xml").read_text()


def problem_of(archive: Path, **options: int) -> str:
    with pytest.raises(DeckError) as caught:
        resume_run(archive, **options)
    return str(caught.value)


def test_what_cannot_be_gone_on_with(tmp_path: Path, shared: Path) -> None:
    assert "no index.xml" in problem_of(tmp_path / "nothing")
    run_deck(read_deck(write(tmp_path)), output=tmp_path / "none")
    assert "no checkpoint" in problem_of(tmp_path / "none")
    run_deck(read_deck(write(tmp_path, DECKS["contact"])), output=tmp_path / "some")
    assert "time step 7 is not stored; there are: 6, 11" in problem_of(tmp_path / "some", step=7).replace(
        "\n  = ", "; "
    )


def test_neighbours_soften_each_other_in_a_run(tmp_path: Path) -> None:
    result = run_deck(read_deck(write(tmp_path, DECKS["nonlocal"])), output=tmp_path / "nonlocal.uda")
    archive = Archive(result.directory)
    last = archive.timesteps[-1].step
    strain = archive.particles(last, "p.plasticStrain", 0)
    softened = archive.particles(last, "eta_nl", 0)
    assert strain.max() > 0.0
    assert (softened[strain == 0.0] < 0.0).any()  # by the flow around
    assert softened.min() > -1.0e6 * strain.max()
