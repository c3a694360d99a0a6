"""Every model of a metal from its tag in a deck, in today's dialect and in that of 2012, and a particle of each."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from test_damage_and_erosion import JC, VARIABLE
from test_failure_exchange import CRITERIA, EROSIONS
from test_flow_stress import STEEL_MTS
from test_model_exchange import COPPER, DEFORMATION, DT, MODELS, G, K, Specimen

from solver.declare import FAMILIES, fields
from solver.materials.damage.brittle import BrittleDamage
from solver.materials.damage.hancock_mackenzie import HancockMacKenzieDamage
from solver.materials.damage.no_damage import NoDamage
from solver.materials.damage.threshold import Threshold
from solver.materials.distribution.gauss import Gauss
from solver.materials.elastic_plastic import ElasticPlastic
from solver.materials.erosion import lets_fail
from solver.materials.erosion.no_erosion import NoErosion
from solver.materials.hyperelastic_plastic import HyperElasticPlastic
from solver.materials.return_algorithm.semi_implicit import SemiImplicit
from solver.materials.visco_plastic import ViscoPlastic
from solver.materials.viscoplastic_flow.suvic_i import SuvicI
from ups.deck import Deck, MaterialSection, read_deck

FLOW = MODELS["flow_stress"][1]
METAL = ElasticPlastic(K, G, FLOW, plastic_convergence_algo=SemiImplicit())
PARTS = {
    "flow_stress": "flow_model",
    "equation_of_state": "equation_of_state",
    "shear_modulus": "shear_modulus_model",
    "melting": "melting_temp_model",
    "specific_heat": "specific_heat_model",
    "yield_condition": "yield_condition",
    "stability": "stability_check",
    "return_algorithm": "plastic_convergence_algo",
    "deviatoric_stress": "deviatoric_stress_model",
}
"""Family -> field of elastic_plastic."""
EXCHANGED = [
    (family, name, model)
    for family in PARTS
    for name, record in FAMILIES[family].models.items()
    for model in (*MODELS[family], *([STEEL_MTS] if family == "flow_stress" else []))
    if type(model) is record
]
DAMAGE = [
    JC._replace(initial_mean_scalar_damage=0.1, initial_scalar_damage_distrib=Gauss()),
    HancockMacKenzieDamage(0.05, 0.01),
    VARIABLE,
    *(Threshold(criterion, 0.01) for criterion in CRITERIA),
]


def names_of(family: str, model: Any) -> list[str]:
    return [name for name, record in FAMILIES[family].models.items() if type(model) is record]


def typed(record: Any) -> Any:
    """A record with the types of its values, as records without fields are all equal."""
    return (type(record), *map(typed, record)) if isinstance(record, tuple) else record


def value_text(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"[{', '.join(map(repr, value))}]" if isinstance(value, tuple) else repr(value).strip("'")


def children(record: Any) -> str:
    """The tags that give a record its values; what it does not take from a deck, or has by default, is left out."""
    text = ""
    for item in fields(type(record)):
        value = getattr(record, item.name)
        if value is None or (not item.required and typed(value) == typed(item.default)):
            continue
        if item.sub_model is not None:
            text += element(item.sub_model.family, value, item.tag)
        elif hasattr(value, "_fields"):
            text += f"<{item.tag}>{children(value)}</{item.tag}>"
        elif item.many:
            text += "".join(f"<{item.tag}>{children(entry)}</{item.tag}>" for entry in value)
        else:
            text += f"<{item.tag}> {value_text(value)} </{item.tag}>"
    return text


def element(family: str, record: Any, tag: str = "", name: str = "") -> str:
    """A model as a deck gives it."""
    tag, name = tag or FAMILIES[family].tag, name or names_of(family, record)[0]
    key = FAMILIES[family].key
    if key == "text":
        return f"<{tag}> {name} </{tag}>"
    return f'<{tag} {key[1:]}="{name}">{children(record)}</{tag}>'


def material(model: str, damage: str = "", erosion: str = "") -> str:
    return f"""
    <material name="metal">
      <density>{COPPER.density}</density> <thermal_conductivity>386</thermal_conductivity>
      <specific_heat>414</specific_heat> <melt_temp>1356</melt_temp> {model} {damage} {erosion}
      <geom_object> <box label="b"><min>[0,0,0]</min><max>[1,1,1]</max></box> <res>[1,1,1]</res>
        <velocity>[0,0,0]</velocity> <temperature>300</temperature> </geom_object>
    </material>"""


def deck(materials: str, options: str = "") -> Deck:
    """A deck around a material."""
    return read_deck(
        "metal.ups",
        text=f"""<Uintah_specification>
  <SimulationComponent type="mpm"/>
  <Time> <maxTime>1</maxTime> <initTime>0</initTime> <delt_min>0</delt_min> <delt_max>1</delt_max>
    <timestep_multiplier>0.5</timestep_multiplier> </Time>
  <DataArchiver> <filebase>metal.uda</filebase> </DataArchiver>
  <MPM> <time_integrator>explicit</time_integrator> {options} </MPM>
  <MaterialProperties> <MPM> {materials} </MPM> </MaterialProperties>
  <Grid> <Level> <Box label="1"> <lower>[0,0,0]</lower> <upper>[1,1,1]</upper> <resolution>[1,1,1]</resolution>
    <patches>[1,1,1]</patches> </Box> </Level> </Grid>
