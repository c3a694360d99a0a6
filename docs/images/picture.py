"""Draw the last state of a converted archive as a PNG, without a window.

ups convert thickCylinder.uda thickCylinder.pvd
python docs/images/picture.py thickCylinder.pvd plasticStrain docs/images/thickCylinder.png
"""

from __future__ import annotations

import argparse

import pyvista as pv


def main() -> None:
    """Read the command line and draw."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("series", help="what `ups convert` wrote: name.pvd")
    arguments.add_argument("variable", help="what to color by, as ParaView lists it")
    arguments.add_argument("picture", help="the PNG to write")
    arguments.add_argument(
        "--mirror", action="store_true", help="add the mirror image in x (bodies of revolution)"
    )
    given = arguments.parse_args()

    reader = pv.get_reader(given.series)
    reader.set_active_time_value(reader.time_values[-1])
    particles = reader.read().combine()
    if given.mirror:
        particles = particles.merge(particles.reflect((1.0, 0.0, 0.0)), merge_points=False)
    wide, high = particles.bounds[1] - particles.bounds[0], particles.bounds[3] - particles.bounds[2]
    plotter = pv.Plotter(off_screen=True, window_size=(round(560 * wide / max(wide, high)) + 160, 600))
    bar = {"vertical": True, "title": given.variable, "position_x": 0.82, "position_y": 0.2, "height": 0.6}
    plotter.add_mesh(particles, scalars=given.variable, cmap="viridis", point_size=5.0, scalar_bar_args=bar)
    plotter.view_xy()
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = 0.53 * high
    plotter.camera.focal_point = (particles.center[0] + 0.12 * wide, particles.center[1], particles.center[2])
    plotter.camera.position = (*plotter.camera.focal_point[:2], plotter.camera.position[2])
    plotter.screenshot(given.picture)


if __name__ == "__main__":
    main()
