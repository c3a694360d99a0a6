"""Diagnostics as text, JSON, GitHub annotations and SARIF.

Each format is one function that takes the diagnostics and returns the text to print.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any
from urllib.parse import quote

from ups.diagnostics import CODES, Diagnostic, Edit, Location, Severity

_COLOURS = {Severity.ERROR: "\x1b[1;31m", Severity.WARNING: "\x1b[1;33m", Severity.NOTE: "\x1b[1;36m"}
_FRAME = "\x1b[34m"
_RESET = "\x1b[0m"
_LINE_END = re.compile(r"\r\n|\r|\n")
_UNPRINTABLE = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff]")
_WIDTH = 160  # of the source shown; longer lines are cut around the mark


def render_text(
    diagnostics: Iterable[Diagnostic], sources: Mapping[str, str] | None = None, *, colour: bool = False
) -> str:
    """Render as compilers do, with the marked line of source for the files in `sources` (name to text)."""
    lines_of: dict[str, list[str]] = {}
    blocks = []
    for diagnostic in diagnostics:
        at = diagnostic.location
        source = None
        if at is not None and sources is not None and at.file in sources:
            if at.file not in lines_of:
                lines_of[at.file] = _LINE_END.split(sources[at.file])
            lines = lines_of[at.file]
            source = lines[at.line - 1] if 0 < at.line <= len(lines) else None
        blocks.append(_text_block(diagnostic, source, colour))
    return "\n".join(blocks)


def render_json(diagnostics: Iterable[Diagnostic], sources: Mapping[str, str] | None = None) -> str:
    """Render as JSON: ``{"version": 1, "diagnostics": [...]}``; places that are unknown are null."""
    return json.dumps({"version": 1, "diagnostics": [_json_item(item) for item in diagnostics]}, indent=2)


def render_github(diagnostics: Iterable[Diagnostic], sources: Mapping[str, str] | None = None) -> str:
    """Render as workflow commands that GitHub shows as annotations of the changed lines."""
    return "\n".join(_github_line(item) for item in diagnostics)


def render_sarif(diagnostics: Iterable[Diagnostic], sources: Mapping[str, str] | None = None) -> str:
    """Render as a SARIF 2.1.0 log, as code-scanning services take it.

    Regions of fixes are given as character offsets, which SARIF counts as this program does.
    """
    items = list(diagnostics)
    codes = sorted({item.code for item in items})
    driver = {
        "name": "ups",
        "rules": [_sarif_rule(code) for code in codes],
    }
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "results": [_sarif_result(item, codes.index(item.code)) for item in items],
    }
    schema = "https://json.schemastore.org/sarif-2.1.0.json"
    return json.dumps({"$schema": schema, "version": "2.1.0", "runs": [run]}, indent=2)


Renderer = Callable[[Iterable[Diagnostic], Mapping[str, str]], str]

RENDERERS: dict[str, Renderer] = {
    "text": render_text,
    "json": render_json,
    "github": render_github,
    "sarif": render_sarif,
}


def _text_block(diagnostic: Diagnostic, source: str | None, colour: bool) -> str:
    def paint(text: str, code: str) -> str:
        return f"{code}{text}{_RESET}" if colour else text

    hue = _COLOURS[diagnostic.severity]
    head = (
        paint(f"{diagnostic.severity.value}[{diagnostic.code}]", hue) + f": {_printable(diagnostic.message)}"
    )
    at = diagnostic.location
    suggestion = _printable(diagnostic.suggestion or "")
    if at is None:
        return f"{head}\n  = {suggestion}\n" if suggestion else f"{head}\n"
    number = str(at.line)
    gutter = " " * len(number)
    arrow = f"{gutter}{paint('-->', _FRAME)} {_printable(at.file)}:{at.line}:{at.column}"
    if source is None:
        tail = [f"{gutter} = {suggestion}"] if suggestion else []
        return "\n".join([head, arrow, *tail, ""])
    shown, column = _window(source, at)
    # tabs stay tabs so that the mark stands under what it marks
    indent = re.sub(r"[^\t]", " ", shown[: column - 1]) + " " * (column - 1 - len(shown))
    mark = "^" * max(1, min(at.length, len(shown) - column + 1))
    bar = paint("|", _FRAME)
    return "\n".join(
        [
            head,
            arrow,
            f"{gutter} {bar}",
            f"{paint(number, _FRAME)} {bar} {shown}".rstrip(),
            f"{gutter} {bar} {indent}{paint(f'{mark} {suggestion}'.rstrip(), hue)}",
            "",
        ]
    )


def _window(source: str, at: Location) -> tuple[str, int]:
    """Cut a source line to what is shown; return it and the column of the mark in it."""
    line = _printable(source)
    if len(line) <= _WIDTH:
        return line, at.column
    start = max(0, at.column - 1 - _WIDTH // 2)
    shown = line[start : start + _WIDTH]
    if start + _WIDTH < len(line):
        shown += "..."
    return (f"...{shown}", at.column - start + 3) if start else (shown, at.column)


def _printable(text: str) -> str:
    """Replace control characters, which could rule the terminal, one for one."""
    return _UNPRINTABLE.sub("\ufffd", text)


def _json_item(diagnostic: Diagnostic) -> dict[str, Any]:
    at = diagnostic.location
    item: dict[str, Any] = {
        "code": diagnostic.code,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "file": at.file if at else None,
        "line": at.line if at else None,
        "column": at.column if at else None,
        "length": at.length if at else None,
        "suggestion": diagnostic.suggestion,
        "title": CODES[diagnostic.code],
        "fix": None,
    }
    if diagnostic.fix:
        edits = [
            {"file": edit.file, "start": edit.start, "end": edit.end, "replacement": edit.replacement}
            for edit in diagnostic.fix.edits
        ]
        item["fix"] = {"safe": diagnostic.fix.safe, "edits": edits}
    return item


def _github_line(diagnostic: Diagnostic) -> str:
    def escape(text: str) -> str:
        return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")

    def escape_property(text: str) -> str:
        return escape(text).replace(":", "%3A").replace(",", "%2C")

    command = "notice" if diagnostic.severity is Severity.NOTE else diagnostic.severity.value
    at = diagnostic.location
    properties = [f"title={diagnostic.code}"]
    if at:
        properties = [
            f"file={escape_property(at.file)}",
            f"line={at.line}",
            f"col={at.column}",
            f"endColumn={at.column + at.length}",
            *properties,
        ]
    message = (
        f"{diagnostic.message}; {diagnostic.suggestion}" if diagnostic.suggestion else diagnostic.message
    )
    return f"::{command} {','.join(properties)}::{escape(message)}"


def _sarif_rule(code: str) -> dict[str, Any]:
    """A code with its page, which code-scanning services show beside each result."""
    from ups.explain import explain_code

    page = explain_code(code).partition("\n\n")[2]
    rule: dict[str, Any] = {"id": code, "shortDescription": {"text": CODES[code]}}
    if page:
        rule["help"] = {"text": page, "markdown": page.replace("``", "`")}
    return rule


def _sarif_result(diagnostic: Diagnostic, rule_index: int) -> dict[str, Any]:
    message = (
        f"{diagnostic.message}; {diagnostic.suggestion}" if diagnostic.suggestion else diagnostic.message
    )
    result: dict[str, Any] = {
        "ruleId": diagnostic.code,
        "ruleIndex": rule_index,
        "level": diagnostic.severity.value,
        "message": {"text": message},
    }
    at = diagnostic.location
    if at:
        region = {"startLine": at.line, "startColumn": at.column, "endColumn": at.column + at.length}
        artifact = {"uri": _uri(at.file)}
        result["locations"] = [{"physicalLocation": {"artifactLocation": artifact, "region": region}}]
    if diagnostic.fix:
        changes = [_sarif_change(edit) for edit in diagnostic.fix.edits]
        description = {"text": diagnostic.suggestion or f"repair: {CODES[diagnostic.code]}"}
        result["fixes"] = [{"description": description, "artifactChanges": changes}]
    return result


def _sarif_change(edit: Edit) -> dict[str, Any]:
    region = {"charOffset": edit.start, "charLength": edit.end - edit.start}
    replacement = {"deletedRegion": region, "insertedContent": {"text": edit.replacement}}
    return {"artifactLocation": {"uri": _uri(edit.file)}, "replacements": [replacement]}


def _uri(file: str) -> str:
    return quote(file.replace("\\", "/"))
