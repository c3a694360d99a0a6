"""Runs on several ranks, here threads of one process, give what one rank gives."""

from __future__ import annotations

from pathlib import Path

import pytest
from agreement import disagreement
from model_samples import SCRAM
from small_decks import HYPO, PLASTIC, SAVES, deck, material, write
from thread_ranks import on_ranks

from ups.archive import Archive
from ups.deck import read_deck
from ups.factory import build
from ups.profile import Profile
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
DRAWN = "<yield_distrib>uniform</yield_distrib><yield_range>5e3</yield_range><yield_seed>5</yield_seed>"
DEBRIS = material(
    "[0,0,0]",
    "[1,1,1]",
    "[0,0,0]",
    PLASTIC.replace("</yield_stress>", f"</yield_stress>{DRAWN}"),
    name="debris",
).replace('<box label="debris"><min>[0,0,0]</min><max>[1,1,1]</max></box>', "<null/>")
"""Takes failed particles, with yield stresses that are drawn when they come."""
NONLOCAL = """<constitutive_model type="nonlocal_drucker_prager">
      <alpha>0.1</alpha><alpha_p>0.05</alpha_p><k_o_dist>weibull, 2e5, 8, 1e-3, 3</k_o_dist><k_o>2e5</k_o>
      <bulk_modulus>32e6</bulk_modulus><shear_modulus>12e6</shear_modulus><l_nonlocal>0.17</l_nonlocal>
      <h_local>1e6</h_local><h_nonlocal>-4e6</h_nonlocal></constitutive_model>"""
SWELLING = """<constitutive_model type="rf_elastic_plastic">
      <bulk_modulus>32.e6</bulk_modulus><shear_modulus>12.e6</shear_modulus>
      <volume_expansion_coeff>0.1</volume_expansion_coeff>
      <flow_model type="isotropic_hardening"><sigma_Y>1e6</sigma_Y><K>0</K></flow_model>
    </constitutive_model>
    <diffusion_model type="gao_diffusion"><diffusivity>5.0</diffusivity><max_concentration>1.0</max_concentration>
    <partial_atomic_vol>1e-6</partial_atomic_vol><boltzmann_const>1</boltzmann_const>
    <operating_temp>1</operating_temp></diffusion_model><do_conc_reduction>true</do_conc_reduction>"""
DIFFUSING = (
    TWO_BLOCKS.replace(HYPO, SWELLING).replace(
        "</geom_object>", "<concentration>0.5</concentration></geom_object>", 1
    )
    + "<diffusion_interface><type>common</type></diffusion_interface>"
)
SOAKING = """<PhysicalBC><MPM><scalar_flux>
    <geom_object><box label="wet"><min>[0.1,0.39,0.0]</min><max>[0.7,0.4,0.1]</max></box></geom_object>
    <load_curve><id>1</id><time_point><time>0</time><load>20</load></time_point>
      <time_point><time>1</time><load>20</load></time_point></load_curve>
  </scalar_flux></MPM></PhysicalBC>"""
CONCENTRATIONS = ("p.concentration", "p.concentrationGradient", "p.flux", "g.concentration", "TotalConc")
GLUE = """<cohesive_zone name="glue"><delta_n>2.0e-3</delta_n><delta_t>4.0e-3</delta_t>
      <sig_max>2e5</sig_max><tau_max>1e5</tau_max><do_rotation>true</do_rotation>
      <cz_filename>zones.txt</cz_filename></cohesive_zone>"""
ZONES = "".join(f"0.4 {0.1125 + 0.025 * i} 0.05 0.0025 1 0 0 0 1 0 0 1\n" for i in range(12))
GLUED = (
    TWO_BLOCKS.replace("[20.0,13.0,0.0]", "[8.0,16.0,0.0]").replace("[-20.0,0.0,0.0]", "[12.0,14.0,0.0]")
    + GLUE
)
"""Two blocks that part slowly while both fly across borders of ranks."""
COPY = "<create_new_particles>true</create_new_particles>"
WAITING_MATERIAL = "<manual_new_material>true</manual_new_material>"
ZONED = "<use_cohesive_zones>true</use_cohesive_zones>"
DIFFUSES = "<do_scalar_diffusion>true</do_scalar_diffusion>"
FLOWING = ("p.plasticStrain", "eta", "eta_nl", "k_o_dist")
ON_ZONES = ("cz.force", "cz.separation", "cz.norm", "cz.failed", "cz.CZID")
CRUMBLING = TWO_BLOCKS.replace(
    HYPO,
    f'<constitutive_model type="visco_scram">{SCRAM}<randomize_parameters>true</randomize_parameters>'
    "</constitutive_model>",
).replace("20.0", "400.0")
BREAKING = TWO_BLOCKS.replace(HYPO, BRITTLE)
WAITING = TWO_BLOCKS.replace("</geom_object>", "<color>1</color></geom_object>", 1)
UPPER = (
    TWO_BLOCKS[TWO_BLOCKS.rindex("<geom_object>") : TWO_BLOCKS.rindex("</geom_object>")]
    .replace("0.1,0.0]", "0.2,0.0]")
    .replace("right", "upper")
)
COLOURED = TWO_BLOCKS.replace("<max>[0.7,0.4,0.1]", "<max>[0.7,0.2,0.1]")
COLOURED = (
    COLOURED[: COLOURED.rindex("</geom_object>")]
    + f"""</geom_object>
      {UPPER}<color>3</color></geom_object></material>"""
)
"""The right block is of two colours."""
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

