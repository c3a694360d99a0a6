"""``ups diff``: two decks by what they mean."""

from __future__ import annotations

import click

from ups.terminal.ending import leave_with, orderly


@click.command()
@click.argument("first", type=click.Path())
@click.argument("second", type=click.Path())
def diff(first: str, second: str) -> None:
    """Compare the decks FIRST and SECOND by what they mean; exit status 1 where they differ."""
    with orderly():
        from ups.deck_diff import diff_command

        leave_with(diff_command(first, second))
