"""Each rule on a deck that breaks it, and on one that does not."""

from __future__ import annotations

import pytest
from small_decks import CONTACT, LEFT, RIGHT, deck, material

from ups.lint import lint_text

PRESSURE = """
  <PhysicalBC><MPM><pressure>
    <geom_object><box label="top"><min>[0.1,0.39,0]</min><max>[0.4,0.41,0.1]</max></box></geom_object>
    <load_curve><id>1</id><time_point><time>0</time><load>0</load></time_point>
      <time_point><time>1</time><load>5</load></time_point></load_curve>
  </pressure></MPM></PhysicalBC>"""
LOADS_ON = "<use_load_curves>true</use_load_curves>"
EXTRA = "<extraCells>[1,1,1]</extraCells>"
SIDE = (
    '<Face side="x-"><BCType id="all" var="Dirichlet" label="Velocity"><value>{}</value></BCType></Face><Face'
)


def on_face(value: str) -> str:
    return deck().replace("<Face", SIDE.format(value), 1)


def with_box(lower: str, upper: str) -> str:
    return deck().replace(
        "<lower>[0,0,0]</lower><upper>[0.8,0.5,0.1]</upper>", f"<lower>{lower}</lower><upper>{upper}</upper>"
    )


SECOND_LOAD = PRESSURE[PRESSURE.index("<pressure>") : PRESSURE.index("</MPM>")]
NO_FILE = "<PrescribedDeformationFile>no.txt</PrescribedDeformationFile>"
OTHERWISE = '</BCType><BCType id="all" var="Dirichlet" label="Velocity"><value>[1,0,0]</value></BCType>'
FAR = material("[8,8,8]", "[9,9,9]", "[0,0,0]", name="far")
BRITTLE = LEFT.replace("<geom_object>", '<damage_model type="Brittle"/><geom_object>')
STEEL = LEFT.replace("32.e6", "160.e9").replace("12.e6", "80.e9").replace(">5.0<", ">450<")

UNEVEN = "<spacing>[0.3,0.1,0.1]</spacing>"

CONVERTING = "<create_new_particles>true</create_new_particles>"
ZONES = """
    <cohesive_zone>
      <delta_n>1.0e-3</delta_n><delta_t>1.0e-3</delta_t><sig_max>1.0e6</sig_max><tau_max>1.0e6</tau_max>
      <cz_filename>zones.txt</cz_filename>
    </cohesive_zone>"""

FICK = LEFT.replace(
    "<geom_object>",
    '<diffusion_model type="jg"><diffusivity>1e-6</diffusivity><max_concentration>1</max_concentration>'
    "</diffusion_model><geom_object>",
)
DIFFUSES = "<do_scalar_diffusion>true</do_scalar_diffusion>"

