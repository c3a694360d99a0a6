"""The tree of a deck: elements, attributes, texts and comments, each knowing its place in its file."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Edit, Location
from ups.source import SourceFile


class Text:
    """A piece of text between tags: `value` without surrounding blanks, at the characters `start:end`."""

    __slots__ = ("end", "source", "start", "value")

    def __init__(self, value: str, source: SourceFile, start: int, end: int) -> None:
        self.value = value
        self.source = source
        self.start = start
        self.end = end

    @property
    def location(self) -> Location:
        """The place of the value; the mark covers its first line."""
        return self.source.location(self.start, self.end)

    def replaced(self, value: str) -> Edit:
        """Return the edit that puts another value in this one's place."""
        return self.source.edit(self.start, self.end, escape(value))

    def __repr__(self) -> str:
        return f"Text({self.value!r})"


class Attribute:
    """An attribute: `name`, and its `value` at the characters `start:end` (between the quotes)."""

    __slots__ = ("end", "name", "name_start", "source", "start", "value")

    def __init__(
        self, name: str, value: str, source: SourceFile, name_start: int, start: int, end: int
    ) -> None:
        self.name = name
        self.value = value
        self.source = source
        self.name_start = name_start
        self.start = start
        self.end = end

    @property
    def location(self) -> Location:
        """The place of the value."""
        return self.source.location(self.start, self.end)

    @property
    def name_location(self) -> Location:
        """The place of the name."""
        return self.source.location(self.name_start, self.name_start + len(self.name))

    def replaced(self, value: str) -> Edit:
        """Return the edit that puts another value in this one's place."""
        return self.source.edit(self.start, self.end, escape(value, quotes=True))

    def renamed(self, name: str) -> Edit:
        """Return the edit that changes the name."""
        return self.source.edit(self.name_start, self.name_start + len(self.name), name)

    def removed(self) -> Edit:
        """Return the edit that takes the attribute out, with the blanks before it."""
        before = self.source.text[: self.name_start].rstrip()
        return self.source.edit(len(before), self.end + 1, "")

    def __repr__(self) -> str:
        return f"Attribute({self.name!r}, {self.value!r})"


class Comment:
    """A comment; `same_line` when it stands behind an element on that element's last line."""

    __slots__ = ("same_line", "value")

    def __init__(self, value: str, same_line: bool = False) -> None:
        self.value = value
        self.same_line = same_line


