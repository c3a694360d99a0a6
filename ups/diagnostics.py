"""What is wrong with a deck, an archive or a run: one class for every message that a user sees.

A `Diagnostic` says what is wrong (code, severity, message), where (`Location`), and where there is one,
the repair: in words (`suggestion`) and as a text edit (`Fix`). `Diagnostics` collects them, so that all
problems are reported, not only the first. How they are printed is in `ups.diagnostics_format`.

Codes are grouped by their first digit: 0 files, XML and includes; 1 tags and attributes; 2 values;
3 old dialects; 4 consistency; 5 physics; 6 run time. `CODES` lists them with a one-line title.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache
from typing import Protocol

CODES: dict[str, str] = {
    # files, XML, includes
    "UPS001": "file cannot be read",
    "UPS002": "not well-formed XML",
    "UPS003": "opening and closing tags do not match",
    "UPS004": "characters do not fit the declared encoding",
    "UPS005": "character that XML does not allow",
    "UPS006": "entity declarations are not read",
    "UPS007": "file too large or nested too deeply",
    "UPS008": "wrong root element",
    "UPS010": "include without href",
    "UPS011": "include file not found",
    "UPS012": "file includes itself",
    "UPS013": "section not found in include file",
    # tags and attributes
    "UPS101": "required tag missing",
    "UPS102": "unknown tag",
    "UPS103": "tag in the wrong place",
    "UPS104": "tag given more than once",
    "UPS105": "tag does not belong to the chosen type",
    "UPS106": "one of several tags must be given",
    "UPS111": "required attribute missing",
    "UPS112": "unknown attribute",
    # values
    "UPS201": "text where none is allowed",
    "UPS202": "value missing",
    "UPS203": "not a number",
    "UPS204": "not an integer",
    "UPS205": "not true or false",
    "UPS206": "not a vector",
    "UPS207": "wrong number of components",
    "UPS208": "value out of range",
    "UPS209": "not one of the allowed words",
    "UPS210": "value split by a tag or a comment",
    "UPS211": "characters after the value are ignored",
    # old dialects
    "UPS301": "old name of a tag",
    "UPS302": "old form of an element",
    "UPS303": "old name of a value",
    "UPS304": "tag without effect",
    "UPS305": "old name of an include file",
    # consistency
    "UPS401": "lower and upper bounds are reversed or equal",
    "UPS402": "material index out of range",
    "UPS403": "geometry outside the grid",
    "UPS404": "times do not increase",
    "UPS405": "limits contradict each other",
    "UPS406": "variable is not computed by this deck",
    "UPS407": "name used twice",
    "UPS408": "data file not found",
    "UPS409": "extra cells do not fit the interpolator",
    "UPS410": "reference to a name that is not defined",
    "UPS411": "geometry fills no particle",
    "UPS412": "not supported by this program",
    # physics
    "UPS501": "property must be positive",
    "UPS502": "constants contradict each other",
    "UPS503": "value is physically implausible",
    # run time
    "UPS601": "run stopped",
    "UPS602": "particle state is not finite or inverted",
    "UPS603": "archive cannot be read",
    "UPS604": "archive cannot be written",
}


def register_code(code: str, title: str) -> str:
    """Add a code to `CODES`; a rule that lives in its own file declares its code there.

    Returns the code. Raises ValueError when the code is malformed or already stands for something else.
    """
    if len(code) != 6 or not code.startswith("UPS") or not code[3:].isdigit():
        raise ValueError(f"diagnostic code {code!r} is not of the form UPSnnn")
    if CODES.setdefault(code, title) != title:
        raise ValueError(f"diagnostic code {code} already means {CODES[code]!r}")
    return code


class Severity(Enum):
    """How bad it is: an error stops the run, a warning does not, a note only informs."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True)
class Location:
    """A place in a source file: 1-based line and column (in characters), and how many characters to mark."""

    file: str
    line: int
    column: int
    length: int = 1


class Located(Protocol):
    """Anything that knows its place: an element, an attribute or a text of a document."""

    @property
    def location(self) -> Location:
        """Where it stands."""
        ...


@dataclass(frozen=True, slots=True)
class Edit:
    """Replace the characters `start:end` (0-based, of the decoded text) of `file` by `replacement`."""

    file: str
    start: int
    end: int
    replacement: str


