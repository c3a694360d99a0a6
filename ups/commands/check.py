"""``ups check``: what is damaged in an archive."""

from __future__ import annotations

import sys

import click

from ups.terminal.ending import FAULT, orderly
from ups.terminal.progress_bar import progress_bar


@click.command()
@click.argument("archive", type=click.Path())
@click.option("--repair", is_flag=True, help="Make it readable up to its last whole step.")
@click.option("--quick", is_flag=True, help="Look at tables and sizes of files only, not at every block.")
def check(archive: str, repair: bool, quick: bool) -> None:
    """Look for what is missing, cut off or damaged in ARCHIVE; exit status 1 where anything is."""
    with orderly():
        from ups.inspect.check import check_archive, repair_archive

        for action in repair_archive(archive) if repair else []:
            click.echo(action)
        with progress_bar("time steps") as progress:
            health = check_archive(archive, values=not quick, progress=progress)
        for problem in health.problems:
            click.echo(str(problem))
        click.echo(f"{len(health.whole)} whole time steps, {len(health.damaged)} damaged")
        sys.exit(0 if health.is_sound else FAULT)
