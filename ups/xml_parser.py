"""XML text into a tree of `Element` with exact positions, and what is wrong with it in plain words.

The parsing is expat's. Document type declarations with content are refused, so that no entity is ever
expanded and no other file is read. After a mistake whose repair is plain (a tag that is not closed or
closed by another name, a bare ``&`` or ``<`` in a text) the reading goes on behind it, so that one run
reports all problems.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from xml.parsers import expat

from ups.diagnostics import Diagnostics, Fix, did_you_mean
from ups.element import Attribute, Comment, Element, Text
from ups.source import SourceFile

MAX_DEPTH = 200
"""How deep elements may be nested; decks need about ten."""

MAX_ELEMENTS = 250_000
"""How many elements a deck may have, its includes included; the largest in use have a tenth of it."""

_CHUNK = 1 << 20  # bytes given to expat at a time, so that it stops soon after the depth limit
_MAX_RECOVERIES = 50
_ATTRIBUTE = re.compile(r"""\s*([^\s=<>/"']+)\s*=\s*("[^"]*"|'[^']*')""")
_TAG_END = re.compile(r"\s*(/?)>")
_TAG_NAME = re.compile(r"""<(\s*)(/?)\s*([^\s<>/="'!?&\d][^\s<>/="'&]*)""")
_BROKEN_ATTRIBUTE = re.compile(r"""\s*([^\s=<>/"']+)\s*(=?)\s*(["']?)([^\s<>"']*)""")
_NAME = re.compile(r"""[^\s<>/="']+""")
_NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")

_REFERENCE_BEGUN = re.compile(r"&#?\w*")
_BARE_LESS = re.compile(r"<(?![A-Za-z_:/!?]|\s*/?\s*[A-Za-z_:][\w:.-]*\s*/?>)")
_ENTITY = re.compile(r"&[A-Za-z_]\w*;")

# expat's error numbers
_NO_ELEMENTS = 3
_INVALID_TOKEN = 4
_UNCLOSED_TOKEN = 5
_TAG_MISMATCH = 7
_DUPLICATE_ATTRIBUTE = 8
_JUNK_AFTER_ROOT = 9
_UNDEFINED_ENTITY = 11
_MISPLACED_DECLARATION = 17


@dataclass
class ParsedFile:
    """What a file holds: the root (None when there is none) and the comments before and after it.

    `complete` is False when reading had to stop early, so that the end of the tree is missing. `elements` is how
    many there are.
    """

    root: Element | None = None
    complete: bool = True
    elements: int = 0
    before: list[Comment] = field(default_factory=list)
    after: list[Comment] = field(default_factory=list)


def parse_xml(
    source: SourceFile, diagnostics: Diagnostics, depth: int = 0, room: int = MAX_ELEMENTS
) -> ParsedFile:
    """Parse a file.

    `depth` is how deep the place is where its content will be inserted, `room` how many elements it may have.
    """
    reader = _TreeReader(source, diagnostics, depth, room)
    reader.read()
    return reader.result


class _StopReadingError(Exception):
    """The rest of the file is not worth or not safe to read; the reason has been reported."""


class _TreeReader:
    """Expat's events made into a tree."""

    def __init__(self, source: SourceFile, diagnostics: Diagnostics, depth: int, room: int) -> None:
        self.source = source
        self.text = source.text  # as expat sees it: without the characters that XML forbids
        self.diagnostics = diagnostics
        self.depth = depth
        self.room = room
        self.result = ParsedFile()
        self.open: list[Element] = []
        self.text_start = -1  # where the current run of text has its first non-blank character
        self.text_parts: list[str] = []
        self.data = b""
        self.ascii = True
        self.parser: expat.XMLParserType
        self.shift = 0  # of a byte in `data` to the parser's count of bytes
        self.cursor_byte = self.cursor_char = 0

    # ------------------------------------------------------------------ reading and going on after mistakes

    def read(self) -> None:
        text = self._without_forbidden_characters()
        if text is None:
            self.result.complete = False
            return
        self.text = text
        self.data = text.encode("utf-8")
        self.ascii = len(self.data) == len(text)
        begin: int | None = 0
        mistakes = 0
        while begin is not None and mistakes <= _MAX_RECOVERIES:
            begin = self._read_from(begin)
            mistakes += 1
        self.result.complete = self.result.complete and begin is None
        self._close_all()

    def _read_from(self, begin: int) -> int | None:
        """Parse from a byte of the data on; return the byte to go on from after a mistake, or None."""
        self._start_parser(begin)
        try:
            for start in range(begin, len(self.data), _CHUNK):
                self.parser.Parse(self.data[start : start + _CHUNK], False)
            self.parser.Parse(b"", True)
        except _StopReadingError:
            self.result.complete = False
        except expat.ExpatError as error:
            return self._recover(error.code, self.parser.ErrorByteIndex - self.shift)
        return None

    def _start_parser(self, begin: int) -> None:
        """Make a parser that stands at byte `begin` inside the elements that are open."""
        self.parser = parser = expat.ParserCreate("utf-8")
        opened = "".join(f"<{element.tag}>" for element in self.open).encode("utf-8")
        if opened:
            parser.Parse(opened, False)
        self.shift = len(opened) - begin
        parser.ordered_attributes = True
        parser.StartElementHandler = self._start_element
        parser.EndElementHandler = self._end_element
        parser.CharacterDataHandler = self._characters
        parser.CommentHandler = self._comment
        parser.ProcessingInstructionHandler = self._processing_instruction
        parser.StartDoctypeDeclHandler = self._doctype

    def _recover(self, code: int, byte: int) -> int | None:
        """Report a syntax error at a byte; return the byte to go on from, or None to stop."""
        here = self._character_at(max(byte, 0))
        text = self.text
        resume: int | None = None
        if code == _TAG_MISMATCH:
            resume = self._mismatch(here - 2)
        elif code == _NO_ELEMENTS and self.open:
            pass  # the elements left open are reported when they are closed
        elif code in (_INVALID_TOKEN, _UNDEFINED_ENTITY) and self.open and (bare := self._bare_at(here)) >= 0:
            self._report_bare(bare)
            if self.text_start < 0:
                self.text_start = bare
            self.text_parts.append(text[bare])
            resume = bare + 1
        elif code == _MISPLACED_DECLARATION and text[:here].isspace():
            self.diagnostics.error(
                "UPS002",
                "the XML declaration <?xml ...?> must be the very first characters of the file",
                self.source.location(here, here + 5),
                "remove what stands before it",
            )
            resume = here
        else:
            self._report_syntax(code, here)
            self.result.complete = code == _JUNK_AFTER_ROOT
        return None if resume is None else self._byte_at(resume)

    def _without_forbidden_characters(self) -> str | None:
        """Blank the characters that XML forbids; return None when the file is no text at all."""
        text = self.text
        found = _NOT_XML.search(text)
        if found is None:
            return text
        at = self.source.location(found.start())
        if "\x00" in text:
            self.diagnostics.error(
                "UPS005", "the file holds NUL bytes: it is damaged, or not a text file", at
            )
            return None
        self.diagnostics.error(
            "UPS005", f"character U+{ord(found.group()):04X} is not allowed in XML", at, "remove it"
        )
        return _NOT_XML.sub(" ", text)

    # ------------------------------------------------------------------------------------- positions

    def _character_at(self, byte: int) -> int:
        """Return the index in the text of a byte of the data."""
        if self.ascii:
            return byte
        if byte < self.cursor_byte:
            self.cursor_byte = self.cursor_char = 0
        self.cursor_char += len(self.data[self.cursor_byte : byte].decode("utf-8", errors="ignore"))
        self.cursor_byte = byte
        return self.cursor_char

    def _byte_at(self, character: int) -> int:
        """Return the byte in the data of an index in the text."""
        return character if self.ascii else len(self.text[:character].encode("utf-8", "replace"))

    def _here(self) -> int:
        return self._character_at(self.parser.CurrentByteIndex - self.shift)

    # ---------------------------------------------------------------------------------- expat's events

    def _start_element(self, tag: str, attributes: list[str]) -> None:
        start = self._here()
        self._end_text(start)
        parent = self.open[-1] if self.open else None
        element = Element(tag, self.source, start, parent)
        position = self._read_attributes(element, attributes)
        end = _TAG_END.match(self.text, position)
        element.open_end = element.close_start = element.end = end.end() if end else position
        if parent is None:
            self.result.root = element
        else:
            parent.children.append(element)
            parent.content.append(element)
        self.open.append(element)
        self.result.elements += 1
        if self.result.elements > self.room:
            self.diagnostics.error("UPS007", f"a deck has at most {MAX_ELEMENTS} elements", element)
            raise _StopReadingError
        if len(self.open) + self.depth > MAX_DEPTH:
            self.diagnostics.error("UPS007", f"elements are nested more than {MAX_DEPTH} deep", element)
            raise _StopReadingError

    def _read_attributes(self, element: Element, attributes: list[str]) -> int:
        """Set the attributes with their places; return where the last one ends."""
        text, source = self.text, self.source
        position = element.start + 1 + len(element.tag)
        for name, value in zip(attributes[::2], attributes[1::2], strict=True):
            found = _ATTRIBUTE.match(text, position)
            if found is None:  # expat has seen it, so that this cannot be
                raise AssertionError(f"attribute {name} of <{element.tag}> has no place in the text")
            position = found.end()
            start, end = found.span(2)
            element.attributes[name] = Attribute(name, value, source, found.start(1), start + 1, end - 1)
        return position

    def _end_element(self, _tag: str) -> None:
        element = self.open[-1]
        text = self.text
        if text.startswith("/>", element.open_end - 2):
            self.open.pop()
            return
        start = self._here()
        self._end_text(start)
        element.close_start = start
        element.end = text.index(">", start) + 1
        self.open.pop()

    def _characters(self, data: str) -> None:
        if self.text_start < 0:
            stripped = data.lstrip()
            if not stripped:
                return
            self.text_start = self._here() + len(data) - len(stripped)
        self.text_parts.append(data)

    def _comment(self, value: str) -> None:
        start = self._here()
        self._end_text(start)
        root = self.result.root
        if not self.open:
            (self.result.before if root is None else self.result.after).append(Comment(value))
            return
        content = self.open[-1].content
        previous = content[-1] if content else None
        same_line = isinstance(previous, Element) and not re.search(
            r"[\r\n]", self.text[previous.end : start]
        )
        content.append(Comment(value, same_line))

    def _processing_instruction(self, _target: str, _data: str) -> None:
        self._end_text(self._here())

    def _doctype(self, _name: str, _system: str | None, _public: str | None, has_content: int) -> None:
        if has_content:
            start = self.text.rfind("<!DOCTYPE", 0, self._here())
            at = self.source.location(start, start + len("<!DOCTYPE"))
            self.diagnostics.error(
                "UPS006",
                "declarations in a DOCTYPE, such as entities, are not read",
                at,
                "remove the DOCTYPE and write the text of each entity in its place",
            )
            raise _StopReadingError

    def _end_text(self, end: int) -> None:
        """Keep the current run of text, which ends before character `end`, if it is not blank."""
        if self.text_start < 0:
            return
        value = "".join(self.text_parts).strip()
        stop = len(self.text[self.text_start : end].rstrip()) + self.text_start
        self.open[-1].texts.append(Text(value, self.source, self.text_start, stop))
        self.text_start = -1
        self.text_parts.clear()

    # --------------------------------------------------------------------------- tags that do not match

    def _mismatch(self, start: int) -> int:
        """Report a closing tag, at `start`, that does not fit what is open; return where to go on."""
        self._end_text(start)
        text = self.text
        found = _NAME.match(text, start + 2)
        name = found.group() if found else ""
        innermost = self.open[-1]
        if any(element.tag == name for element in self.open):
            while self.open[-1].tag != name:
                self._unclosed(self.open[-1], start, f"</{name}> on line {self._line(start)} comes first")
            return start
        after = text.find(">", start) + 1 or len(text)
        at = self.source.location(start + 2, start + 2 + len(name))
        is_leaf = bool(innermost.texts) and not innermost.children
        if is_leaf or did_you_mean(name, [innermost.tag]):
            line = innermost.location.line
            self.diagnostics.error(
                "UPS003",
                f"closing tag </{name}> does not match <{innermost.tag}>, opened on line {line}",
                at,
                f"did you mean </{innermost.tag}>?",
                Fix((self.source.edit(start + 2, start + 2 + len(name), innermost.tag),), safe=False),
            )
            innermost.close_start, innermost.end = start, after
            self.open.pop()
        else:
            self.diagnostics.error(
                "UPS003",
                f"closing tag </{name}> without an opening tag; "
                f"the element open here is <{innermost.tag}>, from line {innermost.location.line}",
                at,
                f"remove it, or add <{name}>",
            )
        return after

    def _unclosed(self, element: Element, start: int, why: str) -> None:
        """Report and close the innermost element, which lacks its closing tag before character `start`."""
        fix = None
        element.close_start = element.end = start
        if element.texts:
            position = element.texts[0].end
            fix = Fix((self.source.edit(position, position, f"</{element.tag}>"),))
            element.close_start = element.end = position
        self._release_followers(element)
        message = f"<{element.tag}> is never closed: {why}"
        self.diagnostics.error("UPS003", message, element, f"add </{element.tag}>", fix)
        self.open.pop()

    def _release_followers(self, element: Element) -> None:
        """Give to the parent of an unclosed element what followed it rather than stood in it.

        A tag with a value holds no tags, so all of it followed; otherwise what is not indented deeper.
        """
        if element.parent is None:
            return
        own = element.location
        first = len(element.content)
        for index, node in enumerate(element.content):
            if isinstance(node, Element):
                place = node.location
                if element.texts or (place.line > own.line and place.column <= own.column):
                    first = index
                    break
        element.parent.set_content([*element.parent.content, *element.content[first:]])
        element.set_content(element.content[:first])

    def _close_all(self) -> None:
        """At the end of the file, report the elements that are still open, innermost first."""
        end = len(self.text)
        if not self.result.complete:
            for element in self.open:
                element.close_start = element.end = end
            return
        self._end_text(end)
        self.result.complete = len(self.open) < 2
        while self.open:
            self._unclosed(self.open[-1], end, "the file ends first")

    # -------------------------------------------------------------------------------- other syntax errors

    def _bare_at(self, here: int) -> int:
        """Find where a ``&`` or ``<`` that stands for itself in a text caused the error at `here`, or -1."""
        text = self.text
        ampersand = text.rfind("&", 0, here + 1)
        if ampersand >= 0 and _REFERENCE_BEGUN.fullmatch(text, ampersand, max(here, ampersand + 1)):
            start = ampersand
        else:
            start = text.rfind("<", 0, here + 1)
            if start < 0 or not _BARE_LESS.match(text, start):
                return -1
        return -1 if _within_tag(text, start) else start

    def _report_bare(self, position: int) -> None:
        character = self.text[position]
        if entity := _ENTITY.match(self.text, position):
            at = self.source.location(position, entity.end())
            message = f"entity {entity.group()} is not defined"
            self.diagnostics.error("UPS002", message, at, "write the character itself")
            return
        reference = {"&": "&amp;", "<": "&lt;"}[character]
        meaning = "begins a reference such as &lt;" if character == "&" else "begins a tag"
        self.diagnostics.error(
            "UPS002",
            f"a bare {character} {meaning}; in a text it must be written {reference}",
            self.source.location(position),
            f"write {reference}",
            Fix((self.source.edit(position, position + 1, reference),)),
        )

    def _report_syntax(self, code: int, here: int) -> None:
        message, start, end, suggestion = _explain(code, self.text, here)
        self.diagnostics.error("UPS002", message, self.source.location(start, end), suggestion)

    def _line(self, position: int) -> int:
        return self.source.location(position).line


_Explanation = tuple[str, int, int, str | None]
"""Message, the characters to mark (from, to), and the repair."""


def _explain(code: int, text: str, here: int) -> _Explanation:
    """Say in plain words what a syntax error is that expat found at a character."""
    if code == _NO_ELEMENTS:
        return "the file holds no XML element", 0, 1, "a deck begins with <Uintah_specification>"
    if code == _JUNK_AFTER_ROOT:
        return "nothing may follow the closing tag of the root element", here, here + 1, "remove it"
    if code == _DUPLICATE_ATTRIBUTE:
        name = _NAME.match(text, here)
        end = name.end() if name else here + 1
        return f"attribute {text[here:end]} is given twice", here, end, "remove one of them"
    if code == _UNDEFINED_ENTITY and (entity := _ENTITY.search(text, here)):
        return (
            f"entity {entity.group()} is not defined",
            entity.start(),
            entity.end(),
            "write the character itself",
        )
    if code == _UNCLOSED_TOKEN:
        what = "comment <!--" if text.startswith("<!--", here) else "tag"
        return f"the {what} that begins here does not end", here, here + 1, None
    start = text.rfind("<", 0, here)
    known = None
    if start >= 0:
        known = _explain_comment(text, start, here) or _explain_tag(text, start, here)
    return known or _explain_character(text, here)


def _explain_comment(text: str, start: int, here: int) -> _Explanation | None:
    """Say what is wrong with the comment that begins at `start`, if one does."""
    if text.startswith("<!--", start) and "-->" not in text[start:here]:
        return "a comment must not hold two hyphens --", here - 2, here, "write - or = instead"
    return None


def _explain_character(text: str, here: int) -> _Explanation:
    """Say what is wrong with the character at `here`, with no tag to blame."""
    if not text[:here].strip():
        return "the file does not begin with a tag: it is not XML", here, here + 1, None
    if text.startswith("]]>", here - 2):
        return "]]> is not allowed in a text", here - 2, here + 1, "write ]]&gt;"
    shown = text[here : here + 1]
    what = f"unexpected {shown!r}" if shown.strip() else "unexpected blank or end of line"
    return f"{what}: this is not well-formed XML", here, here + 1, None


def _explain_tag(text: str, start: int, here: int) -> _Explanation | None:
    """Say what is wrong with the tag that begins at `start`, when it is one of the usual mistakes."""
    if text.startswith("<<", start):
        return "two < in a row", start, start + 2, "remove one"
    found = _TAG_NAME.match(text, start)
    if found is None:
        nameless = text.startswith("</", start)
        return ("a closing tag without a name", start, start + 2, "write </name>") if nameless else None
    blank, slash, tag = found.groups()
    if blank:
        return f"a blank between < and the name of the tag {tag}", start, found.end(), f"write <{slash}{tag}"
    position = found.end()
    while attribute := _ATTRIBUTE.match(text, position):
        position, begin = attribute.end(), attribute.start(2)
        if "<" in attribute.group(2) and begin <= here:
            message = f"the value of attribute {attribute.group(1)} has no closing quote, or holds a bare <"
            return message, begin, begin + 1, "close the quote, or write &lt;"
        ampersand = text.rfind("&", begin, here + 1)
        if here < position and ampersand >= 0:
            message = f"a bare & in the value of attribute {attribute.group(1)}"
            return message, ampersand, ampersand + 1, "write &amp;"
    return _explain_attribute(text, start, position, f"{slash}{tag}")


def _explain_attribute(text: str, start: int, position: int, tag: str) -> _Explanation | None:
    """Say what is wrong in a tag behind its well-formed attributes, which end at `position`."""
    rest = _BROKEN_ATTRIBUTE.match(text, position)
    if rest is None:
        if _TAG_END.match(text, position):
            if tag.startswith("/"):
                return f"closing tag <{tag}> without an opening tag", start + 2, position, "remove it"
            return None
        return f"the tag <{tag}> does not end with >", start + 1, position, "add >"
    name, equals, quote, value = rest.groups()
    if not equals:
        return f"attribute {name} has no value", rest.start(1), rest.end(1), f'write {name}="..."'
    if quote:
        return (
            f"the value of attribute {name} has no closing quote",
            rest.start(3),
            rest.end(4),
            f"add {quote}",
        )
    shown = value.removesuffix("/").strip("\u201c\u201d\u2018\u2019")
    message = f"the value of attribute {name} must stand in straight quotes"
    return message, rest.start(4), max(rest.end(4), rest.start(4) + 1), f'write {name}="{shown}"'


def _within_tag(text: str, position: int) -> bool:
    """Whether a character stands inside a tag or a comment, judged by the last tag that begins before it."""
    start = text.rfind("<", 0, position)
    while start >= 0 and _BARE_LESS.match(text, start):
        start = text.rfind("<", 0, start)
    return start < 0 or ">" not in text[start:position]
