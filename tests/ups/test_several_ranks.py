"""Runs on several ranks, here threads of one process, give what one rank gives."""

from __future__ import annotations

from pathlib import Path

import pytest
from agreement import disagreement
from model_samples import SAMPLES as MODEL_SAMPLES
from small_decks import HYPO, SAVES, deck, material, write
from thread_ranks import Team, ThreadRank, on_ranks

from ups.archive import Archive
from ups.deck import read_deck
from ups.diagnostics import DeckError
from ups.factory import build
from ups.session import resume_run, run_deck

ROUNDING = 1e-12
TWO_BLOCKS = material("[0.1,0.1,0.0]", "[0.4,0.4,0.1]", "[20.0,13.0,0.0]", name="left") + material(
    "[0.4,0.1,0.0]", "[0.7,0.4,0.1]", "[-20.0,0.0,0.0]", name="right"
)
SLOW = TWO_BLOCKS.replace("20.0", "2.0").replace("13.0", "1.0")
"""For linear shape functions: no particle crosses into an empty cell, whose small nodal masses enlarge rounding."""
NODAL = (
    "g.mass",
    "g.velocity",
    "g.stressFS",
    "NC_CCweight",
    "TotalMass",
    "TotalMomentum",
    "CenterOfMassPosition",
)
PERIODIC = "<extraCells>[0,0,1]</extraCells><periodic>[1,1,0]</periodic>"
EXTRA = "<extraCells>[1,1,1]</extraCells>"
AXISYMMETRIC = "<axisymmetric>true</axisymmetric>"
TRACTION = "<boundary_traction_faces>[xplus]</boundary_traction_faces>"
ON_TRACTION = ("BndyForce_xplus", "BndyTraction_xplus", "BndyContactCellArea_xplus")
HEAT = "<DoExplicitHeatConduction>true</DoExplicitHeatConduction>"
TO_THE_WALL = material("[0.4,0.1,0.0]", "[0.8,0.4,0.1]", "[20.0,3.0,0.0]")
FAST = material("[0.1,0.1,0.0]", "[0.4,0.4,0.1]", "[150.0,50.0,0.0]", name="left") + material(
    "[0.4,0.1,0.0]", "[0.7,0.4,0.1]", "[80.0,0.0,0.0]", name="right"
)
WALL = '<Face side="x+"><BCType id="all" var="symmetry" label="Symmetric"/></Face>'


LOADS = """
  <PhysicalBC><MPM><pressure>
    <geom_object><box label="pushed"><min>[0.69,0.1,0.0]</min><max>[0.7,0.4,0.1]</max></box></geom_object>
    <load_curve><id>1</id><time_point><time>0</time><load>1e4</load></time_point>
      <time_point><time>1</time><load>2e4</load></time_point></load_curve>
  </pressure></MPM></PhysicalBC>"""
LOADED = "<use_load_curves>true</use_load_curves>"
BRITTLE = (
    HYPO
    + """
    <damage_model type="Threshold">
      <failure_criteria>MaximumPrincipalStress</failure_criteria><failure_mean>2e5</failure_mean>
      <failure_distrib>uniform</failure_distrib><failure_std>1e5</failure_std><failure_seed>3</failure_seed>
    </damage_model>
    <erosion algorithm="ZeroStress"/>"""
)
NONLOCAL = (
    '<constitutive_model type="nonlocal_drucker_prager">'
    + MODEL_SAMPLES["nonlocal_drucker_prager"]
    + "</constitutive_model>"
)
BREAKING = TWO_BLOCKS.replace(HYPO, BRITTLE)
WAITING = TWO_BLOCKS.replace("</geom_object>", "<color>1</color></geom_object>", 1)
INSERTED = "<InsertParticles>true</InsertParticles><InsertParticlesFile>jump.txt</InsertParticlesFile>"
JUMP = "1.0e-3 1.0 0.35 0.1 0.0 -30.0 0.0 0.0"
"""At this time particles of colour 1 are put elsewhere, beyond the neighbours of their rank."""


