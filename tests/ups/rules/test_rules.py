"""Each rule on a deck that breaks it, and on one that does not."""

from __future__ import annotations

import re

import pytest
from small_decks import CONTACT, HYPO, LEFT, RIGHT, deck, material

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


GAS = """<ICE><material><EOS type="ideal_gas"/><dynamic_viscosity>0</dynamic_viscosity>
  <thermal_conductivity>0</thermal_conductivity><specific_heat>716</specific_heat><gamma>1.4</gamma>
  <geom_object><box label="gas"><min>[0,0,0]</min><max>[0.8,0.5,0.1]</max></box><res>[2,2,2]</res>
  <velocity>[0,0,0]</velocity><temperature>300</temperature><density>1.2</density><pressure>101325</pressure>
  </geom_object></material></ICE>"""


def gas_deck() -> str:
    """The small deck with a gas, and conditions on the faces in z only."""
    text = deck().replace('type="mpm"', 'type="mpmice"')
    return text.replace("</MPM></MaterialProperties>", f"</MPM>{GAS}</MaterialProperties>")


SECOND_LOAD = PRESSURE[PRESSURE.index("<pressure>") : PRESSURE.index("</MPM>")]
NO_FILE = "<PrescribedDeformationFile>no.txt</PrescribedDeformationFile>"
OTHERWISE = '</BCType><BCType id="all" var="Dirichlet" label="Velocity"><value>[1,0,0]</value></BCType>'
FAR = material("[8,8,8]", "[9,9,9]", "[0,0,0]", name="far")
BRITTLE = LEFT.replace("<geom_object>", '<damage_model type="Brittle"/><geom_object>')
STEEL = LEFT.replace("32.e6", "160.e9").replace("12.e6", "80.e9").replace(">5.0<", ">450<")

METAL = """<constitutive_model type="elastic_plastic">
      <bulk_modulus>130.e9</bulk_modulus><shear_modulus>46.e9</shear_modulus>
      <flow_model type="{}"><A>9.e7</A><B>2.9e8</B><C>0.025</C><n>0.31</n><m>1.09</m><T_m>1356</T_m></flow_model>{}
    </constitutive_model>"""


def metal(parts: str = "", flow: str = "johnson_cook", beside: str = "", erosion: str = "") -> str:
    """The small deck with one material, a metal of copper's density."""
    text = LEFT.replace(HYPO, METAL.format(flow, parts) + beside + erosion)
    text = text.replace("1000.0</density>", "8930.0</density>").replace(">5.0<", ">385.0<")
    return deck(materials=text)


EROSION = '<erosion algorithm="ZeroStress"/>'
DRUCKER = '<stability_check type="drucker"/>'
JC_DAMAGE = (
    '<damage_model type="johnson_cook"><D1>1</D1><D2>1</D2><D3>1</D3><D4>1</D4><D5>1</D5></damage_model>'
)
GRUNEISEN = (
    '<equation_of_state type="mie_gruneisen">'
    "<C_0>{}</C_0><Gamma_0>2</Gamma_0><S_alpha>1.5</S_alpha></equation_of_state>"
)
COPPER_HEAT = '<specific_heat_model type="copper_Cp"/>'
MTS_SHEAR = (
    '<shear_modulus_model type="mts_shear"><mu_0>1e10</mu_0><D>1e9</D><T_0>200</T_0></shear_modulus_model>'
)
AXISYMMETRIC = deck(flags="<axisymmetric>true</axisymmetric>", materials=LEFT.replace("[2,2,1]", "[2,2,2]"))
THIRD = material("[0.5,0.4,0]", "[0.7,0.45,0.1]", "[0,0,0]", name="third")
WITHIN = LEFT[LEFT.index("<geom_object>") : LEFT.index("</material>")].replace(
    'label="left"', 'label="in it"'
)
SAME = LEFT.replace("</material>", WITHIN + "</material>")
GRAVITY = STEEL.replace("450", "5").replace("1000.0", "7.8")
NO_SYMMETRY = '<Face side="z-"><BCType id="all" var="symmetry" label="Symmetric"/></Face>'
TOUCHING = LEFT.replace("[0.1,0.1,0.0]", "[0.0,0.1,0.0]")


def timed(**tags: str) -> str:
    """The small deck, without a limit of steps, with other limits of time."""
    text = deck(
        time="".join(
            f"<{tag}>{value}</{tag}>"
            for tag, value in tags.items()
            if tag.startswith("m") or tag == "delt_init"
        )
    )
    for tag, value in tags.items():
        text = re.sub(f"<{tag}>[^<]*<", f"<{tag}>{value}<", text)
    return text