@dataclass(frozen=True, slots=True)
class Fix:
    """A repair as text edits, done together or not at all.

    `safe` means that the meaning of the deck stays what its author intended, so that `--fix` may do it.
    """

    edits: tuple[Edit, ...]
    safe: bool = True


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One problem: its code, what it is, where it is, and how to repair it.

    `suggestion` is a phrase shown beside the marked source, such as ``did you mean <density>?``.
    """

    code: str
    severity: Severity
    message: str
    location: Location | None
    suggestion: str | None = None
    fix: Fix | None = None


class Diagnostics:
    """An append-only collection of diagnostics; the same code and message at the same place is kept once."""

    def __init__(self, diagnostics: Iterable[Diagnostic] = ()) -> None:
        self._items: dict[tuple[str, str, Location | None], Diagnostic] = {}
        self.extend(diagnostics)

    def add(self, diagnostic: Diagnostic) -> None:
        """Append a diagnostic. Raises ValueError for a code that is not in `CODES`."""
        if diagnostic.code not in CODES:
            raise ValueError(f"diagnostic code {diagnostic.code!r} is not registered")
        self._items.setdefault((diagnostic.code, diagnostic.message, diagnostic.location), diagnostic)

    def extend(self, diagnostics: Iterable[Diagnostic]) -> None:
        """Append several diagnostics, for instance another collection."""
        for diagnostic in diagnostics:
            self.add(diagnostic)

    def error(
        self,
        code: str,
        message: str,
        at: Location | Located | None,
        suggestion: str | None = None,
        fix: Fix | None = None,
    ) -> None:
        """Append an error at a location, or at anything that has one."""
        self.add(Diagnostic(code, Severity.ERROR, message, _location_of(at), suggestion, fix))

    def warning(
        self,
        code: str,
        message: str,
        at: Location | Located | None,
        suggestion: str | None = None,
        fix: Fix | None = None,
    ) -> None:
        """Append a warning at a location, or at anything that has one."""
        self.add(Diagnostic(code, Severity.WARNING, message, _location_of(at), suggestion, fix))

    def note(
        self,
        code: str,
        message: str,
        at: Location | Located | None,
        suggestion: str | None = None,
        fix: Fix | None = None,
    ) -> None:
        """Append a note at a location, or at anything that has one."""
        self.add(Diagnostic(code, Severity.NOTE, message, _location_of(at), suggestion, fix))

    @property
    def has_errors(self) -> bool:
        """Whether any of the diagnostics is an error."""
        return self.count(Severity.ERROR) > 0

    def count(self, severity: Severity) -> int:
        """How many diagnostics have this severity."""
        return sum(item.severity is severity for item in self._items.values())

    def sorted(self) -> list[Diagnostic]:
        """All diagnostics by file, line and column; those without a place come first."""
        return sorted(self._items.values(), key=_place)

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self.sorted())

    def __len__(self) -> int:
        return len(self._items)

    def __bool__(self) -> bool:
        return bool(self._items)

    def __repr__(self) -> str:
        return f"Diagnostics({self.sorted()!r})"


class DeckError(Exception):
    """Raised when a deck or its data cannot be used; `diagnostics` says why, `sources` holds the texts.

    `sources` maps file names to their texts, for showing the lines that the diagnostics mark.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic], sources: Mapping[str, str] | None = None) -> None:
        self.diagnostics = diagnostics if isinstance(diagnostics, Diagnostics) else Diagnostics(diagnostics)
        self.sources: Mapping[str, str] = sources or {}
        super().__init__(self.diagnostics)

    def __str__(self) -> str:
        from ups.diagnostics_format import render_text

        return render_text(self.diagnostics, self.sources)


def apply_fixes(diagnostics: Iterable[Diagnostic], sources: Mapping[str, str]) -> tuple[dict[str, str], int]:
    """Do the safe fixes of `diagnostics` in the texts `sources` (by file name).

    Fixes are taken in the order given; one that touches characters of an earlier one, or a file that is
    not in `sources`, is left for the next round. Returns the changed texts by file name, and how many
    fixes were done.
    """
    chosen: list[Edit] = []
    done = 0
    for diagnostic in diagnostics:
        fix = diagnostic.fix
        if fix is None or not fix.safe or any(edit.file not in sources for edit in fix.edits):
            continue
        if any(_overlap(edit, other) for edit in fix.edits for other in chosen):
            continue
        chosen.extend(fix.edits)
        done += 1
    texts: dict[str, str] = {}
    for edit in sorted(chosen, key=lambda edit: edit.start, reverse=True):
        text = texts.get(edit.file, sources[edit.file])
        texts[edit.file] = text[: edit.start] + edit.replacement + text[edit.end :]
    return texts, done


