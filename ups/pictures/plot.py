"""A picture of a variable at one time step."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ups.archive import Archive, ArchiveError
from ups.pictures import flat, solid
from ups.pictures.view import Range, Slice, View, range_of

_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff")
_FLAT_SUFFIXES = (*_SUFFIXES, ".pdf", ".svg")


def plot(
    archive_path: str | Path,
    out: str | Path,
    variable: str | None = None,
    *,
    step: int = -1,
    plane: Slice | None = None,
    materials: Sequence[int] | None = None,
    level: int = 0,
    limits: tuple[float, float] | None = None,
    mirrored: Sequence[int] = (),
    width: int | None = None,
) -> Path:
    """Draw a variable at a time step: a profile along one axis, a plane, or a body in space.

    Which it is follows from the grid: axes of a single cell do not count, nor does that across a slice.
    Particles are drawn as the boxes they fill.

    Parameters
    ----------
    archive_path
        The archive.
    out
        The picture; its suffix chooses the format.
    variable
        Label, perhaps with a measure; None for what is usually looked at first.
    step
        Number of the time step, negative ones counted from the last.
    plane
        Slice through a body in space, or None.
    materials
        Materials to show; None for all.
    level
        Level of a grid variable.
    limits
        Ends of the colour bar; None for those of what is shown.
    mirrored
        Axes (0, 1, 2) across whose lower end of the grid the particles are mirrored, for decks that model
        half or a quarter of a body.
    width
        Pixels across; None for about a thousand, fewer for slender shapes.

    Returns
    -------
    Path
        The picture.

    Raises
    ------
    ArchiveError
        Where the archive does not hold what is asked for, or the picture cannot be written.
    """
    out = Path(out)
    archive = Archive(archive_path)
    chosen = archive.timestep(step).step
    view = View.choose(
        archive, variable, step=chosen, materials=materials, level=level, plane=plane, mirrored=mirrored
    )
    known = _SUFFIXES if len(view.axes) == 3 else _FLAT_SUFFIXES
    if out.suffix.lower() not in known:
        message = f"no format of pictures is known by the suffix {out.suffix!r}"
        raise ArchiveError(out, message, advice=f"give a name ending in {', '.join(known)}")
    shown = range_of(view, [chosen], limits)
    try:
        if len(view.axes) == 3:
            with solid.rendered(view, chosen, shown, width) as plotter:
                solid.save(plotter, out)
        else:
            flat.save(flat.draw(view, chosen, shown, width), out)
    except OSError as error:
        raise ArchiveError.from_os_error(out, "write the picture", error) from error
    return out


def frame_pixels(view: View, step: int, shown: Range, width: int | None = None) -> np.ndarray:
    """Picture of a view at a time step as colours, shape (height, width, 3)."""
    if len(view.axes) == 3:
        with solid.rendered(view, step, shown, width) as plotter:
            return solid.pixels(plotter)
    return flat.pixels(flat.draw(view, step, shown, width))
