"""``ups info``: what an archive holds."""

from __future__ import annotations

import click

from ups.terminal.ending import orderly


@click.command()
@click.argument("archive", type=click.Path())
@click.option("--step", type=int, default=-1, metavar="STEP", help="Ranges at this step; -1 is the last.")
@click.option("--json", "as_json", is_flag=True, help="Everything, with each component's range, as JSON.")
def info(archive: str, step: int, as_json: bool) -> None:
    """Show what ARCHIVE holds: steps, grid, variables and their ranges, histories, size, health."""
    with orderly():
        from ups.inspect.info import render, summarize

        summary = summarize(archive, step)
        if as_json:
            import json

            click.echo(json.dumps(summary.as_dict(), indent=2))
        else:
            click.echo(render(summary))