STRETCHED = material("[0.1,0.1,0.0]", "[0.3,0.4,0.1]", "[0.0,0.0,0.0]").replace("[2,2,1]", "[1,1,1]")
PRESCRIBED = (
    "<UsePrescribedDeformation>true</UsePrescribedDeformation>"
    "<PrescribedDeformationFile>stretch.txt</PrescribedDeformationFile>"
)
STRETCH = "0.0 1 0 0 0 1 0 0 0 1 0 0 0 1\n0.02 2.6 0 0 0 1 0 0 0 1 10 0 0 1\n"
"""F grows to 2.6 in x while the body turns by 10 degrees: corners of particles reach beyond the cells around them."""


def contact(law: str, more: str = "") -> str:
    return f"<contact><type>{law}</type><mu>0.3</mu>{more}</contact>"


def blocks(
    law: str, interpolator: str = "gimp", cells: str = EXTRA, materials: str = TWO_BLOCKS, **changes: object
) -> str:
    """A deck of two blocks that meet."""
    options = {
        "materials": materials + (contact(law) if law else ""),
        "saves": SAVES + NODAL,
        "archiver": "<outputTimestepInterval>40</outputTimestepInterval>",
        "time": "<max_Timesteps>100</max_Timesteps>",
        "patches": "[1,1,1]",
        **changes,
    }
    text = deck(**options)  # type: ignore[arg-type]  # texts and a tuple of texts
    text = text.replace("linear", interpolator).replace("<resolution>", f"{cells}<resolution>")
    return (
        text if "<periodic>" in cells else text.replace("<BoundaryConditions>", f"<BoundaryConditions>{WALL}")
    )


CASES = {
    "one body": blocks("", materials=TO_THE_WALL),
    "linear": blocks("single_velocity", "linear", "", SLOW),
    "friction": blocks("friction_bard"),
    "friction, cpdi": blocks("friction_bard", "cpdi"),
    "logistic regression": blocks("friction_LR"),
    "logistic regression, periodic": blocks("friction_LR", cells=PERIODIC),
    "periodic": blocks("friction_bard", cells=PERIODIC),
    "periodic, linear": blocks("single_velocity", "linear", PERIODIC.replace("[0,0,1]", "[0,0,0]"), SLOW),
    "axisymmetric": blocks("friction_bard", flags=AXISYMMETRIC),
    "XPIC": blocks("approach", flags="<XPIC2>true</XPIC2>"),
    "splines": blocks("approach", "3rdorderBS"),
    "conduction": blocks("single_velocity", flags=HEAT),
    "stabilized pressure": blocks(
        "friction_bard", flags="<DoPressureStabilization>true</DoPressureStabilization>"
    ),
    "traction on a face": blocks("", materials=TO_THE_WALL, flags=TRACTION, saves=SAVES + ON_TRACTION),
    "lost particles": blocks("single_velocity", materials=FAST).replace(WALL, ""),
    "pressure": blocks("friction_bard", flags=LOADED, extra=LOADS),
    "pressure on corners": blocks(
        "friction_bard",
        flags=LOADED + "<use_CBDI_boundary_condition>true</use_CBDI_boundary_condition>",
        extra=LOADS.replace("</geom_object>", "</geom_object><outward_normal>true</outward_normal>"),
    ),
    "random strengths, erosion": blocks(
        "friction_bard", materials=BREAKING, saves=(*SAVES, "p.localizedMPM")
    ),
    "inserted": blocks("friction_bard", materials=WAITING, flags=INSERTED),
    "stretched": blocks("", "cpdi", materials=STRETCHED, flags=PRESCRIBED, max_time="0.02"),
    "patches of the deck": blocks("friction_bard", patches="[3,2,1]"),
}


@pytest.mark.parametrize("case", CASES)
def test_several_ranks_give_what_one_gives(case: str, tmp_path: Path) -> None:
    path = write(tmp_path, CASES[case])
    (tmp_path / "jump.txt").write_text(JUMP)
    (tmp_path / "stretch.txt").write_text(STRETCH)
    run_deck(read_deck(path), output=tmp_path / "one.uda")
    ranks = 4 if "patches" in case else 3
    on_ranks(ranks, lambda rank: run_deck(read_deck(path), output=tmp_path / "many.uda", communicator=rank))
    found = disagreement(tmp_path / "one.uda", tmp_path / "many.uda")
    assert max(found.values()) < ROUNDING, found


