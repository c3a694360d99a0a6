"""Views rendered by pyvista: bodies in space for `ups plot`, and any view where one may turn it and look closer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ups.archive.variables import NODE
from ups.convert.glyphs import box_corners
from ups.pictures.view import Range, View, grid_field, particle_frame, plane_corners

_WIDTH, _SHAPE = 1000, 0.8
"""Pixels across, and the height in shares of them."""

_MOST_BOXES = 200_000
"""Particles beyond this many are drawn as points."""

_HEXAHEDRON = 12
"""VTK's number of this cell type."""

_SHORT = 0.35
"""Share of the longest axis below which an axis has room for numbers at its ends only."""

_LOOKS: dict[tuple[int, ...], str] = {(0, 1): "xy", (0, 2): "xz", (1, 2): "yz"}
"""Where the camera of a plane stands, by the axes across and up."""

_MATERIAL_COLOURS = ("tab:blue", "tab:orange", "tab:green", "tab:red", "tab:purple", "tab:brown")


@dataclass(frozen=True)
class Frame:
    """Where in a picture what is shown lies, so that bar and controls have room.

    Attributes
    ----------
    zoom
        Its size, 1 for as large as fits.
    shift
        Where the middle of the picture lies from it, in halves of the picture to the right and up.
    chart
        Left and lower ends, width and height of a chart, in shares of the picture.
    """

    zoom: float = 0.85
    shift: tuple[float, float] = (0.1, 0.0)
    chart: tuple[float, float, float, float] = (0.06, 0.06, 0.88, 0.84)


