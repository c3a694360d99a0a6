"""Shapes of bodies. Each module is one shape, declared as the deck writes it."""

from __future__ import annotations

from solver.declare import family

GEOMETRY = family(
    "geometry", tag="", package="solver.geometry", key="tag", meaning="shape of a body or of a loaded surface"
)