COMPUTED = on_face("none").replace('"Dirichlet" label="Velocity"', '"computeFromDensity" label="SpecificVol"')
BOX = '<box label="left"><min>[0.1,0.1,0.0]</min><max>[0.4,0.4,0.1]</max></box>'
FROM_FILE = LEFT.replace(BOX, "<file><name>points.txt</name></file>")
OFTEN = deck(archiver="<outputInterval>1e-3</outputInterval>", time="")
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
    ("UPS413", "error", on_face("0, 0, 0"), "[vx, vy, vz]"),
    ("UPS423", "warning", deck(saves=("p.x", "p.mass", "p.x")), "p.x is saved on line"),
    ("UPS413", "error", on_face("[0,0,0]").replace("Dirichlet", "Dirichlt"), "Dirichlt"),
    ("UPS413", "error", COMPUTED, "number"),
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
    ("UPS417", "warning", deck(materials=LEFT + RIGHT + THIRD + CONTACT), "material 2 is in no <contact>"),
    ("UPS420", "warning", deck().replace(NO_SYMMETRY, ""), "one cell thick in z, without a condition on z-"),
    ("UPS420", "warning", deck(materials=TOUCHING), "no condition on x-, which a body touches"),
    ("UPS420", "warning", deck().replace("<Face", '<Face side="x-"/><Face', 1), "this <Face> has no condition"),
    ("UPS421", "warning", metal(DRUCKER), "<stability_check> does nothing"),
    ("UPS421", "warning", metal(beside=JC_DAMAGE), "no effect"),
    ("UPS421", "warning", metal("<initial_mean_porosity>0.1</initial_mean_porosity>"), "knows no porosity"),
    ("UPS421", "note", metal(MTS_SHEAR), "belongs to the flow stress mts_model"),
    ("UPS421", "warning", metal(GRUNEISEN.format(394)), "sqrt(K / rho) = 3815"),
    ("UPS421", "warning", metal(COPPER_HEAT), "compute_specific_heat"),
    ("UPS421", "warning", metal(COPPER_HEAT).replace("8930", "2700"), "specific heat of copper"),
    ("UPS421", "note", metal().replace("[20.0,3.0,0.0]", "[1200,0,0]"), "none for shocks"),
    ("UPS422", "warning", gas_deck(), "the face x- has no condition on Pressure"),
    ("UPS408", "error", deck(materials=FROM_FILE), "points.txt"),
    ("UPS424", "error", deck(saves=("p.mass", "p.stress")), "p.mass is saved, and p.x"),
    ("UPS428", "warning", deck(materials=LEFT + RIGHT + CONTACT + CONTACT.replace("[0,1]", "[1,0]")), "already"),
    ("UPS502", "warning", metal().replace(">300<", ">1400<"), "melts at 1356"),
    ("UPS503", "warning", on_face("[9000,0,0]"), "the face moves at 9000"),
    ("UPS504", "warning", deck(materials=GRAVITY).replace("[0,0,0]</gravity>", "[0,-9.81,0]</gravity>"), "mixed"),
    ("UPS504", "warning", metal().replace("130.e9", "130").replace("46.e9", "46"), "these moduli beside a density"),
    ("UPS505", "warning", timed(delt_max="1e-9"), "a step of about"),
    ("UPS505", "warning", timed(maxTime="1e-6"), "before its first stable step"),
    ("UPS505", "warning", timed(maxTime="1e9"), "steps of"),
    ("UPS505", "warning", timed(delt_init="1e-12", max_delt_increase="1e-4"), "the step grows"),
    ("UPS506", "warning", deck().replace("[8,5,1]", "[8000,5000,1000]"), "of memory"),
    ("UPS506", "warning", OFTEN.replace("[8,5,1]", "[800,500,100]"), "the archive takes"),
    ("UPS508", "warning", deck(materials=SAME), "another body of material 0"),
    ("UPS509", "note", deck(materials=LEFT.replace("[2,2,1]", "[1,1,1]")), "one particle in a cell in x, y"),
    ("UPS509", "warning", deck(materials=LEFT.replace("[2,2,1]", "[2,20,1]")), "a finer grid gains more"),
    ("UPS509", "warning", AXISYMMETRIC, "one particle in z"),
]  # fmt: skip


@pytest.mark.parametrize(("code", "severity", "text", "part"), BREAKING)
def test_a_rule_finds_what_breaks_it(code, severity, text, part):
    hits = [d for d in lint_text(text).diagnostics if d.code == code]
    assert hits, f"{code} was not found"
    assert [d.severity.value for d in hits if part in d.message] == [severity]
    assert all(d.location is not None for d in hits)


GOOD = [
    deck(),
    deck(materials=FICK, flags=DIFFUSES, saves=("p.x", "p.concentration", "g.concentration", "TotalConc")),
    metal(DRUCKER, erosion=EROSION),
    metal(beside=JC_DAMAGE + EROSION),
    metal(GRUNEISEN.format(3940)),
    metal(COPPER_HEAT + "<compute_specific_heat>true</compute_specific_heat>"),
    deck(materials=LEFT + RIGHT + THIRD + CONTACT.replace("[0,1]", "[0,1,2]")),
    timed(delt_init="1e-5", max_delt_increase="0.1"),
    deck(extra=PRESSURE, flags=LOADS_ON),
    deck().replace("<interpolator>linear", "<interpolator>gimp").replace("<patches>", EXTRA + "<patches>"),
    on_face("[0.0, 0.0, 0.0]"),
    deck(saves=("p.x", "g.mass", "p.velocity", "KineticEnergy", "p.scalefactor")),
    deck(materials=LEFT.replace("<density>", "<melt_temp>2000</melt_temp><density>")),
    deck(flags="<axisymmetric>true</axisymmetric>").replace(NO_SYMMETRY, ""),
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
