"""How a command ends: its answer, errors of decks and archives, interrupts, and the exit status of each."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from solver.domains.communicator import Communicator
    from ups.archive import ArchiveError
    from ups.diagnostics import DeckError, Diagnostic

FAULT, INTERRUPTED = 1, 130
"""Exit statuses: the deck or the data is at fault; Ctrl-C."""


@contextmanager
def orderly(verbose: bool = False, ranks: Communicator | None = None) -> Iterator[None]:
    """Print diagnostics instead of tracebacks, and leave with the exit status that fits.

    Of several ranks one speaks; where only some failed, the others are ended.
    """
    if ranks is None or ranks.size == 1:
        with _alone_orderly(verbose):
            yield
        return
    try:
        yield
    except BaseException as problem:
        if isinstance(problem, SystemExit):
            raise
        alike = ranks.all_failed()
        if alike and ranks.rank:
            sys.exit(FAULT)
        try:
            with _alone_orderly(verbose):
                raise
        finally:
            if not alike:
                ranks.abort()


@contextmanager
def _alone_orderly(verbose: bool) -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt:
        click.echo("interrupted", err=True)
        sys.exit(INTERRUPTED)
    except BrokenPipeError:
        sys.stderr.close()  # whoever read our output has gone; nothing is left to say
        sys.exit(FAULT)
    except Exception as problem:
        _print_known(problem)
        if verbose:
            import traceback  # here, as nearly no command ever needs it

            traceback.print_exc()
        click.echo(
            f"internal error: {type(problem).__name__}: {problem}; please report it with the deck"
            + ("" if verbose else " (run again with -v for details)"),
            err=True,
        )
        sys.exit(FAULT)


def _print_known(problem: Exception) -> None:
    """Print what is wrong with a deck or an archive, and leave; any other exception is not ours to explain."""
    from ups.archive.errors import ArchiveError  # here, as commands that read no archive load none of it
    from ups.diagnostics import DeckError

    if isinstance(problem, ArchiveError):
        problem = _from_archive(problem)
    if isinstance(problem, DeckError):
        _print_error(problem)
        sys.exit(FAULT)


def _from_archive(problem: ArchiveError) -> DeckError:
    from ups.diagnostics import DeckError, Diagnostics

    diagnostics = Diagnostics()
    diagnostics.error("UPS603", f"{problem.path}: {problem.message}", None, problem.advice or None)
    return DeckError(diagnostics)


def _print_error(problem: DeckError) -> None:
    """Errors, on the standard error; warnings and notes were shown before or do not matter now."""
    from ups.diagnostics import Severity

    errors = [d for d in problem.diagnostics if d.severity is Severity.ERROR]
    print_diagnostics(errors, problem.sources)
    click.echo(f"{len(errors)} error{'s' * (len(errors) != 1)}", err=True)


def print_diagnostics(diagnostics: Iterable[Diagnostic], sources: Mapping[str, str]) -> None:
    """Print diagnostics with the lines that they are about, on the standard error."""
    from ups.diagnostics_format import render_text

    text = render_text(diagnostics, sources, colour=sys.stderr.isatty())
    if text:
        click.echo(text, err=True)


def leave_with(answer: tuple[str, int]) -> None:
    """Print the text of an answer and leave with its exit status."""
    text, status = answer
    click.echo(text)
    sys.exit(status)
