"""``ups history``: sums of an archive over time as a picture."""

from __future__ import annotations

import click

from ups.terminal.ending import orderly


@click.command()
@click.argument("archive", type=click.Path())
@click.argument("histories", nargs=-1)
@click.option("--with", "others", multiple=True, type=click.Path(), metavar="ARCHIVE", help="Its, too.")
@click.option("-o", "--output", type=click.Path(), required=True, help="The picture, such as x.png.")
def history(archive: str, histories: tuple[str, ...], others: tuple[str, ...], output: str) -> None:
    """Draw HISTORIES of ARCHIVE over time, such as KineticEnergy or TotalMomentum:X; without names all."""
    with orderly():
        from ups.pictures.history import plot_histories

        click.echo(plot_histories(archive, histories, output, others=others))