QUICK_STRETCH = (
    "0.0 1 0 0 0 1 0 0 0 1 0 0 0 1\n0.002 2.6 0 0 0 1 0 0 0 1 10 0 0 1\n0.02 2.7 0 0 0 1 0 0 0 1 0 0 0 1\n"
)
"""The same within twenty steps."""


VARIABLE = """<master_material>1</master_material><variable_friction>
    <entry><color>0.5</color><mu>0.1</mu></entry><entry><color>2.5</color><mu>0.6</mu></entry>
  </variable_friction>"""
DRAG = "<myu>5e5</myu><use_svf>true</use_svf>"


def contact(law: str, more: str = "") -> str:
    return f"<contact><type>{law}</type><mu>0.3</mu>{more}</contact>"


def blocks(
    law: str,
    interpolator: str = "gimp",
    cells: str = EXTRA,
    materials: str = TWO_BLOCKS,
    more: str = "",
    **changes: object,
) -> str:
    """A deck of two blocks that meet, by a contact law with ``more`` tags."""
    options = {
        "materials": materials + (contact(law, more) if law else ""),
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
    "variable friction": blocks("friction_LRVar", materials=COLOURED, more=VARIABLE),
    "variable friction, periodic": blocks(
        "friction_LRVar", cells=PERIODIC, materials=COLOURED, more=VARIABLE
    ),
    "drag": blocks("nodal_svf", more=DRAG),
    "drag by mass, periodic": blocks(
        "nodal_svf",
        "linear",
        PERIODIC.replace("[0,0,1]", "[0,0,0]"),
        SLOW,
        more=DRAG.replace("true", "false").replace("5e5", "1e3"),
        time="<max_Timesteps>60</max_Timesteps>",
    ),
    "numbers of drand48": blocks("friction_bard", materials=CRUMBLING, saves=(*SAVES, "p.rand")),
    "periodic": blocks("friction_bard", cells=PERIODIC),
    "periodic, linear": blocks("single_velocity", "linear", PERIODIC.replace("[0,0,1]", "[0,0,0]"), SLOW),
    "axisymmetric": blocks("friction_bard", flags=AXISYMMETRIC),
    "XPIC": blocks("approach", flags="<XPIC2>true</XPIC2>"),
    "gradients": blocks(
        "friction_bard",
        flags="<UseGradientEnhancedVelocityProjection>true</UseGradientEnhancedVelocityProjection>",
    ),
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
    "conversion": blocks(
        "friction_bard",
        materials=BREAKING,
        flags=COPY + LOADED,
        extra=LOADS,
        saves=(*SAVES, "p.localizedMPM"),
    ),
    "conversion into another model": blocks(
        "friction_bard", materials=DEBRIS + BREAKING, flags=WAITING_MATERIAL, saves=(*SAVES, "p.yieldStress")
    ),
    "cohesive zones": blocks("null", materials=GLUED, flags=ZONED, saves=(*SAVES, *ON_ZONES)),
    "cohesive zones, periodic": blocks(
        "null", cells=PERIODIC, materials=GLUED, flags=ZONED, saves=(*SAVES, *ON_ZONES)
    ),
    "diffusion": blocks(
        "friction_bard",
        materials=DIFFUSING,
        flags=DIFFUSES + LOADED,
        extra=SOAKING,
        saves=(*SAVES, *CONCENTRATIONS),
    ),
    "diffusion, periodic": blocks(
        "single_velocity",
        cells=PERIODIC,
        materials=DIFFUSING,
        flags=DIFFUSES,
        saves=(*SAVES, *CONCENTRATIONS),
    ),
    "non-local": blocks(
        "friction_bard", materials=TWO_BLOCKS.replace(HYPO, NONLOCAL), saves=(*SAVES, *FLOWING)
    ),
    "non-local, periodic": blocks(
        "friction_bard",
        cells=PERIODIC,
        materials=TWO_BLOCKS.replace(HYPO, NONLOCAL),
        saves=(*SAVES, *FLOWING),
    ),
    "inserted": blocks("friction_bard", materials=WAITING, flags=INSERTED),
    "stretched": blocks("", "cpdi", materials=STRETCHED, flags=PRESCRIBED, max_time="0.02"),
    "patches of the deck": blocks("friction_bard", patches="[3,2,1]"),
}