BREAKING = [
    ("UPS401", "error", with_box("[0.8,0.5,0.1]", "[0,0,0]"), "<upper>"),
    ("UPS401", "error", with_box("[0,0,0]", "[0.8,0.5,0.0]"), "in z"),
    ("UPS402", "warning", deck(materials=LEFT + RIGHT + CONTACT.replace("[0,1]", "[0,7]")), "material 7"),
    ("UPS402", "error", deck(saves=('p.x" material="9',)), "material 9"),
    ("UPS402", "error", on_face("[0,0,0]").replace('id="all" var="Dirichlet"', 'id="5" var="Dirichlet"'), "material 5"),
    ("UPS403", "warning", deck(materials=LEFT + FAR + CONTACT), "x, y, z"),
    ("UPS405", "error", deck().replace("<delt_min>0.0", "<delt_min>2.0"), "delt_min"),
    ("UPS405", "error", deck(max_time="0.0"), "ends before"),
    ("UPS406", "error", deck(saves=("p.x", "p.strss")), "p.strss"),
    ("UPS406", "warning", deck(saves=("p.x", "p.plasticStrain")), "p.plasticStrain"),
    ("UPS406", "warning", deck(saves=("p.x", "p.xx")), "p.xx"),
    ("UPS406", "warning", deck(saves=("press_CC",)), "press_CC"),
    ("UPS407", "error", deck(extra=PRESSURE.replace("</MPM>", SECOND_LOAD + "</MPM>"), flags=LOADS_ON), "load curve 1"),
    ("UPS408", "warning", deck(flags="<UsePrescribedDeformation>true</UsePrescribedDeformation>" + NO_FILE), "no.txt"),
    ("UPS409", "error", deck().replace("<interpolator>linear", "<interpolator>gimp"), "add up to"),
    ("UPS409", "error", deck().replace("<patches>", EXTRA + "<patches>"), "no extra cells"),
    ("UPS413", "warning", on_face("1.0"), "[vx, vy, vz]"),
    ("UPS413", "error", on_face("fast"), "[vx, vy, vz]"),
    ("UPS413", "error", on_face("[0,0,0]").replace("Dirichlet", "Dirichlt"), "Dirichlt"),
    ("UPS414", "error", deck(materials=BRITTLE), "erosion"),
    ("UPS415", "warning", deck(extra=PRESSURE), "no effect"),
    ("UPS416", "warning", on_face("[0,0,0]").replace("</BCType>", OTHERWISE, 1), "otherwise"),
    ("UPS417", "warning", deck(materials=LEFT + RIGHT), "pass through"),
    ("UPS417", "warning", deck(materials=LEFT, flags=CONVERTING), "2 materials"),
    ("UPS425", "warning", deck(materials=LEFT + RIGHT + CONTACT + ZONES), "use_cohesive_zones"),
    ("UPS426", "warning", deck(flags=CONVERTING), "no particle fails"),
    ("UPS418", "warning", deck(archiver=""), "interval"),
    ("UPS427", "warning", deck(materials=FICK), "not true"),
    ("UPS427", "error", deck(materials=FICK + RIGHT + CONTACT, flags=DIFFUSES), "needs a <diffusion_model>"),
    ("UPS502", "warning", deck(materials=LEFT.replace("12.e6", "90.e6")), "Poisson"),
    ("UPS502", "warning", deck(materials=LEFT.replace("<density>", "<melt_temp>200</melt_temp><density>")), "melts"),
    ("UPS503", "warning", deck(materials=LEFT.replace("[20.0,3.0,0.0]", "[9000,0,0]")), "speed of sound"),
    ("UPS504", "warning", deck(materials=STEEL.replace("1000.0", "7.8")), "mixed"),
    ("UPS505", "warning", deck().replace("<delt_min>0.0", "<delt_min>0.5"), "unstable"),
    ("UPS506", "warning", deck(archiver="<outputInterval>1e-6</outputInterval>", time=""), "outputs"),
    ("UPS507", "warning", deck(materials=LEFT.replace("[0.4,0.4,0.1]", "[0.101,0.4,0.1]")), "thinner"),
    ("UPS508", "warning", deck(materials=LEFT + RIGHT.replace("[0.4,0.1,0.0]", "[0.2,0.1,0.0]") + CONTACT), "overlaps"),
    ("UPS419", "error", deck(patches="[20,2,1]"), "patches"),
    ("UPS419", "error", deck().replace("<resolution>[8,5,1]</resolution>", ""), "resolution"),
    ("UPS419", "error", deck().replace("<resolution>[8,5,1]</resolution>", UNEVEN), "whole"),
    ("UPS405", "warning", deck().replace("multiplier>0.4", "multiplier>4"), "multiplier"),
    ("UPS402", "error", deck().replace('id="all"', 'id="al"', 1), "index"),
    ("UPS209", "error", deck().replace('side="z-"', 'side="w-"'), "side"),
]  # fmt: skip


@pytest.mark.parametrize(("code", "severity", "text", "part"), BREAKING)
def test_a_rule_finds_what_breaks_it(code, severity, text, part):
    hits = [d for d in lint_text(text).diagnostics if d.code == code]
    assert hits, f"{code} was not found"
    assert hits[0].severity.value == severity
    assert part in hits[0].message
    assert hits[0].location is not None


GOOD = [
    deck(),
    deck(materials=FICK, flags=DIFFUSES, saves=("p.x", "p.concentration", "g.concentration", "TotalConc")),
    deck(extra=PRESSURE, flags=LOADS_ON),
    deck().replace("<interpolator>linear", "<interpolator>gimp").replace("<patches>", EXTRA + "<patches>"),
    on_face("[0.0, 0.0, 0.0]"),
    deck(saves=("p.x", "g.mass", "p.velocity", "KineticEnergy", "p.scalefactor")),
    deck(materials=LEFT.replace("<density>", "<melt_temp>2000</melt_temp><density>")),
]


@pytest.mark.parametrize("text", GOOD)
def test_a_good_deck_breaks_no_rule(text):
    assert [(d.code, d.message) for d in lint_text(text).diagnostics] == []


def test_every_rule_has_a_page_and_is_tested():
    from ups.rules.rule import all_rules

    for rule in all_rules():
        page = rule.__doc__ or ""
        assert "**Why.**" in page
        assert "**Repair.**" in page
        assert rule.code in {case[0] for case in BREAKING}
