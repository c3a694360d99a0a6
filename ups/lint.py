"""Checking decks without running them: every problem of every deck, with repairs.

>>> result = lint_files([Path("inputs")])        # doctest: +SKIP
>>> result.diagnostics.has_errors                # doctest: +SKIP
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ups.deck import Deck, read_deck
from ups.diagnostics import Diagnostic, Diagnostics, Severity
from ups.element import Element
from ups.suppression import without_suppressed

DECK_SUFFIX = ".ups"
WORTH_SHARING = 16
"""From how many decks on the work is shared between processors unless the caller says how many."""

MAX_ROUNDS = 10
"""How often fixes are done in a row; each may uncover others."""


@dataclass
class LintResult:
    """What was found in some decks.

    Attributes
    ----------
    diagnostics : the findings of all decks; one in a shared include file is kept once.
    sources : the text of every file that was read, by the name that locations give.
    decks : how many decks were read.
    """

    diagnostics: Diagnostics = field(default_factory=Diagnostics)
    sources: dict[str, str] = field(default_factory=dict)
    decks: int = 0


def lint_deck(
    path: str | os.PathLike[str], text: str | None = None, *, unsaved: Mapping[str, str] | None = None
) -> Deck:
    """Read a deck and add to its diagnostics everything that the rules find.

    ``text`` is taken instead of the file's content where it is given; ``unsaved`` does the same for any file of
    the deck, by its real path.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of numbers that no body has; findings say it better
        deck = read_deck(path, text=text, unsaved=unsaved)
        _apply_rules(deck)
    return deck


def _apply_rules(deck: Deck) -> None:
    if deck.document.root is None:
        return
    from ups.rules.rule import DeckView, all_rules

    view = DeckView(deck, component_of(deck.document.root))
    for rule in all_rules():
        deck.diagnostics.extend(rule.check(view))


def component_of(root: Element) -> str:
    """The name of the method that a deck is for, in lower case; empty where it says none."""
    section = root.get("SimulationComponent")
    if section is None:
        return ""
    attribute = section.attributes.get("type")
    return (attribute.value if attribute is not None else section.text).strip().lower()


def find_decks(paths: Iterable[str | os.PathLike[str]]) -> Iterator[Path]:
    """The decks that paths name: files as they are, folders with all ``.ups`` files below them, sorted."""
    for path in map(Path, paths):
        if path.is_dir():
            yield from sorted(p for p in path.rglob(f"*{DECK_SUFFIX}") if p.is_file())
        else:
            yield path


def lint_files(
    paths: Iterable[str | os.PathLike[str]],
    *,
    select: Iterable[str] = (),
    ignore: Iterable[str] = (),
    jobs: int | None = 1,
) -> LintResult:
    """Check decks, and all decks of folders.

    Parameters
    ----------
    paths : files and folders.
    select : prefixes of codes; where there are any, only findings with one of them are kept.
    ignore : prefixes of codes whose findings are left out.
    jobs : how many processes share the decks; None: as many as there are processors, where that pays.
    """
    decks = list(find_decks(paths))
    result = LintResult(decks=len(decks))
    if not decks:
        message = f"there is nothing to check: no file in these folders ends in {DECK_SUFFIX}"
        result.diagnostics.warning("UPS001", message, None)
    for found, sources in _lint_all(decks, jobs):
        _add(result, found, sources, tuple(select), tuple(ignore))
    return result


def lint_text(
    text: str, name: str = "<stdin>", *, select: Iterable[str] = (), ignore: Iterable[str] = ()
) -> LintResult:
    """Check a deck that is given as text; its includes are looked for beside ``name``."""
    result = LintResult(decks=1)
    _add(result, *_findings(lint_deck(name, text)), tuple(select), tuple(ignore))
    return result


def _add(
    result: LintResult,
    found: list[Diagnostic],
    sources: dict[str, str],
    select: tuple[str, ...],
    ignore: tuple[str, ...],
) -> None:
    result.diagnostics.extend(d for d in found if is_chosen(d, select, ignore))
    result.sources.update(sources)


