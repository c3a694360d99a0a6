"""``ups extract``: values of an archive over time."""

from __future__ import annotations

import sys

import click

from ups.terminal.ending import orderly


@click.command()
@click.argument("archive", type=click.Path())
@click.argument("variables", nargs=-1, required=True)
@click.option("--point", type=float, nargs=3, metavar="X Y Z", help="At a point.")
@click.option("--line", type=float, nargs=6, metavar="X Y Z X Y Z", help="Along the line between two points.")
@click.option("--particle", type=int, metavar="ID", help="Of the particle of this p.particleID.")
@click.option("--points", type=click.IntRange(min=2), metavar="N", help="Points on the line; one a cell.")
@click.option("--material", type=int, metavar="INDEX", help="Material; 0, or that of the particle.")
@click.option("--level", type=int, metavar="INDEX", help="Level; the finest that holds the place.")
@click.option("--step", "steps", multiple=True, type=int, metavar="STEP", help="Only these; -1 is the last.")
@click.option(
    "--alone", is_flag=True, help="Without the steps of earlier archives that the run went on from."
)
@click.option("-o", "--output", type=click.Path(), help="The .csv to write; by default the terminal.")
def extract(
    archive: str,
    variables: tuple[str, ...],
    point: tuple[float, float, float] | None,
    line: tuple[float, ...] | None,
    particle: int | None,
    points: int | None,
    material: int | None,
    level: int | None,
    steps: tuple[int, ...],
    alone: bool,
    output: str | None,
) -> None:
    """Write values of VARIABLES of ARCHIVE over time as a table: at a point, on a line, of a particle.

    A variable may carry a measure: stress:vonMises, velocity:magnitude, g.stressFS:XY.
    """
    if [point, line, particle].count(None) != 2:
        raise click.UsageError("give one of --point, --line and --particle")
    with orderly():
        from ups.archive import Archive
        from ups.inspect.extract import extract as extract_table

        ends = None if line is None else ((line[0], line[1], line[2]), (line[3], line[4], line[5]))
        table = extract_table(
            Archive(archive) if alone else Archive(archive).with_earlier_runs(),
            variables,
            point=point,
            line=ends,
            particle=particle,
            count=points,
            material=material,
            level=level,
            steps=steps or None,
        )
        if output is None:
            table.write(sys.stdout)
        else:
            table.save(output)
