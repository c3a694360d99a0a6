"""``ups convert``: an archive in another format."""

from __future__ import annotations

from typing import Any

import click

from ups.terminal.ending import orderly
from ups.terminal.progress_bar import progress_bar


def _region(context: click.Context, option: click.Parameter, given: tuple[float, ...] | None) -> Any:
    """The box between two corners, or None."""
    if given is None:
        return None
    from ups.convert.selection import Region

    try:
        return Region((given[0], given[1], given[2]), (given[3], given[4], given[5]))
    except ValueError as problem:
        raise click.BadParameter(str(problem)) from None


@click.command()
@click.argument("archive", type=click.Path())
@click.argument("out", type=click.Path())
@click.option("--variable", "variables", multiple=True, metavar="LABEL", help="Only these variables.")
@click.option("--material", "materials", multiple=True, type=int, metavar="INDEX", help="Only these.")
@click.option("--step", "steps", multiple=True, type=int, metavar="STEP", help="Only these; -1 is the last.")
@click.option("--every", type=click.IntRange(min=1), default=1, metavar="N", help="Only every Nth of them.")
@click.option(
    "--region", type=float, nargs=6, callback=_region, metavar="X Y Z X Y Z", help="Only what is in this box."
)
@click.option(
    "--glyphs", is_flag=True, help="Particles as boxes, deformed as their material is (.pvd, .vtu)."
)
@click.option(
    "--alone", is_flag=True, help="Without the steps of earlier archives that the run went on from."
)
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Threads (VTK XML); one a core.")
def convert(
    archive: str,
    out: str,
    variables: tuple[str, ...],
    materials: tuple[int, ...],
    steps: tuple[int, ...],
    every: int,
    region: Any,
    glyphs: bool,
    alone: bool,
    jobs: int | None,
) -> None:
    """Convert ARCHIVE to OUT, whose suffix chooses the format.

    \b
    name.pvd, folder  series for ParaView: particles, and every level of the grid
    name.vtp .vtu     particles only      name.vti  grid of one level only
    name.vtm          particles and levels as blocks of one data set
    name.vth          levels of the grid as an overlapping hierarchy (AMR)
    name.vtkhdf       all time steps in one file
    name.csv .npz     tables; NumPy arrays
    name.uda          an archive again: fewer steps or variables, several runs in one

    A variable may carry a measure: stress:vonMises, velocity:magnitude, deformationMeasure:strain.
    """  # noqa: D301 - the mark that keeps click from filling the lines below it
    with orderly():
        from ups.convert import convert as convert_archive

        with progress_bar("time steps") as progress:
            files = convert_archive(
                archive,
                out,
                variables=variables or None,
                materials=materials or None,
                steps=steps or None,
                every=every,
                region=region,
                glyphs=glyphs,
                alone=alone,
                jobs=jobs,
                progress=progress,
            )
        for path in files:
            click.echo(path)
