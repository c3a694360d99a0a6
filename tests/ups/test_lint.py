"""Linting: repairs, suppression, selection, many decks, and decks that were broken at random."""

from __future__ import annotations

import json
import random
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from small_decks import HYPO, LEFT, deck

from ups.lint import LintOptions, find_decks, fix_files, lint_command, lint_deck, lint_files, lint_text
from ups.suppression import without_suppressed

ROOT = Path(__file__).resolve().parents[2]
CORPUS = ROOT.parent / "shared" / "corpus"
needs_corpus = pytest.mark.skipif(not CORPUS.is_dir(), reason="the corpus of decks is not here")

PLASTIC = """<constitutive_model type="elastic_plastic">
      <bulk_modulus>32.e6</bulk_modulus><shear_modulus>12.e6</shear_modulus>
      <flow_model type="isotropic_hardening"><sigma_Y>1.e4</sigma_Y><K>1.e5</K></flow_model>
      <yield_condition type="vonMises"/>
    </constitutive_model>"""
METAL = LEFT.replace(HYPO, PLASTIC)
OLD = deck(materials=LEFT, flags="\n    <UseMomentumForm>true</UseMomentumForm>")


def codes(text: str, **options) -> list[str]:
    return [d.code for d in lint_text(text, **options).diagnostics]


def test_a_good_deck_has_no_findings():
    assert codes(deck()) == []


def test_fixes_change_nothing_else(tmp_path):
    path = tmp_path / "old.ups"
    path.write_bytes(OLD.replace("\n", "\r\n").encode("latin-1"))
    result, done = fix_files([path])
    assert done == 1
    assert not result.diagnostics
    assert path.read_bytes() == OLD.replace("\n    <UseMomentumForm>true</UseMomentumForm>", "").replace(
        "\n", "\r\n"
    ).encode("latin-1")


def test_unsafe_fixes_wait_to_be_asked_for(tmp_path):
    path = tmp_path / "typo.ups"
    path.write_text(deck(materials=LEFT.replace("density>", "densty>")))
    result, done = fix_files([path])
    assert done == 0
    assert result.diagnostics.has_errors
    result, done = fix_files([path], unsafe=True)
    assert done == 1
    assert not result.diagnostics
    assert path.read_text() == deck(materials=LEFT)


def test_a_wrong_root_is_renamed_on_request(tmp_path):
    path = tmp_path / "root.ups"
    path.write_text(deck().replace("Uintah_specification", "uintah_spec"))
    result, done = fix_files([path], unsafe=True)
    assert (done, len(result.diagnostics), path.read_text()) == (1, 0, deck())


def test_a_cause_in_an_included_file_is_repaired_there(tmp_path):
    constants = "<D1>0.05</D1>\n    <D2>3.44</D2>\n    <D3>-2.12</D3>\n    <D4>0.002</D4>\n    <D5>0.61</D5>"
    included = tmp_path / "damage.xml"
    included.write_text(f"<Uintah_Include>\n    {constants}\n</Uintah_Include>\n")
    path = tmp_path / "deck.ups"
    before = deck(
        materials=METAL.replace(
            "<geom_object>", '<include href="damage.xml"/><erosion algorithm="ZeroStress"/><geom_object>'
        )
    )
    path.write_text(before)
    assert [d.code for d in lint_files([path]).diagnostics] == ["UPS306"]
    result, done = fix_files([path])
    assert done == 1
    assert not result.diagnostics
    assert path.read_text() == before
    assert '<damage_model type="johnson_cook">' in included.read_text()


def test_the_difference_shows_what_a_fix_would_do(tmp_path):
    path = tmp_path / "old.ups"
    path.write_text(OLD)
    text, status = lint_command([path], LintOptions(diff=True))
    assert status == 0
    removed = [line for line in text.splitlines() if line.startswith("-") and not line.startswith("---")]
    assert removed == ["-    <UseMomentumForm>true</UseMomentumForm>"]
    assert path.read_text() == OLD


