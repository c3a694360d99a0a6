"""The files that an editor has open, the decks that they belong to, and what is wrong with them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from ups.deck import Deck
from ups.diagnostics import Diagnostic, Location
from ups.document import DECK_ROOTS, INCLUDE_ROOTS, Document, read_document
from ups.element import Element
from ups.lint import DECK_SUFFIX, component_of, lint_deck
from ups.lsp.context import DEFAULT_COMPONENT
from ups.lsp.spot import OpenTag
from ups.suppression import without_suppressed

MAX_DECKS = 200
"""How many decks of a folder are looked at to find those that include a file."""


@dataclass
class Checked:
    """A deck as it was when it was checked last."""

    deck: Deck
    findings: list[Diagnostic]
    files: frozenset[str] = frozenset()
    """The real paths of all its files."""


@dataclass
class Project:
    """What is open, by real path, and what was found in it.

    Attributes
    ----------
    texts : the text of each open file as the editor has it.
    decks : the decks that were checked.
    """

    texts: dict[str, str] = field(default_factory=dict)
    decks: dict[str, Checked] = field(default_factory=dict)

    def open(self, path: str, text: str) -> None:
        """Take the text of a file from the editor, now and as it changes."""
        self.texts[os.path.realpath(path)] = text

    def close(self, path: str) -> None:
        """Take a file from the disk again, and let go of the decks that no open file belongs to."""
        self.texts.pop(os.path.realpath(path), None)
        self.decks = {name: d for name, d in self.decks.items() if not self.texts.keys().isdisjoint(d.files)}

    def check(self, path: str) -> None:
        """Check the decks that a file belongs to."""
        path = os.path.realpath(path)
        for deck in list(self._decks_of(path)):
            self.decks[deck] = self._checked(deck)

    def findings(self) -> dict[str, list[Diagnostic]]:
        """What is wrong with each file of the decks that were checked, also those where nothing is."""
        found: dict[str, dict[Diagnostic, None]] = {}
        for name, checked in self.decks.items():
            for file in checked.files:
                found.setdefault(file, {})
            for diagnostic in checked.findings:
                file = os.path.realpath(diagnostic.location.file) if diagnostic.location else name
                found.setdefault(file, {})[diagnostic] = None
        return {file: list(diagnostics) for file, diagnostics in found.items()}

    def document_of(self, path: str) -> Document | None:
        """A deck that a file belongs to."""
        path = os.path.realpath(path)
        checked = self.decks.get(path) or next((d for d in self.decks.values() if path in d.files), None)
        return checked.deck.document if checked else None

    def component_of(self, path: str) -> str:
        """The method that the deck of a file is for."""
        document = self.document_of(path)
        found = component_of(document.root) if document is not None and document.root is not None else ""
        return found or DEFAULT_COMPONENT

    def path_of(self, path: str, parents: tuple[OpenTag, ...]) -> tuple[OpenTag, ...]:
        """The tags that are open at a place, from the root of the deck on, which may lie in another file."""
        document = self.document_of(path)
        if not parents or document is None or parents[0].tag not in INCLUDE_ROOTS:
            return parents
        path = os.path.realpath(path)
        if path == os.path.realpath(document.path):
            return parents
        include = next((i for i in document.includes if os.path.realpath(i.path) == path), None)
        if include is None:
            return parents
        around = tuple(_as_open_tag(e) for e in reversed(list(include.element.ancestors())))
        section = include.element.attributes.get("section")
        inner = parents[1:]
        if section is not None:
            tags = [tag for tag in section.value.split("/") if tag]
            if [tag.tag for tag in inner[: len(tags)]] != tags:
                return (*around, *inner)
            keeps_last = not include.element.attributes.get("excludeSectionTag")
            inner = inner[len(tags) - keeps_last :]
        return (*around, *inner)

    def _decks_of(self, path: str) -> Iterator[str]:
        """The decks that are to be checked when a file changes."""
        including = [name for name, checked in self.decks.items() if path in checked.files]
        if path.endswith(DECK_SUFFIX):
            yield from dict.fromkeys((path, *including))
        else:
            yield from including or list(_including(path)) or (path,)

    def _checked(self, path: str) -> Checked:
        deck = lint_deck(path, unsaved=self.texts)
        root, sources = deck.document.root, deck.sources
        found: Iterable[Diagnostic] = deck.diagnostics
        if root is not None and root.tag in INCLUDE_ROOTS and root.tag not in DECK_ROOTS:
            # a file that no deck includes: only its form can be checked
            found = read_document(path, unsaved=self.texts, roots=INCLUDE_ROOTS).diagnostics
        files = frozenset((path, *(os.path.realpath(name) for name in sources)))
        return Checked(deck, without_suppressed(found, sources), files)


def _as_open_tag(element: Element) -> OpenTag:
    values = {name: attribute.value for name, attribute in element.attributes.items()}
    return OpenTag(element.tag, values, element.start, element.open_end)


def _including(path: str) -> Iterable[str]:
    """The decks beside a file, or in the folder above, that mention it."""
    file = Path(path)
    decks = [
        deck
        for folder in (file.parent, file.parent.parent)
        for deck in sorted(folder.glob(f"*{DECK_SUFFIX}"))
    ]
    for deck in decks[:MAX_DECKS]:
        try:
            if file.name in deck.read_text(encoding="utf-8", errors="replace"):
                yield os.path.realpath(deck)
        except OSError:
            continue


def place(diagnostic: Diagnostic, path: str) -> Location:
    """Where a finding is shown: at its place, or at the start of a file where it has none."""
    return diagnostic.location or Location(path, 1, 1)
