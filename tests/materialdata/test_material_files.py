"""Every include file of the catalogue: documented, physical, and accepted by the reader of decks."""

from __future__ import annotations

import re
import tomllib

import pytest
from lxml import etree

import materialdata
from solver.declare import FAMILIES, fields
from solver.materials.elastic_plastic import ElasticPlastic
from ups.deck import MaterialSection
from ups.diagnostics import Diagnostics, Severity
from ups.document import read_document
from ups.reader import Reader

FILES = sorted(materialdata.ROOT.glob("*/*.xml"))
PHYSICAL = {
    "density": (1.0e3, 2.3e4),
    "thermal_conductivity": (0.1, 450.0),
    "specific_heat": (100.0, 2000.0),
    "room_temp": (290.0, 300.0),
    "melt_temp": (300.0, 4000.0),
    "shear_modulus": (0.5e9, 2.0e11),
    "bulk_modulus": (1.0e9, 4.0e11),
    "A": (1.0e-12, 2.0e9),
    "C_0": (1000.0, 8000.0),
    "S_alpha": (0.9, 4.0),
    "Gamma_0": (0.5, 3.5),
    "mu_0": (2.0e10, 2.0e11),
    "sigma_Y": (1.0e7, 3.0e9),
}
"""Constants that every solid of the catalogue has within these bounds, SI."""

ids = pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)


def elements(path):
    """The model elements of a file, or its root, and the constants in them."""
    root = etree.parse(path).getroot()
    blocks = [child for child in root if isinstance(child.tag, str) and "type" in child.attrib]
    return [
        (block, [c for c in block.iterdescendants() if isinstance(c.tag, str) and not len(c.findall("*"))])
        for block in (blocks or [root])
    ]


def record_of(block):
    """The declared record of a model element."""
    part = next(info for info in fields(ElasticPlastic) if info.tag == block.tag)
    return FAMILIES[part.sub_model.family].find(block.attrib["type"])


def read(text):
    """The reader's answer to a material section, and its diagnostics."""
    document = read_document("test", text=text, roots=("material",))
    diagnostics = Diagnostics(document.diagnostics)
    section = Reader(diagnostics, lambda name: name).read(MaterialSection, document.root)
    return section, diagnostics


def test_the_catalogue_is_not_empty():
    assert len(FILES) > 80


@ids
def test_every_constant_says_its_unit_and_a_known_source(path):
    for _, constants in elements(path):
        for constant in constants:
            note = constant.getnext()
            assert note is not None
            assert note.tag is etree.Comment, f"{constant.tag} has no comment"
            unit, source = (part.strip() for part in note.text.split(";")[:2])
            assert unit
            assert source in materialdata.sources(), f"{constant.tag}: {source}"


@ids
def test_units_are_those_that_the_model_declares(path):
    for block, constants in elements(path):
        if "type" not in block.attrib:
            continue
        declared = {info.tag: info.parameter.unit for info in fields(record_of(block))}
        for constant in constants:
            unit = constant.getnext().text.split(";")[0].strip()
            assert unit.strip("-") in declared[constant.tag].split(" or "), constant.tag


@ids
def test_constants_are_physical(path):
    for _, constants in elements(path):
        for constant in constants:
            value = float(constant.text)
            low, high = PHYSICAL.get(constant.tag, (float("-inf"), float("inf")))
            assert low <= value <= high, constant.tag


@pytest.mark.parametrize(
    "path", [p for p in FILES if "type" in elements(p)[0][0].attrib], ids=lambda path: path.stem
)
def test_every_model_is_read_without_error_or_warning(path):
    block, constants = elements(path)[0]
    wanted = {"flow_model": "JohnsonCookPlastic4340Steel.xml", "yield_condition": "VonMisesYield.xml"}
    others = "".join(f'<include href="{name}"/>' for tag, name in wanted.items() if tag != block.tag)
    semi_implicit = "<plastic_convergence_algo>biswajit</plastic_convergence_algo>"
    algorithm = semi_implicit if block.attrib["type"] in ("gurson", "rousselier") else ""
    section, diagnostics = read(
        '<material><include href="MaterialConst4340Steel.xml"/><constitutive_model type="elastic_plastic">'
        f'<include href="IsotropicElastic4340Steel.xml"/>{others}{algorithm}<include href="{path.name}"/>'
        "</constitutive_model></material>"
    )
    assert [d for d in diagnostics if d.severity is not Severity.NOTE] == []
    model = getattr(
        section.constitutive_model,
        next(info.name for info in fields(type(section.constitutive_model)) if info.tag == block.tag),
    )
    assert type(model) is record_of(block)
    for constant in constants:
        name = next(info.name for info in fields(type(model)) if info.tag == constant.tag)
        assert getattr(model, name) == float(constant.text)