def test_a_comment_keeps_a_finding_quiet():
    line = "<UseMomentumForm>true</UseMomentumForm>"
    assert codes(OLD) == ["UPS304"]
    assert codes(OLD.replace(line, line + " <!-- ups: ignore UPS304 -->")) == []
    assert codes(OLD.replace(line, "<!-- ups: ignore UPS3 -->\n    " + line)) == []
    assert codes(OLD.replace("<Meta>", "<!-- ups: ignore-file UPS304 -->\n<Meta>")) == []


def test_a_comment_that_keeps_nothing_quiet_is_reported():
    text = deck().replace("<Meta>", "<!-- ups: ignore UPS102 -->\n<Meta>")
    result = lint_text(text)
    assert [(d.code, d.location.line) for d in result.diagnostics] == [("UPS014", 3)]


@pytest.mark.parametrize(
    ("comment", "before"),
    [
        ("  <!-- ups: ignore UPS102 -->\n", "  <Meta>"),
        (" <!-- ups: ignore UPS102, UPS4 -->", "\n  <SimulationComponent"),
    ],
)
def test_a_comment_that_keeps_nothing_quiet_is_removed_without_a_trace(tmp_path, comment, before):
    path = tmp_path / "deck.ups"
    path.write_text(deck().replace(before, comment + before))
    _, done = fix_files([path])
    assert (done, path.read_text()) == (1, deck())


def test_codes_are_selected_by_prefix():
    text = OLD.replace("<density>1000.0", "<density>x")
    assert codes(text) == ["UPS304", "UPS203"]
    assert codes(text, select=["UPS2"]) == ["UPS203"]
    assert codes(text, ignore=["UPS2"]) == ["UPS304"]


def test_folders_are_searched_and_shared_between_processes(tmp_path):
    for number in range(6):
        folder = tmp_path / f"part{number % 2}"
        folder.mkdir(exist_ok=True)
        (folder / f"deck{number}.ups").write_text(OLD if number else deck())
    assert len(list(find_decks([tmp_path]))) == 6
    one, many = lint_files([tmp_path]), lint_files([tmp_path], jobs=2)
    assert list(one.diagnostics) == list(many.diagnostics)
    assert len(one.diagnostics) == 5


def test_processes_that_share_decks_bring_back_findings_of_every_rule(tmp_path):
    """In a fresh process, whose rules are not loaded before the findings arrive."""
    for number in range(3):
        (tmp_path / f"deck{number}.ups").write_text(
            deck(patches="[20,2,1]", flags='<erosion algorithm="none"/>')
        )
    program = (
        f"from ups.lint import lint_files; print(len(lint_files([{str(tmp_path)!r}], jobs=2).diagnostics))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert run.stdout.strip() == "6"


def test_the_exit_status_tells_errors_from_warnings(tmp_path):
    text, status = lint_command([], LintOptions(form="json"), text=OLD)
    assert (status, [d["severity"] for d in json.loads(text)["diagnostics"]]) == (0, ["note"])
    text, status = lint_command([], LintOptions(), text=OLD.replace("<density>1000.0", "<density>x"))
    assert status == 1
    assert text.endswith("1 error, 0 warnings, 1 note")


def test_a_missing_file_is_a_finding():
    assert [d.code for d in lint_files(["nowhere.ups"]).diagnostics] == ["UPS001"]


# ---- bad input -------------------------------------------------------------------------------------------------


def broken(text: str, seed: int) -> str:
    """The text with a few pieces taken out, doubled, exchanged or replaced."""
    chance = random.Random(seed)
    for _ in range(chance.randint(1, 4)):
        start = chance.randrange(len(text))
        end = min(len(text), start + chance.choice((1, 2, 5, 20, 100)))
        piece = text[start:end]
        other = chance.choice(
            (
                "",
                piece * 2,
                piece[::-1],
                "<",
                ">",
                "&",
                "\x00",
                "nan",
                "-1",
                "[1,2",
                "1e999",
                "é",
                "<!--",
                "]]>",
                "</a>",
            )
        )
        text = text[:start] + other + text[end:]
    return text


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.integers(min_value=0, max_value=2**32))
def test_a_deck_broken_at_random_gives_diagnostics_and_no_exception(seed):
    result = lint_text(broken(OLD, seed))
    assert all(d.message for d in result.diagnostics)