HAPPENS = {
    "conversion": ("p.localizedMPM", 1),
    "conversion into another model": ("p.yieldStress", 0),
    "cohesive zones": ("cz.failed", 2),
    "diffusion": ("p.flux", 0),
    "non-local": ("eta_nl", 0),
}
"""What some cases are about: a variable and a material that has values at the end, and not all zero."""


@pytest.mark.parametrize("case", CASES)
def test_several_ranks_give_what_one_gives(case: str, tmp_path: Path) -> None:
    path = write(tmp_path, CASES[case])
    (tmp_path / "jump.txt").write_text(JUMP)
    (tmp_path / "stretch.txt").write_text(STRETCH)
    (tmp_path / "zones.txt").write_text(ZONES)
    run_deck(read_deck(path), output=tmp_path / "one.uda")
    ranks = 4 if "patches" in case else 3
    on_ranks(ranks, lambda rank: run_deck(read_deck(path), output=tmp_path / "many.uda", communicator=rank))
    found = disagreement(tmp_path / "one.uda", tmp_path / "many.uda")
    assert max(found.values()) < ROUNDING, found
    if case in HAPPENS:
        assert Archive(tmp_path / "many.uda").particles(-1, *HAPPENS[case]).any()


def test_nodal_values_are_written_in_steps_after_which_the_halo_grows(tmp_path: Path) -> None:
    """Every step is written: among them those after which corners reach beyond the cells around a rank's."""
    path = write(tmp_path, CASES["stretched"].replace(">40<", ">1<"))
    (tmp_path / "stretch.txt").write_text(STRETCH)
    run_deck(read_deck(path), output=tmp_path / "one.uda")
    on_ranks(3, lambda rank: run_deck(read_deck(path), output=tmp_path / "many.uda", communicator=rank))
    found = disagreement(tmp_path / "one.uda", tmp_path / "many.uda")
    assert max(found.values()) < ROUNDING, found


def test_the_phases_of_ranks_without_particles_of_a_body_are_measured(tmp_path: Path) -> None:
    path = write(tmp_path, CASES["friction"])
    build(read_deck(path))  # loads the models, which threads must not do at a time
    profiles = [Profile() for _ in range(2)]
    on_ranks(
        2,
        lambda rank: run_deck(
            read_deck(path),
            output=tmp_path / "many.uda",
            max_steps=5,
            communicator=rank,
            observers=[profiles[rank.rank]],
        ),
    )
    assert [profile.report.steps for profile in profiles if profile.report] == [4, 4]


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


RESTARTED = {
    "a file each": ("friction", 1),
    "one file": ("friction", 2),
    **{case: (case, 1) for case in ("stretched", *HAPPENS)},
}


@pytest.fixture(scope="module", params=RESTARTED)
def stored(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """An archive of two ranks with checkpoints, run for 40 steps."""
    folder = tmp_path_factory.mktemp("stored")
    case, ranks_a_file = RESTARTED[request.param]
    text = CASES[case].replace("<outputTimestepInterval>40</outputTimestepInterval>", CHECKPOINTS)
    path = write(folder, text.replace("<max_Timesteps>100", "<max_Timesteps>40"))
    (folder / "stretch.txt").write_text(QUICK_STRETCH)
    (folder / "zones.txt").write_text(ZONES)
    build(read_deck(path))  # loads the models, which threads must not do at a time
    options = {"output": folder / "two.uda", "ranks_a_file": ranks_a_file}
    on_ranks(2, lambda rank: run_deck(read_deck(path), communicator=rank, **options))
    for file in ("stretch.txt", "zones.txt"):
        (folder / file).rename(folder / "two.uda" / file)
    return folder / "two.uda"


@pytest.mark.parametrize("ranks", [1, 2, 3])
def test_a_checkpoint_restarts_on_any_number_of_ranks(ranks: int, stored: Path, tmp_path: Path) -> None:
    again = tmp_path / "again.uda"
    on_ranks(ranks, lambda rank: resume_run(stored, step=21, output=again, communicator=rank))
    before, after = Archive(stored), Archive(again)
    last = before.timesteps[-1].step
    assert after.timesteps[-1].step == last == 31
    for label in before.labels(last):
        if before.variables[label].is_particle:
            found = disagreement_at(before, after, last, label)
            assert found == 0.0 if ranks == 2 else found < ROUNDING, label


def disagreement_at(first: Archive, second: Archive, step: int, label: str) -> float:
    from agreement import particles_by_id

    difference = scale = 0.0
    for m in first.materials(step, label):
        x, y = (particles_by_id(a, step, label, m) for a in (first, second))
        difference = max(difference, abs(x - y).max(initial=0.0))
        scale = max(scale, abs(x).max(initial=0.0))
    return difference / (scale or 1.0)
