"""Failed particles bear mean stress alone."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.erosion import Motion, erode, lets_fail, restrain, volumetric_motion
from solver.tensor import Tensor, isotropic, trace


@model("erosion", "AllowNoShear")
class AllowNoShear(NamedTuple):
    """Failed particles bear pressure and tension without shear."""

    char_time: Annotated[
        float, Parameter("time over which stress decays", unit="s", ignored="shear vanishes at once")
    ] = 1.0e-99


@implements(restrain, AllowNoShear)
@lanewise
def _(algorithm: AllowNoShear, old_gradient: Tensor, gradient: Tensor, velocity_gradient: Tensor) -> Motion:
    return volumetric_motion(gradient, velocity_gradient)


@implements(erode, AllowNoShear)
@lanewise
def _(algorithm: AllowNoShear, stress: Tensor, failed_for: float) -> Tensor:
    return isotropic(trace(stress) / 3.0)


@implements(lets_fail, AllowNoShear)
def _(algorithm: AllowNoShear) -> bool:
    return True