class Element:
    """An element of a deck.

    `tag`, `attributes` by name, `children` in document order, `texts` (the separate pieces of non-blank
    text: Uintah allows one at most), `parent` (None for the root), `content` (children and comments).
    In `source` the element takes the characters `start:end`, its opening tag `start:open_end`, and its
    closing tag begins at `close_start` (`end` when it has none: ``<a/>``).
    """

    __slots__ = (
        "attributes",
        "children",
        "close_start",
        "content",
        "end",
        "open_end",
        "parent",
        "source",
        "start",
        "tag",
        "texts",
    )

    def __init__(self, tag: str, source: SourceFile, start: int, parent: Element | None) -> None:
        self.tag = tag
        self.source = source
        self.parent = parent
        self.attributes: dict[str, Attribute] = {}
        self.children: list[Element] = []
        self.content: list[Element | Comment] = []
        self.texts: list[Text] = []
        self.start = self.open_end = self.close_start = self.end = start

    @property
    def text(self) -> str:
        """The text without surrounding blanks and comments; "" when there is none."""
        return " ".join(text.value for text in self.texts)

    @property
    def location(self) -> Location:
        """The place of the tag's name in the opening tag."""
        return self.source.location(self.start + 1, self.start + 1 + len(self.tag))

    @property
    def text_location(self) -> Location:
        """The place of the text, or of the tag when there is no text."""
        return self.texts[0].location if self.texts else self.location

    @property
    def path(self) -> str:
        """The tags from the root to this element, such as ``Uintah_specification/MPM/interpolator``."""
        tags = [self.tag, *(ancestor.tag for ancestor in self.ancestors())]
        return "/".join(reversed(tags))

    def ancestors(self) -> Iterator[Element]:
        """Yield the parent, its parent and so on up to the root."""
        element = self.parent
        while element is not None:
            yield element
            element = element.parent

    def get(self, tag: str) -> Element | None:
        """Return the first child with this tag, or None."""
        return next((child for child in self.children if child.tag == tag), None)

    def all(self, tag: str) -> list[Element]:
        """Return all children with this tag."""
        return [child for child in self.children if child.tag == tag]

    def find(self, path: str) -> Element | None:
        """Return the first descendant at a path of tags such as ``Grid/Level/Box``, or None."""
        return next(self.find_all(path), None)

    def find_all(self, path: str) -> Iterator[Element]:
        """Yield every descendant at a path of tags, in document order."""
        found = [self]
        for tag in path.split("/"):
            found = [child for element in found for child in element.children if child.tag == tag]
            if not found:
                return
        yield from found

    def iter(self) -> Iterator[Element]:
        """Yield the element itself and all its descendants in document order."""
        yield self
        for child in self.children:
            yield from child.iter()

    def set_content(self, content: list[Element | Comment]) -> None:
        """Make these the children and comments of this element."""
        self.content = content
        self.children = [node for node in content if isinstance(node, Element)]
        for child in self.children:
            child.parent = self

    def renamed(self, tag: str) -> tuple[Edit, ...]:
        """Return the edits that change the tag, in the opening and in the closing tag."""
        opening = self.source.edit(self.start + 1, self.start + 1 + len(self.tag), tag)
        if self.close_start == self.end:
            return (opening,)
        name = self.close_start + 2
        return opening, self.source.edit(name, name + len(self.tag), tag)

    def replaced(self, xml: str) -> Edit:
        """Return the edit that puts other XML in the place of the whole element."""
        return self.source.edit(self.start, self.end, xml)

    def removed(self) -> Edit:
        """Return the edit that takes the element out, with its lines when nothing else stands on them."""
        text = self.source.text
        first = len(text[: self.start].rstrip(" \t"))
        last = self.end
        while last < len(text) and text[last] in " \t":
            last += 1
        alone = (first == 0 or text[first - 1] in "\r\n") and (last == len(text) or text[last] in "\r\n")
        if not alone:
            return self.source.edit(self.start, self.end, "")
        last += 2 if text.startswith("\r\n", last) else 1
        return self.source.edit(first, min(last, len(text)), "")

    def __repr__(self) -> str:
        return f"<Element {self.path} at {self.location.file}:{self.location.line}>"


def to_xml(root: Element, before: list[Comment], after: list[Comment]) -> str:
    """Write the tree as a document, two blanks of indentation a level, with the comments around the root."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    lines += [f"<!--{comment.value}-->" for comment in before]
    _write(root, "", lines)
    lines += [f"<!--{comment.value}-->" for comment in after]
    return "\n".join(lines) + "\n"


def escape(text: str, quotes: bool = False) -> str:
    """Write the characters that XML reserves as references; `quotes` for attribute values."""
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace("\r", "&#13;")
    if quotes:
        text = text.replace('"', "&quot;").replace("'", "&apos;").replace("\n", "&#10;").replace("\t", "&#9;")
    return text


def _write(element: Element, indent: str, lines: list[str]) -> None:
    attributes = "".join(
        f' {name}="{escape(attribute.value, quotes=True)}"' for name, attribute in element.attributes.items()
    )
    opening = f"{indent}<{element.tag}{attributes}"
    text = escape(element.text)
    if not element.children:
        comments = [f"<!--{node.value}-->" for node in element.content if isinstance(node, Comment)]
        inside = " ".join([*([text] if text else []), *comments])
        lines.append(f"{opening}>{inside}</{element.tag}>" if inside else f"{opening}/>")
        return
    lines.append(f"{opening}>")
    inner = indent + "  "
    if text:
        lines.append(inner + text)
    previous: Element | Comment | None = None
    for node in element.content:
        if isinstance(node, Element):
            _write(node, inner, lines)
        elif node.same_line and previous is not None:
            lines[-1] += f" <!--{node.value}-->"
        else:
            lines.append(f"{inner}<!--{node.value}-->")
        previous = node
    lines.append(f"{indent}</{element.tag}>")