class Scene:
    """A view in a pyvista plotter; drawn again with another step or variable, it keeps the camera.

    Bodies in space are seen from a corner, planes from the front; along one axis it is a chart.

    Parameters
    ----------
    plotter
        Where it is drawn, beside what others have put there.
    frame
        Where in it.
    """

    def __init__(self, plotter: Any, frame: Frame | None = None) -> None:
        self.plotter = plotter
        self._frame = frame or Frame()
        self._scale = plotter.window_size[0] / _WIDTH
        self._bar = ""
        self._chart: Any = None
        self._seen_from: tuple[object, ...] = ()

    def draw(self, view: View, step: int, shown: Range) -> None:
        """Draw a view at a time step.

        Parameters
        ----------
        view
            What is shown.
        step
            The time step.
        shown
            What the colour bar, or the vertical axis of a chart, and the axes around the picture cover.
        """
        self._clear()
        text = {"font_size": self._points(10), "color": "black", "name": "title", "viewport": True}
        self.plotter.add_text(view.title(step), position=(0.01, 0.955), **text)
        if len(view.axes) == 1:
            self._draw_chart(view, step, shown)
            return
        mesh = _particle_mesh(view, step) if view.named.source.is_particle else _cut_mesh(view, step)
        if mesh.n_points:
            self._add(mesh, view, shown)
        self._draw_axes(view, shown)
        self._aim(view, shown)

    def reset_camera(self) -> None:
        """Look again from where such views are first seen, from the next drawing on."""
        self._seen_from = ()

    def _add(self, mesh: Any, view: View, shown: Range) -> None:
        flat, dots = len(view.axes) == 2, mesh.n_cells == mesh.n_points
        self._bar = view.label.replace(":", "\n") + "\n"
        options: dict[str, Any] = {
            "scalars": "shown",
            "clim": shown.values,
            "cmap": "viridis",
            "ambient": 1.0 if flat else 0.4,
            "diffuse": 0.0 if flat else 0.7,
            "reset_camera": False,
        }
        if dots:
            options |= {
                "point_size": _dot_size(view, shown, self.plotter.window_size[0]),
                "render_points_as_spheres": not flat,
            }
        bar = _BAR | {"title": self._bar, "title_font_size": self._points(18)}
        bar["label_font_size"] = self._points(16)
        self.plotter.add_mesh(mesh, name="shown", scalar_bar_args=bar, **options)
        if flat and not dots:  # closes the seams between boxes
            options |= {"style": "wireframe", "line_width": 1.5, "show_scalar_bar": False}
            self.plotter.add_mesh(mesh, name="outlines", **options)

    def _points(self, size: int) -> int:
        """Size of letters that have this size in a picture of the usual width."""
        return max(6, round(size * self._scale))

    def _clear(self) -> None:
        for name in ("shown", "outlines"):
            self.plotter.remove_actor(name, render=False)
        if self._bar in self.plotter.scalar_bars:
            self.plotter.remove_scalar_bar(self._bar, render=False)
        self.plotter.remove_bounds_axes()
        if self._chart is not None:
            self.plotter.remove_chart(self._chart)
            self._chart = None

    def _draw_axes(self, view: View, shown: Range) -> None:
        lengths = np.subtract(shown.high, shown.low)
        options: dict[str, Any] = {"n_xlabels": 2, "n_ylabels": 2, "n_zlabels": 2}
        for axis, letter in enumerate("xyz"):
            options |= {f"{letter}title": f"{letter} [m]", f"show_{letter}axis": axis in view.axes}
        drawn = self.plotter.show_bounds(
            bounds=_flattened(shown),
            color="dimgray",
            location="outer",
            ticks="outside",
            font_size=self._points(15),
            fmt="%.4g",
            **options,
        )
        for number, length in enumerate(lengths):
            if length > _SHORT * lengths[list(view.axes)].max():
                drawn.SetAxisLabels(number, None)  # VTK's own, round numbers, in place of both ends

    def _aim(self, view: View, shown: Range) -> None:
        """Look at the box around what is shown, from where such views are first seen."""
        seen_from = (view.axes, view.plane)
        if seen_from == self._seen_from:
            return
        self._seen_from = seen_from
        self.plotter.camera.parallel_projection = len(view.axes) == 2
        self.plotter.camera_position = _LOOKS.get(view.axes, "iso")
        self.plotter.reset_camera(bounds=_flattened(shown))
        if len(view.axes) == 2:
            across, up = np.subtract(shown.high, shown.low)[list(view.axes)] / 2.0
            self.plotter.camera.parallel_scale = max(up, across * _SHAPE / 0.9) / 0.85
        self.plotter.camera.zoom(self._frame.zoom)
        self.plotter.camera.SetWindowCenter(*self._frame.shift)

    def _draw_chart(self, view: View, step: int, shown: Range) -> None:
        from ups.pictures.flat import profiles

        (axis,) = view.axes
        chart = self._chart = _pyvista().Chart2D(
            size=self._frame.chart[2:],
            loc=self._frame.chart[:2],
            x_label=f"{'xyz'[axis]} [m]",
            y_label=view.label,
        )
        shown_profiles = profiles(view, step)
        for number, profile in enumerate(shown_profiles):
            colour = _MATERIAL_COLOURS[number % len(_MATERIAL_COLOURS)]
            chart.scatter(profile.places, profile.values, color=colour, size=6, label=profile.name)
            if profile.joined:
                chart.line(profile.places, profile.values, color=colour)
        least, most = shown.values
        margin = 0.05 * (most - least)
        chart.x_range = [shown.low[axis], shown.high[axis]]
        chart.y_range = [least - margin, most + margin]
        for drawn in (chart.x_axis, chart.y_axis):
            drawn.label_size, drawn.tick_label_size = self._points(16), self._points(14)
        chart.legend_visible = any(profile.name for profile in shown_profiles)
        self.plotter.add_chart(chart)


def _flattened(shown: Range) -> list[float]:
    """Ends along each axis, as pyvista takes them."""
    return [end for pair in zip(shown.low, shown.high, strict=True) for end in pair]


_BAR = {
    "color": "black",
    "vertical": True,
    "position_x": 0.84,
    "position_y": 0.15,
    "height": 0.7,
    "width": 0.06,
    "fmt": "%.4g",
}


