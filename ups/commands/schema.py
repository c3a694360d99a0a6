"""``ups schema``: the deck language for editors of XML."""

from __future__ import annotations

import click

from ups.terminal.ending import leave_with, orderly


@click.command()
@click.argument("component", default="")
def schema(component: str) -> None:
    """Write a RELAX NG schema of the deck language, of all of it or of one COMPONENT, for editors."""
    with orderly():
        from ups.schema import schema_command

        leave_with(schema_command(component))
