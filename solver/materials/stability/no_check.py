"""No check of stability."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements
from solver.materials.stability import TangentModulus, is_checked, localizes
from solver.tensor import Tensor


@model("stability", "none")
class NoCheck(NamedTuple):
    """Deformation never localizes."""


@implements(is_checked, NoCheck)
def _(check: NoCheck) -> bool:
    return False


@implements(localizes, NoCheck)
def _(check: NoCheck, stress: Tensor, rate: Tensor, tangent: TangentModulus) -> bool:
    return False
