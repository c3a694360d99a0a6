"""Comparing two decks by what they mean: layout, comments and the way numbers are written do not count."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass

from ups.diagnostics import DeckError, Location
from ups.document import read_document
from ups.element import Element
from ups.values import numbers

_NAMES = ("name", "label", "type", "side", "id")
"""Attributes that tell the members of a list apart, in the order in which they are tried."""


@dataclass(frozen=True)
class Difference:
    """One difference: where in the deck, and what stands there in each (None where there is nothing)."""

    path: str
    before: str | None
    after: str | None
    location: Location | None = None

    def __str__(self) -> str:
        if self.before is None:
            return f"+ {self.path}: {self.after}"
        if self.after is None:
            return f"- {self.path}: {self.before}"
        return f"~ {self.path}: {self.before} -> {self.after}"


def compare(first: str | os.PathLike[str], second: str | os.PathLike[str]) -> list[Difference]:
    """The differences of two decks, includes in place.

    Raises
    ------
    DeckError : a deck cannot be read.
    """
    return list(_elements(_root(first), _root(second), ""))


def _root(path: str | os.PathLike[str]) -> Element:
    document = read_document(path)
    if document.root is None:
        raise DeckError(document.diagnostics, document.sources)
    return document.root


def _elements(a: Element, b: Element, path: str) -> Iterator[Difference]:
    for name in {**a.attributes, **b.attributes}:
        left, right = a.attributes.get(name), b.attributes.get(name)
        before, after = left.value.strip() if left else None, right.value.strip() if right else None
        if not _same(before, after):
            yield Difference(f"{path}/@{name}".lstrip("/"), before, after, (b if right else a).location)
    if not _same(a.text, b.text):
        yield Difference(path, a.text or None, b.text or None, b.location)
    ours, theirs = _keyed(a), _keyed(b)
    for key in {**ours, **theirs}:
        inner = f"{path}/{key}".lstrip("/")
        if key not in theirs:
            yield Difference(inner, _summary(ours[key]), None, ours[key].location)
        elif key not in ours:
            yield Difference(inner, None, _summary(theirs[key]), theirs[key].location)
        else:
            yield from _elements(ours[key], theirs[key], inner)


def _keyed(element: Element) -> dict[str, Element]:
    """The children by tag, with what tells them apart where a tag stands more than once."""
    count: dict[str, int] = {}
    for child in element.children:
        count[child.tag] = count.get(child.tag, 0) + 1
    keyed: dict[str, Element] = {}
    for child in element.children:
        key = child.tag if count[child.tag] == 1 else f"{child.tag}[{_name(child)}]"
        number = 2
        unique = key
        while unique in keyed:
            unique, number = f"{key}#{number}", number + 1
        keyed[unique] = child
    return keyed


def _name(element: Element) -> str:
    given = (element.attributes[name].value.strip() for name in _NAMES if name in element.attributes)
    return next(given, "")


def _same(a: str | None, b: str | None) -> bool:
    if a == b:
        return True
    if a is None or b is None:
        return False
    x, y = numbers(a), numbers(b)
    return x is not None and x == y and bool(x)


def _summary(element: Element) -> str:
    if element.texts:
        return element.text
    inside = len(element.children)
    return f"a section of {inside} tag{'s' * (inside != 1)}" if inside else "given"


def diff_command(first: str, second: str) -> tuple[str, int]:
    """What ``ups diff A B`` prints, and its exit status: 1 where the decks differ."""
    found = compare(first, second)
    return "\n".join(map(str, found)) or "the decks mean the same", int(bool(found))


def expand_command(path: str) -> tuple[str, int]:
    """What ``ups expand DECK`` prints: the deck with its includes in place.

    Raises
    ------
    DeckError : the deck or one of its includes cannot be read.
    """
    document = read_document(path)
    if document.root is None or document.diagnostics.has_errors:
        raise DeckError(document.diagnostics, document.sources)
    return document.to_xml().rstrip("\n"), 0
