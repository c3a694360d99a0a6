"""Reading records from decks: what is read, what is reported, and that one problem does not hide another."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from small_decks import LEFT, deck, material

from ups.deck import read_deck
from ups.diagnostics import DeckError, Severity


def read(text: str, tmp_path: Path):
    return read_deck(tmp_path / "small.ups", text=text)


def found(text: str, tmp_path: Path) -> list[tuple[str, str]]:
    return [(d.code, d.severity.value) for d in read(text, tmp_path).diagnostics]


def the_one(text: str, tmp_path: Path, code: str):
    hits = [d for d in read(text, tmp_path).diagnostics if d.code == code]
    assert len(hits) == 1
    return hits[0]


def test_a_good_deck_has_no_findings_and_its_values(tmp_path):
    read_in = read(deck(), tmp_path)
    assert list(read_in.diagnostics) == []
    specification = read_in.require()
    assert specification.Time.timestep_multiplier == 0.4
    assert specification.MaterialProperties.MPM.material[0].constitutive_model.K == 32e6
    assert specification.Grid.Level[0].Box[0].resolution == (8, 5, 1)


@pytest.mark.parametrize(
    ("before", "after", "code", "marked"),
    [
        ("<density>1000.0</density>", "<densty>1000.0</densty>", "UPS102", "densty"),
        ("<density>1000.0</density>", "", "UPS101", "material"),
        ("<density>1000.0</density>", "<density>1000.0</density>" * 2, "UPS104", "density"),
        ("<density>1000.0</density>", "<density>fast</density>", "UPS203", "fast"),
        ("<density>1000.0</density>", "<density/>", "UPS202", "density"),
        ("<density>1000.0</density>", "<density>-1.0</density>", "UPS208", "-1.0"),
        ("<res>[2,2,1]</res>", "<res>[2,2]</res>", "UPS207", "[2,2]"),
        ("<res>[2,2,1]</res>", "<res>2,2,1</res>", "UPS206", "2,2,1"),
        ("<res>[2,2,1]</res>", "<res>[2,2,1.5]</res>", "UPS204", "[2,2,1.5]"),
        ('type="hypo_elastic"', 'type="hypo_elatic"', "UPS209", "hypo_elatic"),
        ("<interpolator>linear", "<interpolator>liner", "UPS209", "liner"),
        ('label="left"', 'lable="left"', "UPS112", "lable"),
        (
            "<filebase>",
            "<compression>gzip</compression><outputInterval>1</outputInterval><filebase>",
            "UPS106",
            "",
        ),
        ("<MPM>\n", "<MPM>text\n", "UPS201", "text"),
        ("<gravity>[0,0,0]</gravity>", "", "UPS106", "PhysicalConstants"),
    ],
)
def test_a_mistake_is_one_error_where_it_stands(tmp_path, before, after, code, marked):
    text = deck(materials=LEFT).replace(before, after, 1)
    errors = [d for d in read(text, tmp_path).diagnostics if d.severity is Severity.ERROR]
    assert [d.code for d in errors] == [code]
    at = errors[0].location
    line = text.splitlines()[at.line - 1]
    assert marked in line[at.column - 1 : at.column - 1 + at.length] or not marked


def test_a_misspelt_tag_is_read_as_what_it_means(tmp_path):
    """The value is checked, and the tag that was meant is not said to be missing."""
    text = deck(materials=LEFT.replace("density>", "densty>").replace("1000.0", "-3"))
    assert sorted(code for code, _ in found(text, tmp_path)) == ["UPS102", "UPS208"]


def test_a_tag_in_the_wrong_section_is_told_where_it_belongs(tmp_path):
    text = deck(flags="<maxTime>1.0</maxTime>")
    problem = the_one(text, tmp_path, "UPS103")
    assert "<Time>" in problem.suggestion


def test_a_tag_of_another_model_is_a_warning_that_names_the_model(tmp_path):
    text = deck(materials=LEFT.replace("<G>", "<he_constant_1>1</he_constant_1><G>"))
    problems = [d for d in read(text, tmp_path).diagnostics if d.code == "UPS105"]
    assert [d.severity for d in problems] == [Severity.WARNING] * len(problems)
    assert any("comp_mooney_rivlin" in d.message for d in problems)


def test_all_problems_are_reported(tmp_path):
    text = deck().replace("<density>1000.0", "<density>much").replace("[0.1,0.1,0.0]", "[0.1,0.1]")
    text = text.replace("<timestep_multiplier>0.4</timestep_multiplier>", "")
    codes = [code for code, _ in found(text, tmp_path)]
    assert codes.count("UPS203") == 2  # in both materials
    assert "UPS207" in codes
    assert "UPS101" in codes


def test_old_names_are_understood_with_a_note_that_repairs_them(tmp_path):
    text = deck(
        materials=LEFT + "<contact><type>friction</type><materials>[0]</materials><mu>0.1</mu></contact>"
    )
    note = the_one(text, tmp_path, "UPS303")
    assert note.severity is Severity.NOTE
    assert "friction_bard" in note.suggestion
    assert note.fix is not None
    assert read(text, tmp_path).require().MaterialProperties.MPM.contact[0] is not None


def test_a_model_that_is_known_and_not_run_is_a_note_for_lint_and_an_error_for_a_run(tmp_path):
    model = '<constitutive_model type="kayenta"><B0>1e9</B0><G0>1e9</G0></constitutive_model>'
    read_in = read(deck(materials=material("[0,0,0]", "[1,1,1]", "[0,0,0]", model)), tmp_path)
    assert [(d.code, d.severity) for d in read_in.diagnostics] == [("UPS412", Severity.NOTE)]
    with pytest.raises(DeckError, match="kayenta"):
        read_in.require()


def test_the_tags_of_a_model_that_is_not_run_are_checked(tmp_path):
    model = '<constitutive_model type="kayenta"><B0>soft</B0><G00>1e9</G00></constitutive_model>'
    codes = {
        code for code, _ in found(deck(materials=material("[0,0,0]", "[1,1,1]", "[0,0,0]", model)), tmp_path)
    }
    assert codes == {"UPS412", "UPS203", "UPS102"}


@pytest.mark.parametrize("name", ["mpmice", "MPMICE", "ice", "impm", "arches"])
def test_a_method_that_is_not_run_is_known(tmp_path, name):
    text = deck().replace('type="mpm"', f'type="{name}"')
    notes = [
        d for d in read(text, tmp_path).diagnostics if d.code == "UPS412" and d.severity is Severity.NOTE
    ]
    assert notes
    with pytest.raises(DeckError):
        read(text, tmp_path).require()


def test_an_unknown_method_is_read_as_the_nearest(tmp_path):
    text = deck().replace('type="mpm"', 'type="mmp"').replace("<density>1000.0", "<density>x")
    codes = [code for code, _ in found(text, tmp_path)]
    assert codes.count("UPS209") == 1
    assert "UPS203" in codes


def test_in_an_incomplete_deck_nothing_is_missing(tmp_path):
    text = deck(materials='<material><include href="nowhere.xml"/><density>a</density></material>')
    codes = {code for code, _ in found(text, tmp_path)}
    assert codes == {"UPS011", "UPS203"}


def test_a_label_may_name_an_earlier_piece_and_only_one(tmp_path):
    twice = LEFT + LEFT.replace("[0.1,0.1,0.0]", "[0.2,0.1,0.0]")
    assert "UPS407" in {code for code, _ in found(deck(materials=twice), tmp_path)}
    unknown = LEFT.replace(
        '<box label="left"><min>[0.1,0.1,0.0]</min><max>[0.4,0.4,0.1]</max></box>', '<box label="x"/>'
    )
    assert "UPS410" in {code for code, _ in found(deck(materials=unknown), tmp_path)}


@pytest.mark.parametrize(
    ("flag", "what"),
    [
        ("<interpolator>4thorderBS</interpolator>", "<interpolator> 4thorderBS"),
        ("<time_integrator>implicit</time_integrator>", "<time_integrator> implicit"),
        ("<DoGranularMPM>true</DoGranularMPM>", "needs the granular method"),
        ("<coupled_flow_analysis>true</coupled_flow_analysis>", "needs pore water"),
    ],
)
def test_options_that_are_known_and_not_run_are_noted_by_the_check_and_refused_by_the_run(
    flag, what, tmp_path
):
    tag = flag[1 : flag.index(">")]
    text = re.sub(f"<{tag}>.*?</{tag}>", "", deck()).replace("<MPM>", f"<MPM>{flag}", 1)
    note = the_one(text, tmp_path, "UPS412")
    assert note.severity is Severity.NOTE
    assert what in note.message
    with pytest.raises(DeckError, match="UPS412"):
        read(text, tmp_path).require()
