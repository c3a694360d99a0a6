"""The same value everywhere."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.declare import model
from solver.materials.distribution import draw


@model("distribution", "constant")
class Constant(NamedTuple):
    """Every particle has the mean value."""


@draw.register
def _(distribution: Constant, mean: float, deviation: float, patch: Any) -> NDArray[Any]:
    return np.full(len(patch), mean)
