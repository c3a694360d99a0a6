"""``ups view``: an archive in a window or on a web page."""

from __future__ import annotations

from functools import partial
from typing import Any

import click

from ups.terminal.ending import orderly
from ups.terminal.picture_options import picture_options


@click.command()
@click.argument("archive", type=click.Path())
@picture_options
@click.option("--page", is_flag=True, help="A web page even where there is a display for a window.")
@click.option("--port", type=click.IntRange(0, 65535), default=8080, help="Where it is served; 8080.")
@click.option("--fps", type=click.FloatRange(min=0.1), default=5.0, help="Steps a second when it plays; 5.")
def view(archive: str, page: bool, port: int, fps: float, variable: str | None, **options: Any) -> None:
    """Look at ARCHIVE in a window, or on a web page of this machine where there is no display.

    Time steps, variable, material and colours are chosen there. A run may still be writing the archive.
    """
    with orderly():
        from pathlib import Path

        from ups.pictures import page as web
        from ups.pictures import window
        from ups.pictures.viewer import Viewer

        options["materials"] = options["materials"] or None
        make = partial(Viewer, archive, variable=variable, **options)
        if page or not window.has_display():
            web.serve(make, port, frames_per_second=fps, announce=_say_address)
        else:
            window.show(make, title=Path(archive).name, frames_per_second=fps)


def _say_address(address: str) -> None:
    click.echo(f"{address} shows the archive; Ctrl-C ends it")
