"""Invariants of stress as the yield surface takes them."""

from __future__ import annotations

import math
from typing import NamedTuple

from solver.dispatch import inline
from solver.materials.arenisca.yield_surface import ISOTROPIC
from solver.tensor import Tensor, determinant, deviator, double_dot, trace


class Invariants(NamedTuple):
    """First invariant of a stress, and the second and third of its deviator."""

    i1: float
    j2: float
    root_j2: float
    j3: float
    deviator: Tensor


@inline
def invariants(stress: Tensor) -> Invariants:
    """The invariants; a deviator within rounding of the pressure counts as none."""
    i1 = trace(stress)
    s = deviator(stress)
    j2 = 0.5 * double_dot(s, s)
    if j2 < ISOTROPIC * (i1 * i1 + j2):
        j2 = 0.0
    return Invariants(i1, j2, math.sqrt(j2), determinant(s), s)
