"""Comments in a deck that keep findings quiet.

``<!-- ups: ignore UPS304 -->`` at the end of a line holds for that line, on a line of its own for the
next one; ``<!-- ups: ignore-file UPS304, UPS4 -->`` holds for the file. Codes may be prefixes. One that
keeps nothing quiet is reported, so that they do not pile up.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ups.diagnostics import Diagnostic, Edit, Fix, Location, Severity, register_code
from ups.source import SourceFile

UNUSED = register_code("UPS014", "suppression that suppresses nothing")

_COMMENT = re.compile(r"<!--\s*ups:\s*(ignore(?:-file)?)\s+([\w,\s]*?)\s*-->")


@dataclass
class Suppression:
    """One comment: where it stands, the line it holds for (0: the whole file), and the codes."""

    location: Location
    line: int
    codes: tuple[str, ...]
    removal: Fix
    used: bool = False

    def covers(self, diagnostic: Diagnostic) -> bool:
        """Whether a finding is one that the comment keeps quiet."""
        at = diagnostic.location
        return (
            at is not None
            and at.file == self.location.file
            and self.line in (0, at.line)
            and diagnostic.code.startswith(self.codes)
        )


def suppressions(file: str, text: str) -> list[Suppression]:
    """The comments of a file."""
    if "ups:" not in text:
        return []
    found = []
    source = SourceFile(file, text)
    for match in _COMMENT.finditer(text):
        at = source.location(match.start(), match.end())
        start, line = match.start() - at.column + 1, at.line
        alone = not text[start : match.start()].strip()
        codes = tuple(code for code in re.split(r"[,\s]+", match.group(2)) if code)
        whole_file = match.group(1) == "ignore-file"
        removal = Fix((_removal(file, text, match, start, alone),))
        found.append(Suppression(at, 0 if whole_file else line + alone, codes, removal))
    return [s for s in found if s.codes]


def _removal(file: str, text: str, comment: re.Match[str], line_start: int, alone: bool) -> Edit:
    """The edit that takes a comment out, with its line when nothing else stands on it, or the blanks before it."""
    rest = re.compile(r"[ \t]*(\r\n|\r|\n)").match(text, comment.end())
    if alone and rest is not None:
        return Edit(file, line_start, rest.end(), "")
    return Edit(file, len(text[: comment.start()].rstrip(" \t")), comment.end(), "")


def without_suppressed(diagnostics: Iterable[Diagnostic], sources: Mapping[str, str]) -> list[Diagnostic]:
    """The findings that no comment keeps quiet, and a warning for each comment that keeps none quiet."""
    comments = [s for file, text in sources.items() for s in suppressions(file, text)]
    if not comments:
        return list(diagnostics)
    by_line: dict[tuple[str, int], list[Suppression]] = {}
    for comment in comments:
        by_line.setdefault((comment.location.file, comment.line), []).append(comment)
    kept = []
    for diagnostic in diagnostics:
        at = diagnostic.location
        near = (
            [*by_line.get((at.file, at.line), ()), *by_line.get((at.file, 0), ())] if at is not None else []
        )
        covering = [comment for comment in near if comment.covers(diagnostic)]
        for comment in covering:
            comment.used = True
        if not covering:
            kept.append(diagnostic)
    return kept + [_unused(comment) for comment in comments if not comment.used]


def _unused(comment: Suppression) -> Diagnostic:
    message = f"nothing to suppress here: {', '.join(comment.codes)}"
    return Diagnostic(
        UNUSED, Severity.WARNING, message, comment.location, "remove the comment", comment.removal
    )
