"""What is under the cursor, in texts that are being typed."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ups.lsp.spot import Kind, children, spot_at


def at(text: str):
    """The spot of ``|`` in a text."""
    return spot_at(text.replace("|", ""), text.index("|"))


@pytest.mark.parametrize(
    ("text", "kind", "word", "parents"),
    [
        ("<a>\n <|", Kind.TAG, "", ["a"]),
        ("<a>\n <de|ns\n</a>", Kind.TAG, "dens", ["a"]),
        ("<a><b>1</b><c>|2</c></a>", Kind.TEXT, "2", ["a", "c"]),
        ("<a><b>1</b></|a>", Kind.CLOSING, "a", ["a"]),
        ('<a><b type="jo|hn"/></a>', Kind.VALUE, "john", ["a"]),
        ('<a><b type="|', Kind.VALUE, "", ["a"]),
        ('<a>\n<b type="jo|\n<c>1</c></a>', Kind.VALUE, "jo\n", ["a"]),
        ("<a><b ty|pe='x'/></a>", Kind.ATTRIBUTE, "type", ["a"]),
        ("<a><b |/></a>", Kind.ATTRIBUTE, "", ["a"]),
        ("<a><!-- <b> some|thing -->", Kind.SKIPPED, "something", ["a"]),
        ("<a><!-- <b> --> |", Kind.TEXT, "", ["a"]),
        ("<a><b>[1, 2|5, 3]</b></a>", Kind.TEXT, "25", ["a", "b"]),
        ("<a></b><c>|", Kind.TEXT, "", ["a", "c"]),
        ("|<a>", Kind.TEXT, "", []),
    ],
)
def test_the_part_and_the_tags_around_it_are_found(text, kind, word, parents):
    spot = at(text)
    assert (spot.kind, spot.word, [tag.tag for tag in spot.parents]) == (kind, word, parents)


def test_the_attribute_of_a_value_and_its_tag_are_known():
    spot = at('<a>\n <save material="0" label="p.|x"/>')
    assert (spot.owner.tag, spot.attribute, spot.owner.attributes["material"]) == ("save", "label", "0")


def test_children_are_those_of_one_tag():
    text = '<a><b>\n<type> gimp </type><c><d/></c><e x="1"/></b><f/></a>'
    parent = spot_at(text, text.index("<type>")).parents[-1]
    assert [(child.tag, value) for child, value in children(text, parent)] == [
        ("type", "gimp"),
        ("c", ""),
        ("e", ""),
    ]


@given(st.text(alphabet="<>/=\"'! -ab\n?", max_size=60), st.integers(0, 60))
def test_any_text_has_a_spot_anywhere(text, offset):
    spot = spot_at(text, min(offset, len(text)))
    assert text[spot.start : spot.end] == spot.word
