"""``ups lint``: decks are checked, and repaired."""

from __future__ import annotations

import sys
from typing import Any

import click

from ups.terminal.ending import leave_with, orderly


@click.command()
@click.argument("decks", nargs=-1, type=click.Path())
@click.option("--format", "form", type=click.Choice(["text", "json", "github", "sarif"]), default="text")
@click.option("--select", multiple=True, metavar="CODE", help="Only findings whose code begins so.")
@click.option("--ignore", multiple=True, metavar="CODE", help="No findings whose code begins so.")
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=None,
    help="How many processes share the decks; by default all.",
)
@click.option("--fix", is_flag=True, help="Do the safe repairs in the files that hold the cause.")
@click.option("--unsafe", is_flag=True, help="With --fix or --diff: the other repairs, too.")
@click.option("--diff", is_flag=True, help="Show the repairs, and do none.")
@click.option("--stdin", "from_input", is_flag=True, help="Check the deck on the standard input.")
def lint(decks: tuple[str, ...], from_input: bool, **options: Any) -> None:
    """Check DECKS, files or folders, and report every problem, without running anything.

    Exit status 1 where there is an error; warnings and notes do not count.
    """
    if bool(decks) == from_input and not (from_input and len(decks) == 1):
        raise click.UsageError("give DECKS to check, or --stdin with at most one name for the deck")
    if options["unsafe"] and not (options["fix"] or options["diff"]):
        raise click.UsageError("--unsafe belongs to --fix or --diff")
    with orderly():
        from ups.lint import LintOptions, lint_command

        text = sys.stdin.read() if from_input else None
        leave_with(lint_command(decks, LintOptions(colour=sys.stdout.isatty(), **options), text))
