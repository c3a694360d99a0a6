"""``ups plan``: what a run would do."""

from __future__ import annotations

import click

from ups.terminal.ending import leave_with, orderly


@click.command()
@click.argument("deck", type=click.Path())
def plan(deck: str) -> None:
    """Say what a run of DECK would do: materials, particles, steps, memory, archive, time."""
    with orderly():
        from ups.plan import plan_command

        leave_with(plan_command(deck))
