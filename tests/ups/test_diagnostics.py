"""Diagnostics: collection, spelling help, fixes and the four output formats."""

import json
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ups.diagnostics import (
    CODES,
    DeckError,
    Diagnostic,
    Diagnostics,
    Edit,
    Fix,
    Location,
    Severity,
    apply_fixes,
    did_you_mean,
    edit_distance,
    is_certain,
    register_code,
    suggestion_for,
)
from ups.diagnostics_format import RENDERERS, render_github, render_json, render_sarif, render_text

DECK = "inputs/MPM/thickCylinderMPM.ups"
SOURCE = "\n" * 63 + "        <densty>7830.0</densty>\n"
TAGS = [
    "density",
    "specific_heat",
    "thermal_conductivity",
    "bulk_modulus",
    "shear_modulus",
    "room_temp",
    "melt_temp",
    "maxTime",
    "initTime",
    "delt_min",
    "delt_max",
    "delt_init",
    "timestep_multiplier",
    "filebase",
    "outputInterval",
    "interpolator",
    "gravity",
    "use_load_curves",
    "artificial_viscosity",
    "boundary_traction_faces",
    "geom_object",
    "constitutive_model",
    "velocity",
    "temperature",
    "lower",
    "upper",
    "resolution",
    "extraCells",
    "patches",
    "spacing",
    "periodic",
    "min",
    "max",
    "radius",
    "bottom",
    "top",
    "materials",
    "momentum",
    "heat",
    "minimum_particle_mass",
    "maximum_particle_velocity",
    "withColor",
    "time_integrator",
    "equation_of_state",
    "flow_model",
    "yield_condition",
    "stability_check",
    "damage_model",
    "erosion",
    "contact",
]


@pytest.fixture
def unknown_tag() -> Diagnostic:
    return Diagnostic(
        "UPS102",
        Severity.ERROR,
        "unknown tag <densty> in <material>",
        Location(DECK, 64, 10, 6),
        "did you mean <density>?",
        Fix((Edit(DECK, 72, 78, "density"),)),
    )


def misspellings(word: str):
    """Every word that comes from dropping or doubling one inner letter, or swapping two neighbours."""
    for i in range(1, len(word) - 1):
        yield word[:i] + word[i + 1 :]
        yield word[:i] + word[i] * 2 + word[i + 1 :]
        yield word[:i] + word[i + 1] + word[i] + word[i + 2 :]


# ----------------------------------------------------------------------------------------- collection


def test_the_same_problem_is_kept_once_and_order_is_by_place():
    found = Diagnostics()
    found.warning("UPS503", "late", Location("b.ups", 9, 1))
    found.error("UPS203", "second", Location("a.ups", 7, 5))
    found.error("UPS203", "first", Location("a.ups", 7, 2))
    found.error("UPS203", "first", Location("a.ups", 7, 2))
    found.note("UPS301", "nowhere", None)
    assert [item.message for item in found] == ["nowhere", "first", "second", "late"]
    assert len(found) == 4
    assert found.count(Severity.ERROR) == 2


def test_only_errors_are_errors():
    found = Diagnostics()
    assert not found
    found.warning("UPS503", "w", None)
    found.note("UPS301", "n", None)
    assert found
    assert not found.has_errors
    found.error("UPS001", "e", None)
    assert found.has_errors


def test_anything_with_a_location_can_be_marked():
    class Placed:
        location = Location("a.ups", 3, 4, 5)

    found = Diagnostics()
    found.error("UPS101", "missing", Placed())
    assert next(iter(found)).location == Location("a.ups", 3, 4, 5)


def test_unregistered_codes_are_refused():
    with pytest.raises(ValueError, match="UPS999"):
        Diagnostics().error("UPS999", "no such code", None)


def test_codes_are_well_formed_and_titles_distinct():
    assert all(code.startswith("UPS") and len(code) == 6 and "0" <= code[3] <= "6" for code in CODES)
    assert len(set(CODES.values())) == len(CODES)


def test_register_code(monkeypatch):
    monkeypatch.setattr("ups.diagnostics.CODES", dict(CODES))
    assert register_code("UPS699", "a new one") == "UPS699"
    assert register_code("UPS699", "a new one") == "UPS699"
    with pytest.raises(ValueError, match="already means"):
        register_code("UPS699", "another")
    with pytest.raises(ValueError, match="UPSnnn"):
        register_code("E1", "short")


def test_deck_error_reads_as_its_diagnostics(unknown_tag):
    error = DeckError([unknown_tag], {DECK: SOURCE})
    assert error.diagnostics.has_errors
    assert str(error) == render_text([unknown_tag], {DECK: SOURCE})


# ------------------------------------------------------------------------------------------- spelling