@contextmanager
def rendered(view: View, step: int, shown: Range, width: int | None = None) -> Iterator[Any]:
    """Render a view without a display, so many pixels across; gives the pyvista plotter to take a picture of."""
    plotter = new_plotter(off_screen=True, width=width or _WIDTH)
    try:
        Scene(plotter).draw(view, step, shown)
        yield plotter
    finally:
        plotter.close()


def new_plotter(*, off_screen: bool, title: str = "", width: int = _WIDTH) -> Any:
    """Return an empty plotter with what all pictures share."""
    size = (width, round(_SHAPE * width))
    plotter = _pyvista().Plotter(off_screen=off_screen, window_size=size, title=title or None)
    plotter.set_background("white")
    plotter.enable_anti_aliasing("msaa")
    return plotter


def pixels(plotter: Any) -> np.ndarray:
    """Colours of a rendered picture, shape (height, width, 3)."""
    return np.asarray(plotter.screenshot(return_img=True))[..., :3]


def save(plotter: Any, path: Path) -> None:
    """Write a rendered picture to a file; raises OSError where the disk refuses."""
    from PIL import Image

    Image.fromarray(pixels(plotter)).save(path)


def _pyvista() -> Any:
    """Return pyvista; that VTK finds no display before it renders without one is no news to anybody."""
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    return pyvista


def _dot_size(view: View, shown: Range, width: int) -> float:
    """Pixels of a dot as wide as a particle, which is half a cell, where everything shown is in the picture."""
    level = view.archive.grid(-1).levels[view.level]
    extent = float(np.linalg.norm(np.subtract(shown.high, shown.low)))
    return max(2.0, 0.6 * max(level.spacing) / extent * _SHAPE * width)


def _particle_mesh(view: View, step: int) -> Any:
    """Particles as the boxes they fill, or their faces in a plane, or as points where they are many."""
    pyvista, frame = _pyvista(), particle_frame(view, step)
    count = len(frame.positions)
    if count > _MOST_BOXES:
        mesh = pyvista.PolyData(frame.positions)
        mesh["shown"] = frame.values
        return mesh
    if len(view.axes) == 2:
        corners = plane_corners(frame, view.axes).reshape(-1, 3)
        faces = np.column_stack([np.full(count, 4), np.arange(4 * count).reshape(count, 4)]).ravel()
        mesh = pyvista.PolyData(corners, faces)
        mesh.cell_data["shown"] = frame.values
        return mesh
    corners = box_corners(frame.positions, frame.edges).reshape(-1, 3)
    cells = np.column_stack([np.full(count, 8), np.arange(8 * count).reshape(count, 8)]).ravel()
    mesh = pyvista.UnstructuredGrid(cells, np.full(count, _HEXAHEDRON, dtype=np.uint8), corners)
    mesh.cell_data["shown"] = frame.values
    return mesh


def _cut_mesh(view: View, step: int) -> Any:
    """A grid variable on the plane of the view, or on three planes through the middle of the grid."""
    found = grid_field(view, step)
    box = found.interior
    values = found.values[box.within(found.origin)]
    on_nodes = found.variable.container == NODE
    image = _pyvista().ImageData(
        dimensions=tuple(n if on_nodes else n + 1 for n in values.shape),
        spacing=found.level.spacing,
        origin=tuple(
            a + i * h for a, i, h in zip(found.level.anchor, box.low, found.level.spacing, strict=True)
        ),
    )
    data = image.point_data if on_nodes else image.cell_data
    data["shown"] = values.ravel(order="F")
    if len(view.axes) == 3:
        return image.slice_orthogonal().combine()
    (across,) = set(range(3)) - set(view.axes)
    place = list(image.center)
    if view.plane is not None:
        place[view.plane.axis] = view.plane.position
    return image.slice(normal="xyz"[across], origin=place)