def did_you_mean(word: str, candidates: Iterable[str]) -> str | None:
    """Find the candidate that `word` is most likely a misspelling of, or None when none is near.

    Nearness is the Damerau-Levenshtein distance (a letter dropped, added, changed, or two neighbours
    swapped each count one) without regard to case; up to a third of the letters may be wrong, and always
    one. Among equally near ones a slip of the fingers wins (see `_is_slip`), then the same first letter,
    then the earlier.
    """
    lowered = word.lower()
    letters = _letters(lowered)
    best: tuple[int, bool, bool, int] | None = None
    found = None
    for order, candidate in enumerate(candidates):
        other = candidate.lower()
        limit = max(1, max(len(word), len(candidate)) // 3)
        if best is not None:
            limit = min(limit, best[0])
        if candidate == word or abs(len(word) - len(candidate)) > limit:
            continue
        others = _letters(other)
        # one edit takes away at most one letter of the alphabet, and brings at most one
        unlike = max((letters & ~others).bit_count(), (others & ~letters).bit_count())
        if unlike > limit:
            continue
        distance = edit_distance(lowered, other, limit)
        same_start = other[:1] == lowered[:1]
        # words of one or two letters are near to anything; the first letter must speak for them
        if distance > limit or (distance >= min(len(lowered), len(other)) and not same_start):
            continue
        rank = (distance, not _is_slip(lowered, other), candidate[:1] != word[:1], order)
        if best is None or rank < best:
            best, found = rank, candidate
    return found


def is_certain(word: str, meant: str, candidates: Iterable[str]) -> bool:
    """Whether a word can be nothing but one of the candidates.

    It differs in capitals only; or by a slip, one letter that was dropped or doubled or two that were swapped; or,
    if it is long, by two edits; and all other candidates are twice as far. Words of less than four letters say
    too little.
    """
    lowered, right = word.lower(), meant.lower()
    if lowered == right:
        return True
    edits = 1 if _is_slip(lowered, right) else 2
    shortest = 4 if edits == 1 else 8
    if len(word) < shortest or edit_distance(lowered, right, edits) > edits:
        return False
    others = (c.lower() for c in candidates if c != meant)
    return all(edit_distance(lowered, other, 2 * edits - 1) > 2 * edits - 1 for other in others)


def suggestion_for(word: str, candidates: Iterable[str], form: str = "{}") -> str | None:
    """Return ``did you mean ...?`` with the nearest candidate in `form` (such as ``<{}>``), or None."""
    nearest = did_you_mean(word, candidates)
    return None if nearest is None else f"did you mean {form.format(nearest)}?"


def edit_distance(first: str, second: str, limit: int) -> int:
    """Damerau-Levenshtein distance (optimal string alignment) of two words; `limit` + 1 when it is larger."""
    if abs(len(first) - len(second)) > limit:
        return limit + 1
    before: list[int] = []
    row = list(range(len(second) + 1))
    for i, letter in enumerate(first, start=1):
        last, before, row = before, row, [i]
        for j, other in enumerate(second, start=1):
            cost = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (letter != other))
            if i > 1 and j > 1 and letter == second[j - 2] and first[i - 2] == other:
                cost = min(cost, last[j - 2] + 1)
            row.append(cost)
        if min(row) > limit and min(before) > limit:
            return limit + 1
    return min(row[-1], limit + 1)


@lru_cache(maxsize=8192)
def _letters(word: str) -> int:
    """Return the set of characters of a word as bits; characters 64 apart share one."""
    bits = 0
    for letter in word:
        bits |= 1 << (ord(letter) & 63)
    return bits


def _is_slip(word: str, right: str) -> bool:
    """Whether typing `right` gives `word` when one letter is dropped or doubled or two are swapped."""
    differing = (i for i, pair in enumerate(zip(word, right, strict=False)) if pair[0] != pair[1])
    start = next(differing, min(len(word), len(right)))
    if len(word) == len(right):
        return (
            word[start : start + 2] == right[start : start + 2][::-1]
            and word[start + 2 :] == right[start + 2 :]
        )
    if len(word) < len(right):
        return word[start:] == right[start + 1 :]
    return start > 0 and word[start] == word[start - 1] and word[start + 1 :] == right[start:]


def _location_of(at: Location | Located | None) -> Location | None:
    return at if at is None or isinstance(at, Location) else at.location


def _place(diagnostic: Diagnostic) -> tuple[str, int, int, str]:
    at = diagnostic.location
    return (at.file, at.line, at.column, diagnostic.code) if at else ("", 0, 0, diagnostic.code)


def _overlap(edit: Edit, other: Edit) -> bool:
    if edit.file != other.file:
        return False
    return edit.start == other.start or (edit.start < other.end and other.start < edit.end)
