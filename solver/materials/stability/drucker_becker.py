"""Drucker's postulate and Becker's check together."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.materials.stability import TangentModulus, is_checked, localizes
from solver.materials.stability.acoustic import has_four_bands
from solver.materials.stability.drucker import work_rate_falls
from solver.tensor import Tensor


@model("stability", "drucker_becker")
class DruckerBecker(NamedTuple):
    """Unstable when either the check of Drucker or that of Becker finds it so."""


@implements(is_checked, DruckerBecker)
def _(check: DruckerBecker) -> bool:
    return True


@implements(localizes, DruckerBecker)
@lanewise
def _(check: DruckerBecker, stress: Tensor, rate: Tensor, tangent: TangentModulus) -> bool:
    return work_rate_falls(rate, tangent) | has_four_bands(stress, tangent)
