"""Failure without consequence."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.erosion import Motion, erode, lets_fail, restrain
from solver.tensor import Tensor


@model("erosion", "none")
class NoErosion(NamedTuple):
    """Particles do not fail."""

    char_time: Annotated[
        float, Parameter("time over which stress decays", unit="s", ignored="nothing decays")
    ] = 1.0e-99


@model("erosion", "PreserveStress")
class PreserveStress(NamedTuple):
    """Particles fail, which contact and conversion see, and keep their stress."""

    char_time: Annotated[
        float, Parameter("time over which stress decays", unit="s", ignored="nothing decays")
    ] = 1.0e-99


@implements(restrain, NoErosion, PreserveStress)
@lanewise
def _(algorithm: NoErosion, old_gradient: Tensor, gradient: Tensor, velocity_gradient: Tensor) -> Motion:
    return Motion(gradient, velocity_gradient)


@implements(erode, NoErosion, PreserveStress)
@lanewise
def _(algorithm: NoErosion, stress: Tensor, failed_for: float) -> Tensor:
    return stress


@implements(lets_fail, NoErosion)
def _(algorithm: NoErosion) -> bool:
    return False


@implements(lets_fail, PreserveStress)
def _(algorithm: PreserveStress) -> bool:
    return True
