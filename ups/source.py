"""Source files as text: decoding, and where a character stands in its file."""

from __future__ import annotations

import codecs
import os
import re
from bisect import bisect_right
from pathlib import Path

from ups.diagnostics import Diagnostics, Edit, Location

MAX_BYTES = 64 * 1024 * 1024
"""The largest file that is read; the largest decks in use are a thousandth of it."""

_BYTE_ORDER_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_DECLARED = re.compile(rb"""<\?xml[^>]*?\sencoding\s*=\s*["']([A-Za-z0-9._:-]+)["']""")
_LINE_END = re.compile(r"\r\n|\r|\n")


class SourceFile:
    """A file's text with its positions.

    `name` is how messages call it, `text` its decoded characters (line ends as they are, without byte
    order mark), `encoding` and `byte_order_mark` are what `encode` needs to write it back.
    """

    def __init__(self, name: str, text: str, encoding: str = "utf-8", byte_order_mark: bytes = b"") -> None:
        self.name = name
        self.text = text
        self.encoding = encoding
        self.byte_order_mark = byte_order_mark
        self._line_starts: list[int] | None = None

    def location(self, start: int, end: int | None = None) -> Location:
        """Return the place of the characters `start:end` (0-based); the mark ends with the first line."""
        if self._line_starts is None:
            self._line_starts = [0, *(match.end() for match in _LINE_END.finditer(self.text))]
        line = bisect_right(self._line_starts, start)
        first = self._line_starts[line - 1]
        length = 1
        if end is not None and end > start:
            line_end = _LINE_END.search(self.text, start, end)
            length = max(1, (line_end.start() if line_end else end) - start)
        return Location(self.name, line, start - first + 1, length)

    def edit(self, start: int, end: int, replacement: str) -> Edit:
        """Replace the characters `start:end` of this file."""
        return Edit(self.name, start, end, replacement)

    def encode(self, text: str) -> bytes:
        """Encode changed text as this file is; characters that its encoding lacks become references."""
        return self.byte_order_mark + text.encode(self.encoding, errors="xmlcharrefreplace")

    def __repr__(self) -> str:
        return f"SourceFile({self.name!r}, {len(self.text)} characters)"


def load_source(path: str | os.PathLike[str], diagnostics: Diagnostics) -> SourceFile | None:
    """Read and decode an XML file; what is wrong goes to `diagnostics`, None when there is no text at all."""
    name = os.fspath(path)
    at = Location(name, 1, 1)
    try:
        with Path(path).open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        is_archive = (Path(path) / "index.xml").is_file()
        suggestion = f"an archive; to go on with its run: ups run --restart {name}" if is_archive else None
        diagnostics.error("UPS001", f"cannot read {name}: {reason}", at, suggestion)
        return None
    if len(data) > MAX_BYTES:
        diagnostics.error("UPS007", f"{name} is larger than {MAX_BYTES // 1024**2} MiB: not a deck", at)
        return None
    return _decode(name, data, diagnostics)


def _decode(name: str, data: bytes, diagnostics: Diagnostics) -> SourceFile:
    mark, encoding = _encoding_of(data)
    body = data[len(mark) :]
    try:
        return SourceFile(name, body.decode(encoding), encoding, mark)
    except LookupError:
        source = SourceFile(name, body.decode("latin-1"), "latin-1", mark)
        start = source.text.index(encoding)
        diagnostics.error(
            "UPS004",
            f"unknown encoding {encoding!r}",
            source.location(start, start + len(encoding)),
            "use UTF-8 or ISO-8859-1",
        )
    except UnicodeDecodeError as error:
        # Latin-1 has a character for every byte, so that the rest of the file can still be checked
        source = SourceFile(name, body.decode("latin-1"), "latin-1", mark)
        diagnostics.error(
            "UPS004",
            f"byte 0x{body[error.start]:02X} is not {encoding.upper()} text",
            source.location(error.start),
            'save the file as UTF-8, or declare encoding="ISO-8859-1" in its first line',
        )
    return source


def _encoding_of(data: bytes) -> tuple[bytes, str]:
    """Find byte order mark (or none) and encoding: by mark, by zero bytes, by declaration, or UTF-8."""
    for mark, encoding in _BYTE_ORDER_MARKS:
        if data.startswith(mark):
            return mark, encoding
    if data.startswith(b"<\x00"):
        return b"", "utf-16-le"
    if data.startswith(b"\x00<"):
        return b"", "utf-16-be"
    declared = _DECLARED.search(data[:256])
    encoding = declared.group(1).decode("ascii") if declared else "utf-8"
    # eight-bit text that calls itself 16-bit cannot be; its declaration is wrong, not its characters
    return b"", "utf-8" if encoding.lower().startswith(("utf-16", "utf-32", "ucs")) else encoding
