"""Looking ahead at a run: the numbers of the plan against those of the deck."""

from __future__ import annotations

import math

import pytest
from small_decks import CONTACT, HYPO, LEFT, RIGHT, deck

from ups.diagnostics import DeckError
from ups.plan import plan_command, plan_run


def test_the_plan_counts_what_the_deck_makes(tmp_path):
    path = tmp_path / "deck.ups"
    path.write_text(deck(materials=LEFT, time="", max_time="0.1"))
    plan = plan_run(path)
    sound = math.sqrt((32e6 + 4 / 3 * 12e6) / 1000.0)
    step = 0.4 * 0.1 / (sound + 20.0)
    assert plan.cells == (8, 5, 1)
    assert plan.particles == 9 * 4  # three by three cells of 2 x 2 x 1 particles
    assert plan.materials[0].model == "hypo_elastic"
    assert plan.interpolator == "linear"
    assert plan.first_step == pytest.approx(step, rel=0.05)
    assert plan.steps == pytest.approx(0.1 / step, rel=0.05)
    assert plan.outputs == plan.steps // 3
    text, status = plan_command(str(path))
    assert status == 0
    assert "36 particles" in text


def test_a_deck_that_cannot_run_has_no_plan(tmp_path):
    path = tmp_path / "deck.ups"
    path.write_text(deck().replace('type="mpm"', 'type="ice"'))
    with pytest.raises(DeckError, match="gas dynamics"):
        plan_run(path)


def test_the_plan_names_the_models_that_the_deck_chose(tmp_path):
    path = tmp_path / "deck.ups"
    metal = """<constitutive_model type="elastic_plastic">
      <bulk_modulus>130.e9</bulk_modulus><shear_modulus>46.e9</shear_modulus>
      <flow_model type="isotropic_hardening"><sigma_Y>1.e8</sigma_Y><K>1.e8</K></flow_model>
    </constitutive_model>"""
    path.write_text(deck(materials=LEFT.replace(HYPO, metal) + RIGHT + CONTACT))
    plan = plan_run(path)
    assert "flow_model isotropic_hardening" in plan.materials[0].parts
    assert "yield_condition vonMises" in plan.materials[0].parts
    assert plan.contacts == ("single_velocity",)
    text, _ = plan_command(str(path))
    assert "flow_model isotropic_hardening" in text
    assert "contact     single_velocity" in text