def _lint_all(decks: list[Path], jobs: int | None) -> Iterator[tuple[list[Diagnostic], dict[str, str]]]:
    """The findings and texts of each deck, in order."""
    if jobs is None:
        jobs = (os.cpu_count() or 1) if len(decks) >= WORTH_SHARING else 1
    if jobs <= 1 or len(decks) <= 1:
        yield from map(_lint_one, decks)
        return
    from concurrent.futures import ProcessPoolExecutor

    from ups.rules.old_forms.old_form import all_old_forms
    from ups.rules.rule import all_rules

    all_rules()
    all_old_forms()  # the codes of both are to be known here too, where the findings arrive
    with ProcessPoolExecutor(min(jobs, len(decks))) as pool:
        yield from pool.map(_lint_one, decks, chunksize=4)


def _lint_one(path: Path) -> tuple[list[Diagnostic], dict[str, str]]:
    return _findings(lint_deck(path))


def _findings(deck: Deck) -> tuple[list[Diagnostic], dict[str, str]]:
    sources = deck.sources
    return without_suppressed(deck.diagnostics, sources), sources


def is_chosen(diagnostic: Diagnostic, select: tuple[str, ...], ignore: tuple[str, ...]) -> bool:
    """Whether a finding is wanted, by prefixes of its code."""
    code = diagnostic.code
    return (not select or code.startswith(select)) and not (ignore and code.startswith(ignore))


def fix_files(
    paths: Iterable[str | os.PathLike[str]],
    *,
    unsafe: bool = False,
    select: Iterable[str] = (),
    ignore: Iterable[str] = (),
    jobs: int | None = 1,
) -> tuple[LintResult, int]:
    """Do the fixes in the files until none is left; return what remains, and how many were done.

    Raises
    ------
    OSError : a file cannot be written.
    """
    from ups.fixes import repaired, write

    paths, select, ignore = list(paths), tuple(select), tuple(ignore)
    done = 0
    for _ in range(MAX_ROUNDS):
        result = lint_files(paths, select=select, ignore=ignore, jobs=jobs)
        texts, count = repaired(result.diagnostics, result.sources, unsafe=unsafe)
        if not count:
            break
        write(texts)
        done += count
    return lint_files(paths, select=select, ignore=ignore, jobs=jobs), done


def report(result: LintResult, form: str = "text", *, colour: bool = False) -> str:
    """What was found, in one of the forms text, json, sarif and github."""
    from ups.diagnostics_format import RENDERERS, render_text

    if form != "text":
        return RENDERERS[form](result.diagnostics, result.sources)
    text = render_text(result.diagnostics, result.sources, colour=colour)
    counts = [(severity, result.diagnostics.count(severity)) for severity in Severity]
    summary = ", ".join(f"{n} {severity.value}{'s' * (n != 1)}" for severity, n in counts)
    return f"{text}\n{summary}" if text else summary


@dataclass(frozen=True)
class LintOptions:
    """The options of ``ups lint``."""

    form: str = "text"
    select: tuple[str, ...] = ()
    ignore: tuple[str, ...] = ()
    jobs: int | None = 1
    fix: bool = False
    unsafe: bool = False
    diff: bool = False
    colour: bool = False


def lint_command(
    paths: Iterable[str | os.PathLike[str]], options: LintOptions, text: str | None = None
) -> tuple[str, int]:
    """What ``ups lint`` prints, and its exit status; ``text`` is a deck from standard input."""
    chosen = {"select": options.select, "ignore": options.ignore}
    if text is not None:
        name = next(iter(paths), "<stdin>")
        result = lint_text(text, os.fspath(name), **chosen)
    elif options.fix and not options.diff:
        try:
            result, _ = fix_files(paths, unsafe=options.unsafe, jobs=options.jobs, **chosen)
        except OSError as problem:
            return f"error: {problem}", 1
    else:
        result = lint_files(paths, jobs=options.jobs, **chosen)
    if options.diff:
        from ups.fixes import difference, repaired

        texts, _ = repaired(result.diagnostics, result.sources, unsafe=options.unsafe)
        return difference(result.sources, texts).rstrip("\n"), exit_status(result)
    return report(result, options.form, colour=options.colour), exit_status(result)


def exit_status(result: LintResult) -> int:
    """1 where there is an error, else 0."""
    return int(result.diagnostics.has_errors)
