"""Comparing decks by meaning, and writing them with includes in place."""

from __future__ import annotations

import pytest
from small_decks import LEFT, RIGHT, deck

from ups.deck_diff import compare, diff_command, expand_command
from ups.diagnostics import DeckError
from ups.lint import lint_text


@pytest.fixture
def pair(tmp_path):
    def write(first: str, second: str):
        (tmp_path / "a.ups").write_text(first)
        (tmp_path / "b.ups").write_text(second)
        return tmp_path / "a.ups", tmp_path / "b.ups"

    return write


def test_layout_and_the_way_numbers_are_written_do_not_count(pair):
    other = deck().replace("<delt_max>1.0<", "<!-- x --> <delt_max>  1e0\n<").replace("[2,2,1]", "[2, 2, 1]")
    assert compare(*pair(deck(), other)) == []


def test_a_changed_value_is_named_with_its_path(pair):
    found = compare(*pair(deck(), deck(max_time="2.0")))
    assert [str(d) for d in found] == ["~ Time/maxTime: 1.0 -> 2.0"]


def test_what_was_added_and_removed_is_told_apart(pair):
    found = [str(d) for d in compare(*pair(deck(materials=LEFT), deck(materials=LEFT + RIGHT)))]
    assert all(line.startswith(("+", "-")) for line in found)
    text, status = diff_command(
        *map(str, pair(deck(), deck().replace("<Meta><title>two blocks</title></Meta>", "")))
    )
    assert (text, status) == ("- Meta: a section of 1 tag", 1)


def test_expanding_puts_includes_in_place(tmp_path):
    (tmp_path / "left.xml").write_text(f"<Uintah_Include>{LEFT}</Uintah_Include>")
    path = tmp_path / "deck.ups"
    path.write_text(deck(materials='<include href="left.xml"/>'))
    text, status = expand_command(str(path))
    assert status == 0
    assert "<include" not in text
    assert not lint_text(text).diagnostics


def test_a_deck_that_cannot_be_read_says_why(tmp_path):
    with pytest.raises(DeckError, match="nowhere"):
        expand_command(str(tmp_path / "nowhere.ups"))
