"""Failed particles lose their stress."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.erosion import Motion, erode, lets_fail, restrain
from solver.tensor import Tensor, isotropic


@model("erosion", "ZeroStress")
class ZeroStress(NamedTuple):
    """The deformation of a failed particle stops, and its stress decays as exp(-t / char_time)."""

    char_time: Annotated[float, Parameter("time over which stress decays", unit="s", gt=0.0)] = 1.0e-99


@implements(restrain, ZeroStress)
@lanewise
def _(algorithm: ZeroStress, old_gradient: Tensor, gradient: Tensor, velocity_gradient: Tensor) -> Motion:
    return Motion(old_gradient, isotropic(0.0))


@implements(erode, ZeroStress)
@lanewise
def _(algorithm: ZeroStress, stress: Tensor, failed_for: float) -> Tensor:
    return stress * math.exp(-failed_for / algorithm.char_time)


@implements(lets_fail, ZeroStress)
def _(algorithm: ZeroStress) -> bool:
    return True
