"""Reading XML safely, and writing it so that Uintah's line scanners understand it.

Uintah reads ``index.xml`` and ``timestep.xml`` line by line, without an XML parser: one element a
line, block tags alone and without attributes, leaves of the form ``<tag>text</tag>`` that are never
empty. The functions here write only such lines.
"""

from __future__ import annotations

import re
from pathlib import Path

from lxml import etree

from ups.archive import checksums
from ups.archive.errors import ArchiveError
from ups.archive.layout import FloatVector, IntVector

HEADER = '<?xml version="1.0" encoding="UTF-8"?>'

_ATTEMPTS = 3

_DAMAGED = "the archive is damaged or was cut off while it was written"


def number(value: float) -> str:
    """Write a number with the 17 digits that give it back exactly, as Uintah does."""
    return f"{value:.17g}"


def triple(values: FloatVector | IntVector) -> str:
    """Write three numbers as ``[x, y, z]``."""
    return "[" + ", ".join(number(value) for value in values) + "]"


def escape(text: str) -> str:
    """Write the characters that XML reserves as references (the standard library's own function loads urllib)."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def quoted(text: str) -> str:
    """The text as an attribute's value, in double quotes."""
    inside = escape(text).replace('"', "&quot;").replace("\n", "&#10;").replace("\t", "&#9;")
    return f'"{inside}"'


def leaf(indent: int, tag: str, text: object) -> str:
    """Return the line ``<tag>text</tag>``, indented by `indent` levels.

    Line breaks within the text become blanks.

    Raises
    ------
    ValueError
        For an empty text, which Uintah's scanner cannot read.
    """
    content = " ".join(str(text).split())
    if not content:
        raise ValueError(f"<{tag}> must not be empty")
    return f"{'  ' * indent}<{tag}>{escape(content)}</{tag}>"


def attributes(**values: object) -> str:
    """Attributes in the given order, each preceded by a blank."""
    return "".join(f" {name}={quoted(str(value))}" for name, value in values.items())


def parse(path: Path) -> etree._Element:
    """Root element of an XML file; entities are not expanded and nothing is fetched.

    Raises
    ------
    ArchiveError
        Where the file cannot be read or is not well-formed, with its line, or has checksums that are not its.
    """
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=True)
    try:
        # a file and its sums may be replaced between one being read and the other
        known = any(checksums.check(path, raw := path.read_bytes()) for _attempt in range(_ATTEMPTS))
        root = etree.fromstring(raw, parser)
    except OSError as error:
        raise ArchiveError.from_os_error(path, "read the file", error) from error
    except etree.XMLSyntaxError as error:
        raise ArchiveError(
            path, f"not well-formed XML: {error.msg}", line=error.lineno, advice=_DAMAGED
        ) from error
    if not known:
        raise checksums.damaged(path, checksums.CHANGED)
    return root


class Node:
    """An XML element together with the file it came from, for checked reading."""

    def __init__(self, path: Path, element: etree._Element) -> None:
        self.path = path
        self.element = element

    @classmethod
    def root(cls, path: Path, tag: str) -> Node:
        """Root of the file `path`, which must be called `tag`."""
        node = cls(path, parse(path))
        if node.element.tag != tag:
            raise node.error(f"the root element is <{node.element.tag}> where <{tag}> is due")
        return node

    def error(self, message: str, advice: str = _DAMAGED) -> ArchiveError:
        """Error about this element."""
        return ArchiveError(self.path, message, line=self.element.sourceline, advice=advice)

    def children(self, tag: str) -> list[Node]:
        """Children called `tag`."""
        return [Node(self.path, child) for child in self.element.iterchildren(tag)]

    def child(self, tag: str) -> Node | None:
        """First child called `tag`, or None."""
        found = self.element.find(tag)
        return None if found is None else Node(self.path, found)

    def need(self, tag: str) -> Node:
        """First child called `tag`; its absence is an error."""
        found = self.child(tag)
        if found is None:
            raise self.error(f"<{self.element.tag}> has no <{tag}>")
        return found

    def text(self) -> str:
        """Text of the element, trimmed."""
        return (self.element.text or "").strip()

    def attribute(self, name: str) -> str:
        """Attribute called `name`; its absence is an error."""
        value = self.element.get(name)
        if value is None:
            raise self.error(f"<{self.element.tag}> has no attribute {name}")
        return str(value)

    def integer(self) -> int:
        """Text of the element as an integer."""
        return self._integer(self.text())

    def real(self, attribute: str | None = None) -> float:
        """Text of the element, or one of its attributes, as a number."""
        text = self.text() if attribute is None else self.attribute(attribute)
        try:
            return float(text)
        except ValueError:
            raise self.error(f"{text!r} in <{self.element.tag}> is not a number") from None

    def real_triple(self) -> FloatVector:
        """Text of the form ``[x, y, z]`` as three numbers."""
        x, y, z = (Node._real(self, part) for part in self._parts())
        return x, y, z

    def integer_triple(self) -> IntVector:
        """Text of the form ``[i, j, k]`` as three integers."""
        i, j, k = (self._integer(part) for part in self._parts())
        return i, j, k

    def _parts(self) -> list[str]:
        match = re.fullmatch(r"\[([^,\]]*),([^,\]]*),([^,\]]*)\]", self.text())
        if match is None:
            raise self.error(f"{self.text()!r} in <{self.element.tag}> is not of the form [x, y, z]")
        return [part.strip() for part in match.groups()]

    def _integer(self, text: str) -> int:
        if not re.fullmatch(r"[+-]?[0-9]{1,18}", text):
            raise self.error(f"{text!r} in <{self.element.tag}> is not an integer")
        return int(text)

    def _real(self, text: str) -> float:
        try:
            return float(text)
        except ValueError:
            raise self.error(f"{text!r} in <{self.element.tag}> is not a number") from None