@pytest.mark.parametrize("path", [p for p in FILES if "Damage" in p.stem], ids=lambda path: path.stem)
def test_damage_constants_fill_a_damage_model(path):
    section, diagnostics = read(
        '<material><include href="MaterialConst4340Steel.xml"/><constitutive_model type="elastic_plastic">'
        '<include href="IsotropicElastic4340Steel.xml"/><include href="JohnsonCookPlastic4340Steel.xml"/>'
        '<include href="VonMisesYield.xml"/></constitutive_model>'
        f'<damage_model type="johnson_cook"><include href="{path.name}"/></damage_model></material>'
    )
    assert [d for d in diagnostics if d.severity is not Severity.NOTE] == []
    assert section is not None


def test_visco_scram_of_pbx_9501_is_read():
    section, diagnostics = read(
        '<material><include href="MatConstPBX9501.xml"/><constitutive_model type="visco_scram">'
        '<include href="ViscoSCRAMPBX9501.xml"/><include href="TimeTempPBX9501.xml"/>'
        "</constitutive_model></material>"
    )
    assert [d for d in diagnostics if d.severity is not Severity.NOTE] == []
    shear = sum(getattr(section.constitutive_model, f"G{i}") for i in range(1, 6))
    assert shear == pytest.approx(3.235e9, rel=1e-3)  # Bennett et al.: the instantaneous modulus


def test_the_relaxation_of_the_binder_is_read():
    section, diagnostics = read(
        '<material><include href="MaterialConstPBX9501Binder.xml"/><constitutive_model type="Maxwell_Weichert">'
        '<include href="MaxwellWeichertPBX9501Binder.xml"/></constitutive_model></material>'
    )
    assert [d for d in diagnostics if d.severity is not Severity.NOTE] == []
    modes = section.constitutive_model.viscoelastic_series.mode
    assert [mode.relaxation_time for mode in modes] == pytest.approx([1.5 * 10.0**-k for k in range(1, 9)])
    # Mas et al.: the modulus of the glass is reached from the rubber over nine decades of time
    assert sum(mode.partial_shear_modulus for mode in modes) == pytest.approx(2.93e8, rel=0.01)


@pytest.mark.parametrize(
    ("old", "today"),
    [
        ("inputs/MPM/MaterialData/MatConst4340St.xml", "4340_steel/MaterialConst4340Steel.xml"),
        ("inputs/MPM/MaterialData/IsoElastic4340St.xml", "4340_steel/IsotropicElastic4340Steel.xml"),
        ("inputs/MPM/MaterialData/MieGrunEOS4340St.xml", "4340_steel/MieGruneisenEOS4340Steel.xml"),
        ("inputs/MPM/MaterialData/JCPlastic4340St.xml", "4340_steel/JohnsonCookPlastic4340Steel.xml"),
        ("MaterialData/JCDamage4340St.xml", "4340_steel/JohnsonCookDamage4340Steel.xml"),
        ("../MaterialData/SCG_6061T6_Al.xml", "6061-T6_aluminium/SCG_6061T6_Al.xml"),
        ("MTSShearAnnCopper.xml", "annealed_copper/MTSShearAnnCu.xml"),
        ("DBStability.xml", "any_material/DruckerBeckerStabilityCheck.xml"),
        ("EOS/MieGruneisenLexan.xml", None),
        ("MaterialData/Cu_BU/MieGruneisenEOSAnnCopper.xml", None),
        ("MaterialConst4340Steel", None),
        ("", None),
    ],
)
def test_names_old_and_new_are_found(old, today):
    assert materialdata.find(old) == (materialdata.ROOT / today if today else None)


def test_no_two_files_answer_to_one_name():
    found = {materialdata.find(path.name) for path in FILES}
    assert found == set(FILES)


def test_words_of_names_are_not_ambiguous():
    with (materialdata.ROOT / "names.toml").open("rb") as file:
        for words in tomllib.load(file).values():
            every = [word for today, others in words.items() for word in (today, *others)]
            assert len(every) == len(set(every))


def test_every_source_is_used_and_dated():
    text = "".join(path.read_text() for path in FILES)
    for key, reference in materialdata.sources().items():
        assert f"; {key}" in text, key
        assert re.search(r"\d{4}|Uintah|catalogue|data sheet", reference)


def test_a_deck_that_uses_an_older_name_is_told_the_new_one():
    deck = '<material><include href="MatConst4340St.xml"/></material>'
    document = read_document("old.ups", text=deck, roots=("material",))
    (note,) = document.diagnostics
    assert (note.code, note.severity) == ("UPS305", Severity.NOTE)
    assert "MaterialConst4340Steel.xml" in note.message
    (edit,) = note.fix.edits
    assert deck[: edit.start] + edit.replacement + deck[edit.end :] == deck.replace(
        "MatConst4340St", "MaterialConst4340Steel"
    )
