"""``ups explain``: a name of the deck language."""

from __future__ import annotations

import click

from ups.terminal.ending import leave_with, orderly


@click.command()
@click.argument("name")
def explain(name: str) -> None:
    """Explain NAME: a tag, a model, a saved label, or a code such as UPS302."""
    with orderly():
        from ups.explain import explain_command

        leave_with(explain_command(name))
