"""What is proposed and explained at a place of a deck."""

from __future__ import annotations

import pytest
from small_decks import deck

from ups.lsp.completion import proposals
from ups.lsp.hover import explanation
from ups.lsp.spot import spot_at

FLOW = '<flow_model type="johnson_cook"><A>1</A></flow_model>'


def proposed(text: str) -> dict[str, object]:
    spot = spot_at(text.replace("|", ""), text.index("|"))
    return {p.label: p for p in proposals(spot, spot.parents, text.replace("|", ""), "mpm")}


def explained(text: str) -> str:
    spot = spot_at(text.replace("|", ""), text.index("|"))
    found = explanation(spot, spot.parents, text.replace("|", ""), "mpm")
    return found.text if found else ""


def inserted(before: str, piece: str) -> str:
    """The small deck with a piece before some part of it."""
    assert before in deck()
    return deck().replace(before, piece + before, 1)


def test_tags_of_the_place_are_proposed_and_those_already_there_are_not():
    found = proposed(inserted("<density>", "<|"))
    assert {"damage_model", "erosion", "geom_object", "melt_temp"} <= found.keys()
    assert "density" not in found
    assert "interpolator" not in found


def test_what_is_required_and_missing_comes_first_with_what_it_needs():
    text = inserted("<density>", "<|").replace("<density>1000.0</density>", "", 1)
    assert proposed(text)["density"].missing
    box = proposed(inserted("<res>", "<|"))["box"]
    assert box.snippet.split() == ["box>", "<min>$1</min>", "<max>$2</max>", "</box>"]


def test_all_that_a_model_needs_can_be_put_in_at_once():
    text = deck().replace('<constitutive_model type="hypo_elastic">', "@", 1)
    text = text.replace("@<G>12.e6</G><K>32.e6</K>", '<constitutive_model type="hypo_elastic"><|')
    found = proposed(text)["all required tags"]
    assert found.snippet.count("$") == 2
    assert found.snippet.startswith("G>$1</G>")
    assert found.snippet.endswith("<K>$2</K>")


@pytest.mark.parametrize(
    ("old", "new", "some"),
    [
        ('type="hypo_elastic"', 'type="|"', {"elastic_plastic", "comp_neo_hook"}),
        ("<interpolator>linear", "<interpolator>|", {"linear", "gimp", "cpdi"}),
        ("<type>single_velocity", "<type>|", {"single_velocity", "friction_bard"}),
        ('<save label="p.x"', '<save label="|"', {"p.x", "p.stress", "g.mass", "KineticEnergy"}),
        ('<Face side="z-"', '<Face side="|"', {"x-", "z+"}),
        ('var="symmetry"', 'var="|"', {"Dirichlet", "Neumann", "symmetry"}),
        ('label="Symmetric"', 'label="|"', {"Velocity", "Symmetric", "Temperature"}),
        ('<SimulationComponent type="mpm"', '<SimulationComponent type="|"', {"mpm", "mpmice"}),
        ('<Face side="z-"', "<Face |", {"side", "circle"}),
        ("<contact><type>single_velocity</type>", "<contact><|", {"type"}),
    ],
)
def test_values_are_proposed(old, new, some):
    assert old in deck()
    assert some <= proposed(deck().replace(old, new, 1)).keys()


def test_switches_are_true_or_false():
    text = inserted("<interpolator>", "<use_load_curves>|</use_load_curves>")
    assert set(proposed(text)) == {"true", "false"}


def test_a_closing_tag_closes_the_open_one():
    assert proposed(inserted("<density>", "<erosion></|"))["erosion"].snippet == "erosion>"


def test_files_are_proposed_for_an_include(tmp_path):
    (tmp_path / "more.xml").write_text("<Uintah_Include/>")
    text = '<Uintah_specification><include href="'
    spot = spot_at(text, len(text))
    found = {p.label for p in proposals(spot, spot.parents, text, "mpm", tmp_path / "deck.ups")}
    assert "more.xml" in found
    assert any(name.startswith("JohnsonCook") for name in found)


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ("<density>", "<den|sity>", "kg/m^3"),
        ('type="hypo_elastic"', 'type="hypo_|elastic"', "parameters:"),
        ("<interpolator>linear", "<interpolator>lin|ear", "shape functions"),
        ("<type>single_velocity", "<type>single_|velocity", "centre of mass"),
        ('label="p.stress"', 'label="p.st|ress"', "Cauchy"),
        ('side="z-"', 'si|de="z-"', "whole face"),
        ("</density>", "</dens|ity>", "kg/m^3"),
        ("1000.0</density>", "10|00.0</density>", "density at the start"),
        ("<Meta>", "<!-- ups: ignore UPS4|09 --><Meta>", "interpolator"),
    ],
)
def test_what_is_under_the_cursor_is_explained(old, new, part):
    assert old in deck()
    assert part in explained(deck().replace(old, new, 1))


def test_nothing_is_said_of_nothing():
    assert explained(deck().replace("<Meta>", "|\n<Meta>", 1)) == ""
