"""Normally distributed values."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.declare import model
from solver.materials.distribution import draw
from solver.random import gaussian, musil, turns

SEED = 0
"""Every patch starts from this seed, as in Uintah."""


@model("distribution", "gauss")
class Gauss(NamedTuple):
    """The magnitude of a normally distributed value; the draws of every patch start anew."""


@draw.register
def _(distribution: Gauss, mean: float, deviation: float, patch: Any) -> NDArray[Any]:
    values = np.empty(len(patch))
    for _, members, turn in turns(patch):
        pairs = musil(SEED, 2 * (int(turn.max()) + 1)).reshape(-1, 2)[turn]
        values[members] = np.abs(gaussian(pairs, mean, deviation))
    return values
