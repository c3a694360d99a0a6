"""Where something that the cursor is on comes from: an included file, a named piece of geometry."""

from __future__ import annotations

import os
from pathlib import Path

from ups.diagnostics import Location
from ups.document import Document, locate_include
from ups.element import Element
from ups.lsp.spot import Spot


def definition(spot: Spot, file: Path, document: Document | None) -> Location | None:
    """The place that a spot refers to; None where it refers to none."""
    if spot.owner is None:
        return None
    if spot.owner.tag == "include":
        found = locate_include(spot.owner.attributes.get("href", ""), file)
        return None if found is None else Location(os.fspath(found), 1, 1)
    if spot.attribute == "label" and document is not None and document.root is not None:
        return _piece(document.root, spot.owner.tag, spot.word)
    return None


def _piece(root: Element, tag: str, label: str) -> Location | None:
    """The piece of geometry that was given a name: the one that is not empty."""
    for element in root.iter():
        attribute = element.attributes.get("label")
        if element.tag == tag and element.children and attribute is not None and attribute.value == label:
            return attribute.location
    return None
