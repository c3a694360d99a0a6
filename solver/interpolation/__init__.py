"""Shape functions between particles and nodes. Each module is one family of them."""

from __future__ import annotations

from solver.declare import family

INTERPOLATOR = family(
    "interpolator",
    tag="interpolator",
    package="solver.interpolation",
    key="text",
    meaning="shape functions between particles and nodes",
)
