"""Old forms: understood as they stand, and the same after the fix was done in the file."""

from __future__ import annotations

import pytest
from small_decks import HYPO, LEFT, deck

from ups.fixes import repaired
from ups.lint import lint_deck, lint_text

PLASTIC = """<constitutive_model type="elastic_plastic">
      <bulk_modulus>32.e6</bulk_modulus><shear_modulus>12.e6</shear_modulus>
      <flow_model type="isotropic_hardening"><sigma_Y>1.e4</sigma_Y><K>1.e5</K></flow_model>
      <yield_condition type="vonMises"/>
    </constitutive_model>"""
METAL = LEFT.replace(HYPO, PLASTIC)
JOHNSON_COOK = "<D1>0.05</D1><D2>3.44</D2><D3>-2.12</D3><D4>0.002</D4><D5>0.61</D5>"
GAS = LEFT.replace(
    '<constitutive_model type="hypo_elastic"><G>12.e6</G><K>32.e6</K></constitutive_model>',
    '<constitutive_model type="ideal_gas"><specific_heat>700</specific_heat></constitutive_model>'
    "<gamma>1.4</gamma>",
)

FORMS = {
    "a flag nothing reads": ("UPS304", deck(flags="<UseMomentumForm>false</UseMomentumForm>")),
    "damage constants in the material": (
        "UPS306",
        deck(
            materials=METAL.replace(
                "<geom_object>", JOHNSON_COOK + '<erosion algorithm="ZeroStress"/><geom_object>'
            )
        ),
    ),
    "erosion of the method": ("UPS302", deck(flags='<erosion algorithm="ZeroStress"/>')),
    "a gas constant of the material": ("UPS302", deck(materials=GAS)),
    "a method as a tag": (
        "UPS302",
        deck().replace(
            '<SimulationComponent type="mpm"/>', "<SimulationComponent><type>mpm</type></SimulationComponent>"
        ),
    ),
    "an old name of a tag": ("UPS301", deck(time="<max_iterations>8</max_iterations>")),
}


@pytest.mark.parametrize("name", FORMS)
def test_an_old_form_is_a_note_and_its_fix_means_the_same(name):
    code, text = FORMS[name]
    old = lint_deck("old.ups", text)
    assert [(d.code, d.severity.value) for d in old.diagnostics] == [(code, "note")]
    result = lint_text(text, "old.ups")
    texts, done = repaired(result.diagnostics, result.sources)
    assert done == 1
    new = lint_deck("old.ups", texts["old.ups"])
    assert list(new.diagnostics) == []
    ours, theirs = old.require().MaterialProperties.MPM, new.require().MaterialProperties.MPM
    assert [m.constitutive_model for m in ours.material] == [m.constitutive_model for m in theirs.material]
    assert new.require().Time == old.require().Time
    assert new.require().MPM == old.require().MPM


def test_constants_of_damage_become_a_model():
    _, text = FORMS["damage constants in the material"]
    from ups.deck import read_deck

    element = read_deck("old.ups", text=text).document.root.find(
        "MaterialProperties/MPM/material/damage_model"
    )
    assert [child.tag for child in element.children] == ["D1", "D2", "D3", "D4", "D5"]