@pytest.mark.parametrize("tag", TAGS)
def test_one_letter_dropped_doubled_or_swapped_finds_the_tag(tag):
    for wrong in misspellings(tag):
        if wrong not in TAGS:
            assert did_you_mean(wrong, TAGS) == tag, wrong


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("maxtime", "maxTime"),
        ("GRAVITY", "gravity"),
        ("Cp", None),
        ("conductivity_thermal", None),
        ("x", None),
        ("", None),
        ("shear_moduls", "shear_modulus"),
        ("speciic_haet", "specific_heat"),
    ],
)
def test_did_you_mean(word, expected):
    assert did_you_mean(word, TAGS) == expected


def test_the_closest_wins_and_then_the_earlier():
    assert did_you_mean("delt_mon", ["delt_max", "delt_min"]) == "delt_min"
    assert did_you_mean("p.strss", ["p.stress", "g.stress"]) == "p.stress"
    assert did_you_mean("bat", ["cat", "bad", "bar"]) == "bad"


def test_suggestion_phrase():
    assert suggestion_for("densty", TAGS, "<{}>") == "did you mean <density>?"
    assert suggestion_for("qqqqqq", TAGS) is None


def reference_distance(a: str, b: str) -> int:
    """Optimal string alignment by its recursive definition."""
    if not a or not b:
        return len(a) + len(b)
    ways = [
        reference_distance(a[:-1], b) + 1,
        reference_distance(a, b[:-1]) + 1,
        reference_distance(a[:-1], b[:-1]) + (a[-1] != b[-1]),
    ]
    if len(a) > 1 and len(b) > 1 and a[-1] == b[-2] and a[-2] == b[-1]:
        ways.append(reference_distance(a[:-2], b[:-2]) + 1)
    return min(ways)


@settings(max_examples=60, deadline=None)
@given(st.text("abc", max_size=5), st.text("abc", max_size=5), st.integers(0, 5))
def test_edit_distance_is_the_recursive_definition_up_to_the_limit(a, b, limit):
    assert edit_distance(a, b, limit) == min(reference_distance(a, b), limit + 1)


# ---------------------------------------------------------------------------------------------- fixes


def test_fixes_are_applied_at_the_original_positions(unknown_tag):
    text = "<a>1</a><b>2</b>"
    rename = Diagnostic(
        "UPS301",
        Severity.NOTE,
        "old",
        None,
        fix=Fix((Edit("d", 1, 2, "alpha"), Edit("d", 6, 7, "alpha"))),
    )
    value = Diagnostic("UPS303", Severity.NOTE, "old", None, fix=Fix((Edit("d", 11, 12, "3"),)))
    assert apply_fixes([rename, value], {"d": text}) == ({"d": "<alpha>1</alpha><b>3</b>"}, 2)


def test_unsafe_overlapping_and_foreign_fixes_are_left():
    def with_fix(*edits, safe=True):
        return Diagnostic("UPS301", Severity.NOTE, "old", None, fix=Fix(edits, safe))

    found = [
        with_fix(Edit("d", 0, 3, "x")),
        with_fix(Edit("d", 2, 4, "y"), Edit("d", 5, 6, "y")),
        with_fix(Edit("d", 4, 5, "z"), safe=False),
        with_fix(Edit("other", 0, 1, "z")),
        Diagnostic("UPS301", Severity.NOTE, "no fix", None),
    ]
    assert apply_fixes(found, {"d": "abcdef"}) == ({"d": "xdef"}, 1)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10**6))
def test_many_fixes_equal_one_pass_from_left_to_right(seed):
    rng = random.Random(seed)
    text = "".join(rng.choice("abcdef") for _ in range(40))
    cuts = sorted(rng.sample(range(41), 8))
    edits = [Edit("d", a, b, rng.choice(["", "XY", "Z"])) for a, b in zip(cuts[::2], cuts[1::2], strict=True)]
    expected, at = "", 0
    for edit in edits:
        expected += text[at : edit.start] + edit.replacement
        at = edit.end
    expected += text[at:]
    rng.shuffle(edits)
    found = [Diagnostic("UPS301", Severity.NOTE, str(i), None, fix=Fix((e,))) for i, e in enumerate(edits)]
    assert apply_fixes(found, {"d": text}) == ({"d": expected}, 4)


# -------------------------------------------------------------------------------------------- formats


def test_text_is_as_compilers_print_it(unknown_tag):
    assert render_text([unknown_tag], {DECK: SOURCE}) == (
        "error[UPS102]: unknown tag <densty> in <material>\n"
        "  --> inputs/MPM/thickCylinderMPM.ups:64:10\n"
        "   |\n"
        "64 |         <densty>7830.0</densty>\n"
        "   |          ^^^^^^ did you mean <density>?\n"
    )


def test_text_without_the_source_or_a_place(unknown_tag):
    assert render_text([unknown_tag]) == (
        "error[UPS102]: unknown tag <densty> in <material>\n"
        "  --> inputs/MPM/thickCylinderMPM.ups:64:10\n"
        "   = did you mean <density>?\n"
    )
    stopped = Diagnostic("UPS601", Severity.ERROR, "the time step fell to zero", None)
    assert render_text([stopped]) == "error[UPS601]: the time step fell to zero\n"


