"""The catalogue as a call and as a table."""

from __future__ import annotations

import io
import math

import pytest

from ups.diagnostics import DeckError
from ups.materials import catalogue, common_models, find_material, print_catalogue


def value(entry, tag, constant, model=""):
    """A constant of a material by model and tag."""
    return next(float(c.value) for c in entry.file_of(tag, model).constants if c.tag == constant)


def test_materials_of_the_paper_are_there():
    names = {entry.name for entry in catalogue()}
    assert {"annealed_copper", "OFHC_copper", "4340_steel", "6061-T6_aluminium", "HY100_steel"} <= names
    assert {"S7_tool_steel", "Armco_iron", "tantalum", "tungsten", "uranium", "304_stainless_steel"} <= names
    assert {"PBX_9501", "PBX_9501_binder", "HMX", "Lexan", "cartridge_brass", "2024-T351_aluminium"} <= names


def test_an_entry_lists_its_models_and_sources():
    copper = find_material("annealed copper")
    assert set(copper.models["flow_model"]) == {
        "johnson_cook",
        "mts_model",
        "preston_tonks_wallace",
        "zerilli_armstrong",
    }
    assert copper.models["damage_model"] == ("johnson_cook",)
    assert any("Follansbee" in source for source in copper.sources)
    assert value(copper, "flow_model", "A", "johnson_cook") == 90.0e6
    assert value(copper, "material", "density") == 8930.0


@pytest.mark.parametrize("name", ["6061-T6_aluminium", "6061 t6 ALUMINIUM", "6061T6aluminium"])
def test_names_are_forgiving(name):
    assert find_material(name).name == "6061-T6_aluminium"


def test_an_unknown_material_is_a_diagnostic_with_a_guess():
    with pytest.raises(DeckError) as caught:
        find_material("tantalun")
    (problem,) = caught.value.diagnostics
    assert problem.code == "UPS410"
    assert "tantalum" in problem.suggestion


def test_every_material_has_what_a_deck_requires():
    for entry in catalogue():
        tags = {c.tag for c in entry.file_of("material").constants}
        assert {"density", "specific_heat", "thermal_conductivity"} <= tags, entry.name


def test_the_shock_speed_at_rest_is_the_bulk_sound_speed():
    """Moduli and equation of state come from different measurements; they agree to a quarter, iron aside.

    (The Hugoniot of iron and steels is that of the phase above 13 GPa, extrapolated to a softer state.)
    """
    for entry in catalogue():
        eos = entry.file_of("equation_of_state", "mie_gruneisen")
        if eos is None or any(c.remark == "of iron" for c in eos.constants) or entry.name == "Armco_iron":
            continue
        bulk = value(entry, "constitutive_model", "bulk_modulus")
        speed = math.sqrt(bulk / value(entry, "material", "density"))
        assert speed == pytest.approx(value(entry, "equation_of_state", "C_0", "mie_gruneisen"), rel=0.25), (
            entry.name
        )


def test_common_models_need_no_constants():
    assert "vonMises" in common_models().models["yield_condition"]
    assert common_models().name not in {entry.name for entry in catalogue()}


def test_the_catalogue_prints_every_material():
    out = io.StringIO()
    print_catalogue(file=out)
    for entry in catalogue():
        assert entry.name in out.getvalue()


def test_one_material_prints_values_units_and_references():
    out = io.StringIO()
    print_catalogue("uranium", out)
    text = out.getvalue()
    for wanted in ("19050.0", "kg/m^3", "SCG_U.xml", "Steinberg, S. G. Cochran"):
        assert wanted in text
