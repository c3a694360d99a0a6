"""How the initial value of a property is spread over the particles."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from numpy.typing import NDArray

from solver.declare import family

DISTRIBUTION = family(
    "distribution",
    tag="initial_porosity_distrib",
    package="solver.materials.distribution",
    key="text",
    meaning="how the initial value of a property is spread over the particles",
)


@singledispatch
def draw(distribution: Any, mean: float, deviation: float, patch: Any) -> NDArray[Any]:
    """Values of the particles (n,), none negative; ``patch`` holds the patch id of each, (n,)."""
    raise TypeError(f"{type(distribution).__name__} is no distribution")