def test_tabs_keep_the_mark_in_place():
    found = Diagnostic("UPS203", Severity.ERROR, "m", Location("d", 1, 5, 3))
    shown = render_text([found], {"d": "\t\t<a>abc</a>"}).splitlines()
    assert shown[-1].expandtabs(8).index("^") == shown[-2].expandtabs(8).index(">")


def test_long_lines_are_cut_around_the_mark():
    line = "x" * 5000 + "MARK" + "y" * 5000
    shown = render_text([Diagnostic("UPS203", Severity.ERROR, "m", Location("d", 1, 5001, 4))], {"d": line})
    source, mark = shown.splitlines()[-2:]
    assert len(source) < 200
    assert source[mark.index("^") : mark.index("^") + 4] == "MARK"
    assert mark.count("^") == 4


def test_control_characters_do_not_reach_the_terminal():
    found = Diagnostic("UPS203", Severity.ERROR, "bad \x1b[2J", Location("d\x07", 1, 1))
    shown = render_text([found], {"d\x07": "\x1b]0;evil\x07"})
    assert "\x1b" not in shown
    assert "\x07" not in shown


def test_colour_only_when_asked(unknown_tag):
    assert "\x1b" not in render_text([unknown_tag], {DECK: SOURCE})
    assert "\x1b[1;31merror[UPS102]\x1b[0m" in render_text([unknown_tag], {DECK: SOURCE}, colour=True)


def test_json(unknown_tag):
    stopped = Diagnostic("UPS601", Severity.WARNING, "stopped", None)
    assert json.loads(render_json([unknown_tag, stopped])) == {
        "version": 1,
        "diagnostics": [
            {
                "code": "UPS102",
                "severity": "error",
                "message": "unknown tag <densty> in <material>",
                "file": DECK,
                "line": 64,
                "column": 10,
                "length": 6,
                "suggestion": "did you mean <density>?",
                "title": "unknown tag",
                "fix": {
                    "safe": True,
                    "edits": [{"file": DECK, "start": 72, "end": 78, "replacement": "density"}],
                },
            },
            {
                "code": "UPS601",
                "severity": "warning",
                "message": "stopped",
                "file": None,
                "line": None,
                "column": None,
                "length": None,
                "suggestion": None,
                "title": "run stopped",
                "fix": None,
            },
        ],
    }


def test_github_annotations_escape_what_would_end_them():
    found = Diagnostic("UPS203", Severity.NOTE, "50 %\nmore", Location("a,b:c.ups", 3, 4, 2), "write 0.5")
    assert render_github([found]) == (
        "::notice file=a%2Cb%3Ac.ups,line=3,col=4,endColumn=6,title=UPS203::50 %25%0Amore; write 0.5"
    )
    assert render_github([Diagnostic("UPS601", Severity.ERROR, "m", None)]) == "::error title=UPS601::m"


def test_sarif_has_the_parts_that_its_schema_requires(unknown_tag):
    log = json.loads(render_sarif([unknown_tag, Diagnostic("UPS601", Severity.WARNING, "stopped", None)]))
    (run,) = log["runs"]
    assert log["version"] == "2.1.0"
    rules = run["tool"]["driver"]["rules"]
    first, second = run["results"]
    for result in (first, second):
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
    assert (first["level"], second["level"]) == ("error", "warning")
    place = first["locations"][0]["physicalLocation"]
    assert place["artifactLocation"] == {"uri": DECK}
    assert place["region"] == {"startLine": 64, "startColumn": 10, "endColumn": 16}
    (change,) = first["fixes"][0]["artifactChanges"]
    assert change["replacements"] == [
        {"deletedRegion": {"charOffset": 72, "charLength": 6}, "insertedContent": {"text": "density"}}
    ]
    assert first["fixes"][0]["description"]["text"]


@pytest.mark.parametrize("name", ["text", "json", "github", "sarif"])
def test_every_format_takes_no_diagnostics(name):
    assert isinstance(RENDERERS[name]([], {}), str)


@pytest.mark.parametrize(
    ("word", "meant", "candidates", "certain"),
    [
        ("cpid", "cpdi", ["linear", "gimp", "cpdi", "fast_cpdi", "cpti"], True),
        ("GIMP", "gimp", ["gimp", "cpdi"], True),
        ("MohrColoumb", "MohrCoulomb", ["MohrCoulomb", "MaximumPrincipalStress"], True),
        ("cpxi", "cpdi", ["cpdi", "cpti"], False),
        ("gmp", "gimp", ["gimp"], False),
        ("cpdii", "cpdi", ["cpdi", "cpdi2"], False),
    ],
)
def test_what_a_word_can_be_nothing_but(word, meant, candidates, certain):
    assert is_certain(word, meant, candidates) is certain
