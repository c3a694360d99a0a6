"""``ups plot``: a picture or a movie of an archive."""

from __future__ import annotations

from typing import Any

import click

from ups.terminal.ending import orderly
from ups.terminal.picture_options import picture_options
from ups.terminal.progress_bar import progress_bar


@click.command()
@click.argument("archive", type=click.Path())
@picture_options
@click.option("-o", "--output", type=click.Path(), help="The picture, such as x.png.")
@click.option("--width", type=click.IntRange(100, 10000), metavar="PIXELS", help="Pixels across; about 1000.")
@click.option("--movie", type=click.Path(), help="A movie of all time steps, x.gif or x.mp4.")
@click.option("--fps", type=click.FloatRange(min=0.1), default=10.0, help="Frames of it a second; 10.")
def plot(
    archive: str,
    variable: str | None,
    step: int,
    plane: Any,
    materials: tuple[int, ...],
    level: int,
    limits: tuple[float, float] | None,
    mirrored: list[int],
    output: str | None,
    width: int | None,
    movie: str | None,
    fps: float,
) -> None:
    """Draw a variable of ARCHIVE, such as stress:vonMises, as a picture or a movie; no display is needed."""
    if output is None and movie is None:
        raise click.UsageError("give --output or --movie")
    with orderly():
        from ups.pictures.movie import movie as make_movie
        from ups.pictures.plot import plot as make_picture

        chosen: dict[str, Any] = {
            "plane": plane,
            "materials": materials or None,
            "level": level,
            "limits": limits,
            "mirrored": mirrored,
            "width": width,
        }
        if output is not None:
            click.echo(make_picture(archive, output, variable, step=step, **chosen))
        if movie is not None:
            with progress_bar("frames") as progress:
                click.echo(
                    make_movie(archive, movie, variable, frames_per_second=fps, progress=progress, **chosen)
                )
