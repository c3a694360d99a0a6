"""Pictures along one or two axes, drawn by matplotlib."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ups.archive.variables import NODE
from ups.inspect.extract import interpolate
from ups.pictures.view import Range, View, grid_field, particle_frame, plane_corners

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DPI = 120
_WIDTH, _BESIDE = 8.0, 2.4
"""Inches: of a picture, and of the colour bar and the labels beside what is shown."""

_LETTERS = 11
"""Letters of the title on an inch."""

_MOST_BOXES = 200_000
"""Particles beyond this many are drawn as dots."""


def draw(view: View, step: int, shown: Range, width: int | None = None) -> Figure:
    """Draw a view along one or two axes.

    Parameters
    ----------
    view
        What is shown, along one or two axes.
    step
        The time step.
    shown
        What the colour bar, or along one axis the other one, and the axes cover.
    width
        Pixels across, or None for what suits the shape.
    """
    from matplotlib.figure import Figure

    size = _size(view, shown)
    dpi = _DPI if width is None else width / size[0]
    figure = Figure(figsize=size, dpi=dpi, layout="constrained")
    axes = figure.add_subplot()
    axes.set_title(textwrap.fill(view.title(step), int(_LETTERS * figure.get_figwidth())), fontsize=10)
    if len(view.axes) == 1:
        _draw_profile(view, step, axes, shown)
    else:
        _draw_plane(view, step, figure, axes, shown)
    return figure


def pixels(figure: Figure) -> np.ndarray:
    """Colours of a figure, shape (height, width, 3)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def save(figure: Figure, path: Path) -> None:
    """Write a figure to a file, in the format of its suffix; raises OSError where the disk refuses."""
    figure.savefig(path, dpi=figure.dpi)


def _size(view: View, shown: Range) -> tuple[float, float]:
    """Width and height in inches, of about the shape of what is shown."""
    if len(view.axes) == 1:
        return _WIDTH, 5.0
    across, up = (shown.high[axis] - shown.low[axis] for axis in view.axes)
    height = min(max((_WIDTH - _BESIDE) * up / across, 2.0), 8.0)
    return min(max(height * across / up, 2.5) + _BESIDE, _WIDTH), height + 1.2


@dataclass(frozen=True)
class Profile:
    """Numbers along an axis.

    Attributes
    ----------
    name
        The material, or nothing where there is only one.
    places, values
        Coordinates and numbers, shape (n,).
    joined
        Whether they are those of a grid, between which a line may be drawn.
    """

    name: str
    places: np.ndarray
    values: np.ndarray
    joined: bool


def profiles(view: View, step: int) -> list[Profile]:
    """Numbers that a view along one axis shows, for particles one profile a material."""
    (axis,) = view.axes
    if not view.named.source.is_particle:
        (places,), values = _on_axes(view, step)
        return [Profile("", places, values, joined=True)]
    frame = particle_frame(view, step)
    found = []
    for material in view.materials:
        of_it = frame.materials == material
        name = f"material {material}" if len(view.materials) > 1 else ""
        found.append(Profile(name, frame.positions[of_it, axis], frame.values[of_it], joined=False))
    return found


def _draw_profile(view: View, step: int, axes: Any, shown: Range) -> None:
    (axis,) = view.axes
    for profile in profiles(view, step):
        line = "o-" if profile.joined else "o"
        axes.plot(profile.places, profile.values, line, markersize=3, linewidth=1, label=profile.name)
    if len(axes.lines) > 1:
        axes.legend(fontsize=8)
    least, most = shown.values
    margin = 0.05 * (most - least)
    axes.set(xlim=(shown.low[axis], shown.high[axis]), ylim=(least - margin, most + margin))
    axes.set(xlabel=f"{'xyz'[axis]} [m]", ylabel=view.label)
    axes.ticklabel_format(useMathText=True)
    axes.grid(alpha=0.3)


def _draw_plane(view: View, step: int, figure: Figure, axes: Any, shown: Range) -> None:
    across, up = view.axes
    low, high = shown.low, shown.high
    axes.set(xlim=(low[across], high[across]), ylim=(low[up], high[up]), aspect="equal")
    axes.set(xlabel=f"{'xyz'[across]} [m]", ylabel=f"{'xyz'[up]} [m]")
    draw_it = _particles if view.named.source.is_particle else _grid
    drawn = draw_it(view, step, axes, shown)
    axes.ticklabel_format(useMathText=True)
    bar = figure.colorbar(drawn, ax=axes, label=view.label, fraction=0.06, aspect=25, pad=0.02)
    bar.ax.ticklabel_format(useMathText=True)


def _particles(view: View, step: int, axes: Any, shown: Range) -> Any:
    """Draw particles as the outlines of their boxes in the plane, or as dots where they are many."""
    from matplotlib.collections import PolyCollection

    frame, plane = particle_frame(view, step), list(view.axes)
    order = np.argsort(np.abs(np.nan_to_num(frame.values)), kind="stable")  # the large ones on top
    places, values = frame.positions[order][:, plane], frame.values[order]
    if len(places) > _MOST_BOXES:
        dots = axes.scatter(*places.T, c=values, s=0.5, marker=",", linewidths=0)
        dots.set_clim(*shown.values)
        return dots
    corners = plane_corners(frame, plane)[order][..., plane]
    boxes = PolyCollection(list(corners), array=values, edgecolors="face", linewidths=0.6, antialiased=False)
    boxes.set_clim(*shown.values)
    return axes.add_collection(boxes)


def _grid(view: View, step: int, axes: Any, shown: Range) -> Any:
    """Draw a grid variable: cells as they are, between nodes the interpolated numbers."""
    (x, y), values = _on_axes(view, step)
    ends = [end for line in (x, y) for end in _half_a_step_beyond(line)]
    way = "bilinear" if view.named.source.container == NODE else "nearest"
    options = {"origin": "lower", "aspect": "equal", "interpolation_stage": "data", "clim": shown.values}
    limits = axes.get_xlim(), axes.get_ylim()
    drawn = axes.imshow(values.T, extent=ends, interpolation=way, **options)
    axes.set(xlim=limits[0], ylim=limits[1])
    return drawn


def _half_a_step_beyond(line: np.ndarray) -> tuple[float, float]:
    """Ends of a row of equal pieces around the places of a line."""
    half = (line[-1] - line[0]) / (len(line) - 1) / 2.0 if len(line) > 1 else 0.5
    return float(line[0] - half), float(line[-1] + half)


def _on_axes(view: View, step: int) -> tuple[list[np.ndarray], np.ndarray]:
    """Positions along the axes of a view, and the grid variable there, between the layers of the others."""
    found = grid_field(view, step)
    box = found.interior.within(found.origin)
    low, high = found.level.bounds(found.level.interior)
    lines = [
        found.coordinates[axis][box[axis]]
        if axis in view.axes
        else np.array([_position(view, axis, (low[axis] + high[axis]) / 2.0)])
        for axis in range(3)
    ]
    places = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)
    values = interpolate(found, places.reshape(-1, 3)).reshape(places.shape[:3])
    return [lines[axis] for axis in view.axes], values.squeeze(
        tuple(axis for axis in range(3) if axis not in view.axes)
    )


def _position(view: View, axis: int, middle: float) -> float:
    """Where an axis that the picture does not extend along is cut."""
    return view.plane.position if view.plane is not None and view.plane.axis == axis else middle