def test_nodal_values_are_written_in_steps_after_which_the_halo_grows(tmp_path: Path) -> None:
    """Every step is written: among them those after which corners reach beyond the cells around a rank's."""
    path = write(tmp_path, CASES["stretched"].replace(">40<", ">1<"))
    (tmp_path / "stretch.txt").write_text(STRETCH)
    run_deck(read_deck(path), output=tmp_path / "one.uda")
    on_ranks(3, lambda rank: run_deck(read_deck(path), output=tmp_path / "many.uda", communicator=rank))
    found = disagreement(tmp_path / "one.uda", tmp_path / "many.uda")
    assert max(found.values()) < ROUNDING, found


def test_a_material_whose_particles_feel_each_other_is_refused(tmp_path: Path) -> None:
    """Its averages reach farther than the nodes that a rank holds, and would end at its edge."""
    path = write(tmp_path, deck(materials=TWO_BLOCKS.replace(HYPO, NONLOCAL)))
    build(read_deck(path))
    with pytest.raises(DeckError) as refused:
        build(read_deck(path), ThreadRank(Team(2), 0))
    (diagnostic,) = refused.value.diagnostics
    assert diagnostic.code == "UPS412"
    assert "feel each other" in diagnostic.message


def test_domains_follow_particles_that_move(tmp_path: Path) -> None:
    path = write(tmp_path, CASES["lost particles"])
    on_ranks(3, lambda rank: run_deck(read_deck(path), output=tmp_path / "many.uda", communicator=rank))
    archive = Archive(tmp_path / "many.uda")
    grids = [archive.grid(t.step).levels[0].patches for t in archive.timesteps]
    assert grids[0] != grids[-1]
    assert {patch.proc for patch in grids[0]} == {0, 1, 2}


@pytest.mark.parametrize("case", ["friction", "periodic"])
def test_ranks_that_share_a_file_store_the_same(case: str, tmp_path: Path) -> None:
    path = write(tmp_path, CASES[case])
    for name, ranks_a_file in (("many", 1), ("few", 2)):
        on_ranks(
            4,
            lambda rank, name=name, n=ranks_a_file: run_deck(
                read_deck(path), output=tmp_path / name, communicator=rank, ranks_a_file=n
            ),
        )
    assert max(disagreement(tmp_path / "many", tmp_path / "few").values()) == 0.0
    files = sorted(file.name for file in (tmp_path / "few" / "t00001" / "l0").glob("*.data"))
    assert files == ["p00000.data", "p00002.data"]


CHECKPOINTS = (
    "<outputTimestepInterval>10</outputTimestepInterval><checkpoint cycle='0' timestepInterval='10'/>"
)


@pytest.fixture(scope="module", params=[1, 2], ids=["a file each", "one file"])
def stored(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """An archive of two ranks with checkpoints, run for 40 steps."""
    folder = tmp_path_factory.mktemp("stored")
    text = blocks(
        "friction_bard", archiver=CHECKPOINTS, time="<max_Timesteps>40</max_Timesteps>", saves=SAVES
    )
    path = write(folder, text)
    options = {"output": folder / "two.uda", "ranks_a_file": request.param}
    on_ranks(2, lambda rank: run_deck(read_deck(path), communicator=rank, **options))
    return folder / "two.uda"


@pytest.mark.parametrize("ranks", [1, 2, 3])
def test_a_checkpoint_restarts_on_any_number_of_ranks(ranks: int, stored: Path, tmp_path: Path) -> None:
    again = tmp_path / "again.uda"
    on_ranks(ranks, lambda rank: resume_run(stored, step=21, output=again, communicator=rank))
    before, after = Archive(stored), Archive(again)
    last = before.timesteps[-1].step
    assert after.timesteps[-1].step == last == 31
    for label in ("p.x", "p.velocity", "p.stress"):
        found = disagreement_at(before, after, last, label)
        assert found == 0.0 if ranks == 2 else found < ROUNDING, label


def disagreement_at(first: Archive, second: Archive, step: int, label: str) -> float:
    from agreement import particles_by_id

    pairs = [[particles_by_id(a, step, label, m) for a in (first, second)] for m in (0, 1)]
    return max(abs(x - y).max() / abs(x).max() for x, y in pairs)
