"""``ups expand``: a deck with its includes in place."""

from __future__ import annotations

import click

from ups.terminal.ending import leave_with, orderly


@click.command()
@click.argument("deck", type=click.Path())
def expand(deck: str) -> None:
    """Print DECK with its includes in place."""
    with orderly():
        from ups.deck_diff import expand_command

        leave_with(expand_command(deck))
