"""Pictures of bodies in space, rendered by pyvista without a display."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ups.archive.variables import NODE
from ups.convert.glyphs import box_corners
from ups.pictures.view import Range, View, grid_field, particle_frame

_SIZE = (1000, 800)
"""Pixels."""

_MOST_BOXES = 100_000
"""Particles beyond this many are drawn as points."""

_HEXAHEDRON = 12
"""VTK's number of this cell type."""


@contextmanager
def rendered(view: View, step: int, shown: Range) -> Iterator[Any]:
    """Render a view in space; gives the pyvista plotter while the picture can be taken.

    Parameters
    ----------
    view
        What is shown.
    step
        The time step.
    shown
        What the colour bar and the box around the picture cover.
    """
    pyvista = _pyvista()
    plotter = pyvista.Plotter(off_screen=True, window_size=_SIZE)
    try:
        plotter.set_background("white")
        bar = {
            "title": f"{view.label}\n",
            "color": "black",
            "vertical": True,
            "position_x": 0.86,
            "position_y": 0.15,
            "height": 0.7,
            "width": 0.06,
            "title_font_size": 18,
            "label_font_size": 16,
            "fmt": "%.4g",
        }
        options = {"scalars": "shown", "clim": shown.values, "cmap": "viridis", "scalar_bar_args": bar}
        if view.named.source.is_particle:
            _add_particles(pyvista, plotter, view, step, options)
        else:
            _add_slices(pyvista, plotter, view, step, options)
        bounds = [end for pair in zip(shown.low, shown.high, strict=True) for end in pair]
        plotter.add_mesh(pyvista.Box(bounds), style="wireframe", color="grey", line_width=1)
        plotter.show_bounds(
            bounds=bounds,
            color="black",
            font_size=10,
            location="outer",
            ticks="outside",
            xtitle="x [m]",
            ytitle="y [m]",
            ztitle="z [m]",
            n_xlabels=3,
            n_ylabels=3,
            n_zlabels=3,
            fmt="%.3g",
        )
        plotter.add_text(view.title(step), position="upper_left", font_size=10, color="black")
        plotter.camera_position = "iso"
        plotter.camera.zoom(0.85)
        yield plotter
    finally:
        plotter.close()


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


def _add_particles(pyvista: Any, plotter: Any, view: View, step: int, options: dict[str, Any]) -> None:
    frame = particle_frame(view, step)
    count = len(frame.positions)
    if count == 0:
        return
    if count > _MOST_BOXES:
        mesh = pyvista.PolyData(frame.positions)
        mesh["shown"] = frame.values
        plotter.add_mesh(mesh, style="points", point_size=2.0, **options)
        return
    corners = box_corners(frame.positions, frame.edges).reshape(-1, 3)
    cells = np.column_stack([np.full(count, 8), np.arange(8 * count).reshape(count, 8)]).ravel()
    mesh = pyvista.UnstructuredGrid(cells, np.full(count, _HEXAHEDRON, dtype=np.uint8), corners)
    mesh.cell_data["shown"] = frame.values
    plotter.add_mesh(mesh, ambient=0.4, **options)


def _add_slices(pyvista: Any, plotter: Any, view: View, step: int, options: dict[str, Any]) -> None:
    """Three planes through the middle of the grid."""
    found = grid_field(view, step)
    box = found.interior
    values = found.values[box.within(found.origin)]
    on_nodes = found.variable.container == NODE
    image = pyvista.ImageData(
        dimensions=tuple(n if on_nodes else n + 1 for n in values.shape),
        spacing=found.level.spacing,
        origin=tuple(
            a + i * h for a, i, h in zip(found.level.anchor, box.low, found.level.spacing, strict=True)
        ),
    )
    data = image.point_data if on_nodes else image.cell_data
    data["shown"] = values.ravel(order="F")
    plotter.add_mesh(image.slice_orthogonal().combine(), ambient=0.7, diffuse=0.3, **options)
