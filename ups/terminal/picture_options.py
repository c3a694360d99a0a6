"""Options of the commands that show an archive: what a picture shows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click


def _plane(context: click.Context, option: click.Parameter, given: str | None) -> Any:
    if given is None:
        return None
    from ups.pictures.view import Slice

    try:
        return Slice.parse(given)
    except ValueError as problem:
        raise click.BadParameter(str(problem)) from None


def _step(context: click.Context, option: click.Parameter, given: str) -> int:
    if given == "last":
        return -1
    try:
        return int(given)
    except ValueError:
        raise click.BadParameter(f"{given!r} is neither the number of a step nor 'last'") from None


def _rising(
    context: click.Context, option: click.Parameter, given: tuple[float, float] | None
) -> tuple[float, float] | None:
    if given is not None and not given[0] < given[1]:
        raise click.BadParameter(f"{given[0]:g} is not below {given[1]:g}")
    return given


def picture_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options that say what a picture shows."""
    for option in reversed(
        (
            click.option("--variable", metavar="LABEL", help="What to show; the stress, or what there is."),
            click.option(
                "--step", default="last", callback=_step, metavar="STEP", help="Time step; the last."
            ),
            click.option("--slice", "plane", callback=_plane, metavar="z=0", help="Cut across an axis."),
            click.option(
                "--material", "materials", multiple=True, type=int, metavar="INDEX", help="Only these."
            ),
            click.option("--level", type=int, default=0, metavar="INDEX", help="Of a grid variable; 0."),
            click.option(
                "--range",
                "limits",
                type=float,
                nargs=2,
                metavar="LOW HIGH",
                callback=_rising,
                help="Of the colours.",
            ),
            click.option(
                "--mirror",
                "mirrored",
                multiple=True,
                type=click.Choice(["x", "y", "z"]),
                callback=lambda _context, _option, given: ["xyz".index(letter) for letter in given],
                help="Add the mirror image in the grid's lower face across this axis.",
            ),
        )
    ):
        command = option(command)
    return command
