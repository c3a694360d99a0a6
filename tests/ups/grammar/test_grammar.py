"""The language as declared: complete, explained, and as a schema that good decks satisfy."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from lxml import etree
from small_decks import deck

from solver.declare import FAMILIES, fields
from ups.document import read_document
from ups.explain import all_codes, explain, explain_code, explain_command
from ups.grammar import EXTENSIONS, extension
from ups.grammar.components import COMPONENTS
from ups.grammar.index import places, tag_index
from ups.schema import relax_ng

CORPUS = Path(__file__).resolve().parents[4] / "shared" / "corpus"
needs_corpus = pytest.mark.skipif(not CORPUS.is_dir(), reason="the corpus of decks is not here")


def test_every_place_of_every_tag_has_a_meaning():
    assert len(places()) > 2000
    assert [p.tag for p in places() if not p.info.parameter.meaning.strip()] == []


def test_extensions_extend_records_that_exist():
    import importlib

    for where in EXTENSIONS:
        module, _, name = where.partition(":")
        record = getattr(importlib.import_module(module), name)
        assert extension(record) is not None
        assert not {i.name for i in fields(extension(record)) if i.required}


@pytest.mark.parametrize("name", [n for n, c in COMPONENTS.items() if c.record is not None])
def test_every_method_declares_its_sections(name):
    tags = {info.tag for info in fields(COMPONENTS[name].load())}
    assert {"Time", "Grid", "DataArchiver", "MaterialProperties"} <= tags


def test_the_index_knows_where_tags_belong():
    assert tag_index()["maxTime"] == ("Time",)
    assert "material" in tag_index()["density"]
    assert "equation_of_state" in tag_index()["Gamma_0"]


def test_every_code_is_explained():
    for code, title in all_codes().items():
        page = explain_code(code)
        assert page.startswith(f"{code}: {title}")
        assert len(page) > len(code) + len(title) + 20, f"{code} has no page"


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("<density>", ("kg/m^3", "<material>", "required")),
        ("material/density", ("kg/m^3",)),
        ("interpolator", ("gimp", "default linear", "<MPM>")),
        ("comp_neo_hook", ("Simo", "bulk_modulus", "Pa")),
        ("kayenta", ("not supported",)),
        ("gurson", ("Tvergaard", '<yield_condition type="gurson">', "example:", "<q1>")),
        ("johnson_cook", ("damage_model", "flow_model", "<D1>", "<A>")),
        ("gimp", ("hat function", "<interpolator>gimp</interpolator>")),
        ("friction_bard", ("<contact> <type>friction_bard</type>", "Coulomb")),
        ("use_load_curves", ("default false", "<MPM>", "example:")),
        ("p.stress", ("Cauchy", "Pa")),
        ("p.plasticStrain", ("computed by constitutive_model", "elastic_plastic")),
        ("UPS402", ("Why.", "Repair.")),
        ("plasticity_model", ("flow_model",)),
    ],
)
def test_explain_says_what_matters(name, parts):
    text = explain(name)
    assert text is not None
    for part in parts:
        assert part in text


def test_explain_suggests_what_was_meant():
    text, status = explain_command("densty")
    assert status == 1
    assert "density" in text


def test_models_that_this_program_runs_win_over_the_grammar():
    """Whoever adds a model need not touch the grammar."""
    for family in FAMILIES.values():
        for name, record in family.models.items():
            assert family.find(name) is record


@pytest.fixture(scope="module")
def schema() -> etree.RelaxNG:
    return etree.RelaxNG(etree.fromstring(relax_ng().encode()))


def as_xml(text: str) -> etree._Element:
    return etree.fromstring(read_document("deck.ups", text=text).to_xml().encode())


def test_the_schema_takes_a_good_deck(schema):
    assert schema.validate(as_xml(deck())), schema.error_log


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("<density>1000.0</density>", "<densty>1000.0</densty>"),
        ("<density>1000.0</density>", ""),
        ("<density>1000.0</density>", "<density>much</density>"),
        ("[2,2,1]", "[2,2]"),
        ('type="hypo_elastic"', 'type="hypo"'),
        ("linear", "liner"),
    ],
)
def test_the_schema_refuses_a_broken_deck(schema, before, after):
    assert not schema.validate(as_xml(deck().replace(before, after)))


@needs_corpus
def test_the_schema_takes_the_decks_that_uintah_runs(schema, monkeypatch):
    """Except one, with a constant of another equation of state that Uintah's validator lets pass."""
    monkeypatch.chdir(CORPUS)
    names = (CORPUS / "accepted.txt").read_text().split()
    refused = []
    for name in names:
        tree = etree.fromstring(read_document(f"inputs/{name}").to_xml().encode())
        if not schema.validate(tree):
            refused.append(name)
    assert refused == ["MPMICE/InductionTime.ups"]


def test_a_section_may_require_what_its_base_leaves_open():
    from ups.grammar.ice_material import GasRegion, PlainRegion

    required = {record: {i.tag for i in fields(record) if i.required} for record in (PlainRegion, GasRegion)}
    assert required[PlainRegion] == set()
    assert required[GasRegion] == {"res", "velocity", "temperature", "density", "pressure"}


def test_a_model_is_found_without_loading_its_whole_family():
    program = (
        "import sys, ups.deck; from solver.declare import FAMILIES; "
        "family = FAMILIES['constitutive_model']; "
        "names = [family.find(n).__name__ for n in ('comp_neo_hook', 'UCNH', 'hypoelastic_plastic')]; "
        "print(names, family.find('nothing'), 'solver.materials.visco_scram' in sys.modules)"
    )
    run = subprocess.run(
        [sys.executable, "-c", program],
        cwd=Path(__file__).resolve().parents[3],
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout.strip() == "['CompNeoHook', 'CompNeoHook', 'ElasticPlastic'] None False"
