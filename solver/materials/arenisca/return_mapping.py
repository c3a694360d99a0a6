"""Return of a trial stress to a yield surface that stays where it is, to be answered by each model.

The stress is stretched so that the closest point in the energy norm, or what stands in for it under
non-associated flow, is the closest point to the eye: deviators by beta sqrt(3 K / (2 G)). From a point
inside, bisection towards the trial stress finds the surface; turning that point about the trial stress finds
another inside, and so on with smaller and smaller turns until none is (Homel and Brannon, Int. J. Numer.
Meth. Eng. 101, 2015).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.dispatch import generic, inline
from solver.materials.arenisca.elasticity import Moduli
from solver.materials.arenisca.invariants import Invariants
from solver.materials.arenisca.yield_surface import Surface
from solver.tensor import Tensor

BISECTED = 1.0e-6
"""Length, as a part of the way to the trial stress, at which a bisection ends."""

PATIENCE = 10
"""After this times as many tries as there are turns, the return has failed."""


class Returned(NamedTuple):
    """A stress on the yield surface."""

    stress: Tensor
    i1: float
    failed: bool


@generic
def is_yielding(  # type: ignore[empty-body]  # bodies come from the models
    model: Any, at: Surface, stress: Invariants
) -> bool:
    """Whether a stress lies outside the yield surface."""


@generic
def return_to_surface(  # type: ignore[empty-body]  # bodies come from the models
    model: Any, at: Surface, stiffness: Moduli, trial: Tensor, stress: Invariants
) -> Returned:
    """The stress on the surface that belongs to a trial stress outside, given with its invariants."""


@inline
def deviator_stretch(model: Any, stiffness: Moduli) -> float:
    """The factor of deviators in the space in which the closest point is sought."""
    return float(model.BETA_nonassociativity * math.sqrt(1.5 * stiffness.bulk / stiffness.shear))


@inline
def inner_point(at: Surface, i1: float, size: float) -> float:
    """I1 of a hydrostatic stress inside the surface, from which to look for the way out.

    ``size`` measures the deviator of the trial stress.
    """
    above = i1 - at.zeta
    if above >= at.limit.peak:
        reach = min(math.sqrt(above * above + size * size), 0.5 * (at.limit.peak - at.cap))
        return at.zeta + at.limit.peak - reach
    if above > at.cap:
        return i1
    return at.zeta + 0.5 * (at.limit.peak + at.cap)