@settings(max_examples=40, deadline=None)
@given(st.text(max_size=300))
def test_any_text_at_all_gives_diagnostics_and_no_exception(text):
    assert lint_text(text).diagnostics


@pytest.mark.parametrize(
    "content",
    [
        b"\xff\xfe" + deck().encode("utf-16-le"),
        deck().encode("utf-16"),
        b"\x00" * 100,
        b"<a>" * 3_500_000,
        b"<Uintah_specification>" + b"<Time/>" * 1_000_000 + b"</Uintah_specification>",
        b"<Uintah_specification>" + b"<!-- ups: ignore UPS1 -->\n" * 20_000 + b"</Uintah_specification>",
        deck()
        .replace('encoding="UTF-8"', 'encoding="ISO-8859-1"')
        .replace("two blocks", "Gr\xfcn")
        .encode("latin-1"),
        deck().replace("<Meta>", "<Meta\x01 a='1'\x02 b='2'>").encode(),
        b'<Uintah_specification><include href="hostile.ups"/></Uintah_specification>',
        b'<!DOCTYPE a [<!ENTITY b "c">]><Uintah_specification>&b;</Uintah_specification>',
        b"",
        b'<Uintah_specification><include href="../../../../../../etc/passwd"/></Uintah_specification>',
    ],
)
def test_hostile_files_end_soon_and_without_exception(tmp_path, content):
    path = tmp_path / "hostile.ups"
    path.write_bytes(content)
    start = time.process_time()
    checked = lint_deck(path)
    without_suppressed(checked.diagnostics, checked.sources)
    assert time.process_time() - start < 5.0


@pytest.mark.parametrize("value", ["0", "-1", "1e300", "1e-300", "-1e300", "9" * 300])
def test_numbers_beyond_sense_give_findings_and_no_exception(value):
    """Every number of a deck in turn."""
    text = deck(materials=METAL, archiver="<outputInterval>0.1</outputInterval>", time="")
    for match in re.finditer(r"(?<=[>\[,])-?[\d.]+(?:e\d+)?(?=[<\],])", text):
        lint_text(text[: match.start()] + value + text[match.end() :])


def test_no_line_of_a_file_that_is_no_xml_is_shown(tmp_path):
    """A deck from a stranger may include any file of the machine that checks it."""
    (tmp_path / "secret").write_text("password: 1234\n")
    (tmp_path / "in").mkdir()
    path = tmp_path / "in" / "deck.ups"
    path.write_text('<Uintah_specification><include href="../secret"/></Uintah_specification>')
    text, status = lint_command([path], LintOptions())
    assert status == 1
    assert "../secret is not an XML file" in text
    assert "1234" not in text


def test_linting_loads_nothing_heavy(tmp_path):
    """No compiler, no graphics: they take longer to load than a deck to check."""
    path = tmp_path / "deck.ups"
    path.write_text(deck())
    program = (
        "import sys; from ups.lint import lint_files; "
        f"assert not lint_files([{str(path)!r}]).diagnostics.has_errors; "
        "heavy = 'numba pyvista vtk scipy lxml rich pygls multiprocessing ssl http.client ups.archive ups.factory';"
        "print([m for m in heavy.split() if m in sys.modules])"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert run.stdout.strip() == "[]"


@needs_corpus
def test_the_decks_that_uintah_runs_have_no_errors(monkeypatch):
    monkeypatch.chdir(CORPUS)
    decks = [Path("inputs") / line for line in (CORPUS / "accepted.txt").read_text().split()]
    wrong = {
        str(d.location and d.location.file)
        for d in lint_files(decks).diagnostics
        if d.severity.value == "error"
    }
    assert wrong == set()


@pytest.mark.parametrize("form", ["text", "json", "github", "sarif"])
def test_a_folder_without_decks_is_said_to_be_empty(tmp_path, form):
    (tmp_path / "notes.txt").write_text("no deck")
    said, status = lint_command([tmp_path], LintOptions(form=form))
    assert "ends in .ups" in said
    assert status == 0
