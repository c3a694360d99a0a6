"""What stands at a place of a text that is being typed, so that most of the time it is not well-formed XML."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum

_TOKEN = re.compile(
    r"""
    (?P<skipped> <!--.*?(?:-->|\Z) | <\?.*?(?:\?>|\Z) | <![^>]*(?:>|\Z) )
    | <(?P<close>/?)(?P<name>[^\s<>/="']*)
      (?P<inside>(?:"[^"<]*(?:"|(?=<)|\Z)|'[^'<]*(?:'|(?=<)|\Z)|[^<>"'/]|/(?!>))*)
      (?P<end>/?>)?
    """,
    re.VERBOSE | re.DOTALL,
)
_ATTRIBUTE = re.compile(r"""([^\s=<>/"']+)(?:(\s*=\s*)(?:(["'])(.*?)(?:\3|\Z)|([^\s<>"']*)))?""", re.DOTALL)
_WORD = re.compile(r"[^\s<>,\"'\[\]]+")


class Kind(Enum):
    """The part of the text that a place belongs to."""

    TAG = "the name of an opening tag"
    CLOSING = "the name of a closing tag"
    ATTRIBUTE = "the name of an attribute, or where one may be put"
    VALUE = "the value of an attribute"
    TEXT = "between tags"
    SKIPPED = "a comment or a declaration"


@dataclass(frozen=True)
class OpenTag:
    """An opening tag: its name, its attributes, and the characters ``start:end`` that it takes."""

    tag: str
    attributes: dict[str, str] = field(default_factory=dict)
    start: int = 0
    end: int = 0


@dataclass(frozen=True)
class Spot:
    """What stands at a place.

    Attributes
    ----------
    kind : the part of the text.
    parents : the tags that are open there, from the root on.
    word : the name, value or word of text that is touched, in the characters ``start:end``.
    owner : the tag to which an attribute or a value belongs, and whose name is touched; else None.
    attribute : name of the attribute whose value is touched.
    """

    kind: Kind
    parents: tuple[OpenTag, ...]
    word: str
    start: int
    end: int
    owner: OpenTag | None = None
    attribute: str = ""


def spot_at(text: str, offset: int) -> Spot:
    """What stands at an offset (in characters, between two of them) of a text."""
    parents: list[OpenTag] = []
    for token in _TOKEN.finditer(text):
        inside = token.start() < offset and (
            offset < token.end() or (offset == token.end() and _unended(token))
        )
        if inside:
            return _in_token(token, offset, tuple(parents))
        if token.start() >= offset:
            break
        _step(parents, token)
    start, end = _word_around(text, offset)
    return Spot(Kind.TEXT, tuple(parents), text[start:end], start, end)


def children(text: str, parent: OpenTag) -> Iterator[tuple[OpenTag, str]]:
    """The tags inside an open one as far as it goes, each with the text that follows it directly."""
    depth: list[str] = []
    for token in _TOKEN.finditer(text, parent.end):
        if token["skipped"] is not None:
            continue
        if token["close"]:
            if not depth:
                return
            if token["name"] in depth:
                while depth.pop() != token["name"]:
                    pass
            continue
        if not depth:
            following = text[token.end() : text.find("<", token.end())] if token["end"] == ">" else ""
            yield _open_tag(token), following.strip()
        if token["end"] == ">":
            depth.append(token["name"])


def _step(parents: list[OpenTag], token: re.Match[str]) -> None:
    """Open or close what a token opens or closes.

    A closing tag without an opening one is passed over, and so is a tag whose end is still to be typed.
    """
    if token["skipped"] is not None:
        return
    if not token["close"]:
        if token["end"] == ">":
            parents.append(_open_tag(token))
    elif any(parent.tag == token["name"] for parent in parents):
        while parents.pop().tag != token["name"]:
            pass


def _unended(token: re.Match[str]) -> bool:
    """Whether the end of a token is still to be typed."""
    if token["skipped"] is not None:
        return not token["skipped"].endswith(">")
    return token["end"] is None


def _open_tag(token: re.Match[str]) -> OpenTag:
    attributes = {m[1]: m[4] or m[5] or "" for m in _ATTRIBUTE.finditer(token["inside"])}
    return OpenTag(token["name"], attributes, token.start(), token.end())


def _in_token(token: re.Match[str], offset: int, parents: tuple[OpenTag, ...]) -> Spot:
    if token["skipped"] is not None:
        start, end = _word_around(token.string, offset)
        return Spot(Kind.SKIPPED, parents, token.string[start:end], start, end)
    start, end = token.span("name")
    if offset <= end:
        kind = Kind.CLOSING if token["close"] else Kind.TAG
        return Spot(kind, parents, token["name"], start, end, _open_tag(token))
    if token["close"]:
        return Spot(Kind.CLOSING, parents, "", offset, offset, _open_tag(token))
    base = token.start("inside")
    for match in _ATTRIBUTE.finditer(token["inside"]):
        first, last = base + match.start(1), base + match.end(1)
        if first <= offset <= last:
            return Spot(Kind.ATTRIBUTE, parents, match[1], first, last, _open_tag(token))
        group = 4 if match[3] else 5
        if match[2] and base + match.start(group) <= offset <= base + match.end(group):
            first, last = base + match.start(group), base + match.end(group)
            return Spot(Kind.VALUE, parents, match[group], first, last, _open_tag(token), match[1])
    return Spot(Kind.ATTRIBUTE, parents, "", offset, offset, _open_tag(token))


def _word_around(text: str, offset: int) -> tuple[int, int]:
    """The word that an offset touches on its line, as ``start, end``; empty where there is none."""
    first = text.rfind("\n", 0, offset) + 1
    last = text.find("\n", offset)
    for match in _WORD.finditer(text, first, len(text) if last < 0 else last):
        if match.start() <= offset <= match.end():
            return match.start(), match.end()
    return offset, offset