</Uintah_specification>""",
    )


def only(deck: Deck) -> MaterialSection:
    """The material of a deck that has nothing wrong."""
    assert [d.message for d in deck.diagnostics if d.severity.name != "NOTE"] == []
    (section,) = deck.require().materials
    return section


def goes_on(section: MaterialSection) -> None:
    """A particle of the material bears some steps."""
    damage = NoDamage() if section.damage is None else section.damage
    erosion = NoErosion() if section.erosion is None else section.erosion
    model = section.constitutive_model._replace(failure_is_checked=lets_fail(erosion))
    specimen = Specimen(model, damage, erosion=erosion)
    for _ in range(3):
        assert specimen.advance(DEFORMATION, DT).finite
    assert np.isfinite(specimen.particles.stress).all()
    assert specimen.state.plastic_strain[0] > 0.0 or specimen.particles.localized[0] > 0


@pytest.mark.parametrize(("family", "name", "part"), EXCHANGED, ids=lambda v: v if isinstance(v, str) else "")
@pytest.mark.parametrize("host", ["elastic_plastic", "elastic_plastic_hp", "hyperelastic_plastic"])
def test_every_part_of_a_metal_is_read_from_its_tag(family, name, part, host):
    if host == "hyperelastic_plastic" and family == "deviatoric_stress":
        pytest.skip("hyperelasticity is its own deviatoric stress")
    wanted = METAL._replace(**{PARTS[family]: part, "compute_specific_heat": True})
    if host == "hyperelastic_plastic":
        wanted = HyperElasticPlastic(**{n: getattr(wanted, n) for n in HyperElasticPlastic._fields})
    text = element("constitutive_model", wanted, name=host)
    if name not in ("none", *names_of(family, part)[:1]):
        text = text.replace(f'"{names_of(family, part)[0]}"', f'"{name}"')
        assert f'"{name}"' in text
    section = only(deck(material(text)))
    assert typed(section.constitutive_model) == typed(wanted)
    goes_on(section)


@pytest.mark.parametrize(("family", "name", "part"), EXCHANGED, ids=lambda v: v if isinstance(v, str) else "")
def test_the_dialect_of_2012_says_the_same(family, name, part):
    """hypoelastic_plastic, plasticity_model, damage within the constitutive model, erosion of the method."""
    model = METAL._replace(**{PARTS[family]: part})
    damage, erosion = JC, element("erosion", EROSIONS[2])
    today = element("constitutive_model", model)
    old = today.replace("flow_model", "plasticity_model").replace(
        '"elastic_plastic"', '"hypoelastic_plastic"'
    )
    old = old.removesuffix("</constitutive_model>") + element("damage", damage) + "</constitutive_model>"
    ours = only(deck(material(old), options=erosion))
    theirs = only(deck(material(today, element("damage", damage), erosion)))
    assert typed(ours.constitutive_model._replace(damage_model=NoDamage())) == typed(model)
    assert typed(theirs.constitutive_model) == typed(model)
    assert typed(ours.damage) == typed(theirs.damage) == typed(damage)
    assert typed(ours.erosion) == typed(theirs.erosion) == typed(EROSIONS[2])
    goes_on(ours)


@pytest.mark.parametrize("damage", DAMAGE, ids=lambda m: type(m).__name__)
@pytest.mark.parametrize("erosion", EROSIONS, ids=lambda m: type(m).__name__)
def test_every_damage_and_erosion_is_read_from_its_tag(damage, erosion):
    model = element("constitutive_model", METAL)
    section = only(deck(material(model, element("damage", damage), element("erosion", erosion))))
    assert typed(section.damage) == typed(damage)
    assert typed(section.erosion) == typed(erosion)
    goes_on(section)


def test_brittle_damage_goes_with_a_hyperelastic_material():
    model = (
        '<constitutive_model type="UCNH"> <bulk_modulus>1e9</bulk_modulus> <shear_modulus>1e9</shear_modulus>'
    )
    text = material(
        model + "</constitutive_model>", element("damage", BrittleDamage()), '<erosion algorithm="none"/>'
    )
    assert isinstance(only(deck(text)).damage, BrittleDamage)


def test_viscoplastic_ice_is_read_from_its_tags():
    wanted = ViscoPlastic(
        8.9e9, 3.52e9, SuvicI(integration_parameter_theta=0.25), MODELS["equation_of_state"][1]
    )
    assert typed(only(deck(material(element("constitutive_model", wanted)))).constitutive_model) == typed(
        wanted
    )


def test_switches_of_the_paper_are_read():
    switches = {
        "isothermal": True,
        "do_melting": False,
        "evolve_porosity": False,
        "evolve_damage": False,
        "check_TEPLA_failure_criterion": False,
        "TEPLA_with_damage": True,
        "check_max_stress_failure": True,
        "critical_stress": 1.0e9,
        "taylor_quinney_coeff": 0.8,
        "initial_porosity_distrib": Gauss(),
        "initial_mean_porosity": 0.01,
    }
    wanted = METAL._replace(**switches)
    assert typed(only(deck(material(element("constitutive_model", wanted)))).constitutive_model) == typed(
        wanted
    )


def test_every_name_of_every_part_is_tested():
    assert {family for family, _, _ in EXCHANGED} == set(PARTS)
    for family in PARTS:
        names = {name for listed, name, _ in EXCHANGED if listed == family}
        assert names == set(FAMILIES[family].models)
