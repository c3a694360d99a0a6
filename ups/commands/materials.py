"""``ups materials``: the materials that come with the program."""

from __future__ import annotations

import click

from ups.terminal.ending import orderly


@click.command()
@click.argument("name", default="")
def materials(name: str) -> None:
    """List the materials that come with the program, or the files and constants of the material NAME."""
    with orderly():
        from ups.materials import print_catalogue

        print_catalogue(name)
