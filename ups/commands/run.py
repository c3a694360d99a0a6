"""``ups run``: a deck is run, or a run goes on."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from functools import partial
from typing import TYPE_CHECKING

import click

from ups.terminal.ending import FAULT, orderly, print_diagnostics

if TYPE_CHECKING:
    from solver.domains.communicator import Communicator
    from ups.deck import Deck
    from ups.result import Result
    from ups.run import Observer


def _overrides(
    context: click.Context, option: click.Parameter, given: tuple[str, ...]
) -> list[tuple[str, str]]:
    pairs = [text.partition("=") for text in given]
    for path, equals, _ in pairs:
        if not equals or not path:
            raise click.BadParameter(f"{path!r} is not of the form PATH=VALUE, such as Time/maxTime=1e-3")
    return [(path.strip("/ "), value) for path, _, value in pairs]


@click.command()
@click.argument("deck", required=False, type=click.Path())
@click.option("--output", type=click.Path(), help="The archive to write; by default <filebase>, numbered.")
@click.option("--restart", type=click.Path(), metavar="ARCHIVE", help="Go on from its checkpoint.")
@click.option("--from", "step", type=click.IntRange(min=0), metavar="STEP", help="That of this step.")
@click.option("--max-steps", type=click.IntRange(min=1), metavar="N", help="Stop after step N.")
@click.option(
    "--set", "overrides", multiple=True, metavar="PATH=VALUE", callback=_overrides, help="Set a tag."
)
@click.option(
    "--ranks-per-file", type=click.IntRange(min=1), default=1, metavar="N", help="With mpirun: fewer files."
)
@click.option("--threads", type=click.IntRange(min=1), metavar="N", help="Use N cores; by default all.")
@click.option(
    "--live",
    is_flag=False,
    flag_value="",
    metavar="[VARIABLE]",
    help="Show a variable at each output: a window, or ARCHIVE.png where there is no display.",
)
@click.option("--profile", is_flag=True, help="Print at the end where the time of the steps went.")
@click.option("-q", "--quiet", is_flag=True, help="Print problems only.")
@click.option("-v", "--verbose", is_flag=True, help="Print notes too, and details of internal errors.")
def run(
    deck: str | None,
    output: str | None,
    restart: str | None,
    step: int | None,
    max_steps: int | None,
    overrides: list[tuple[str, str]],
    ranks_per_file: int,
    threads: int | None,
    live: str | None,
    profile: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Run DECK and write its archive, or go on with the run of an ARCHIVE.

    Without --output a restart continues the archive in place. Several processes share the work with
    mpirun -np N ups run ...
    """
    if deck is None and restart is None and live:
        deck, live = live, ""  # `ups run --live DECK`
    if (deck is None) == (restart is None):
        raise click.UsageError("give either a DECK or --restart ARCHIVE")
    if step is not None and restart is None:
        raise click.UsageError("--from belongs to --restart")
    ranks = _ranks()
    first = ranks.rank == 0  # the one that speaks
    with orderly(verbose, ranks):
        from ups.progress import Interrupts, compilation_notice

        quiet = quiet or not first
        go = _what_runs(deck, restart, step, overrides)
        interrupts = Interrupts()
        with nullcontext() if quiet else compilation_notice():
            result = go(
                output=output,
                max_steps=max_steps,
                threads=threads,
                ranks_a_file=ranks_per_file,
                observers=[interrupts, *_watching(live, profile, quiet, first)],
                checked=_check(live, verbose and first, quiet),
                communicator=ranks,
            )
        if received := max(ranks.allgather(interrupts.received)):
            if first:
                click.echo(f"go on with: ups run --restart {result.directory}", err=True)
            sys.exit(128 + received)


def _ranks() -> Communicator:
    """The ranks that ``mpirun`` started, or this process alone."""
    from solver.domains.mpi import MissingMpiError, world

    try:
        return world()
    except MissingMpiError as problem:
        click.echo(f"error: {problem}", err=True)
        sys.exit(FAULT)


def _what_runs(
    deck: str | None, restart: str | None, step: int | None, overrides: list[tuple[str, str]]
) -> Callable[..., Result]:
    """The call of the library that runs a deck, which has no errors of its own, or goes on from an archive."""
    if restart is not None:
        from ups.session import resume_run

        return partial(resume_run, restart, step=step, overrides=overrides)
    from ups.deck import read_deck

    loaded = read_deck(str(deck), overrides=overrides)
    if loaded.diagnostics.has_errors:
        loaded.require()  # raises, before anything heavy is imported
    from ups.session import run_deck

    return partial(run_deck, loaded)


def _watching(live: str | None, profile: bool, quiet: bool, first: bool) -> Iterator[Observer]:
    """The observers of the run that were asked for, beside that of interrupts."""
    if not quiet:
        from ups.progress import Progress

        yield Progress()
    if live is not None and first:  # which draws what all have written
        from ups.pictures.live import Live
        from ups.pictures.window import has_display

        yield Live(live, window=has_display(), stream=None if quiet else sys.stdout)
    if profile:
        from ups.profile import Profile

        yield Profile(sys.stdout if first else None)


def _check(live: str | None, verbose: bool, quiet: bool) -> Callable[[Deck], None]:
    """A function that looks whether a deck has the variable to show, and prints its warnings, and notes if wanted."""
    from ups.diagnostics import Severity

    shown = {Severity.WARNING, Severity.NOTE} if verbose else set() if quiet else {Severity.WARNING}

    def check(deck: Deck) -> None:
        if live is not None:
            from ups.pictures.live import check_variable

            check_variable(deck, live)
        print_diagnostics([d for d in deck.diagnostics if d.severity in shown], deck.sources)

    return check
