"""Failed particles bear pressure alone."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.lanes import where
from solver.materials.erosion import Motion, erode, lets_fail, restrain, volumetric_motion
from solver.tensor import Tensor, isotropic, trace


@model("erosion", "AllowNoTension")
class AllowNoTension(NamedTuple):
    """Failed particles bear compression without shear; stress in tension decays as exp(-t / char_time)."""

    char_time: Annotated[float, Parameter("time over which tension decays", unit="s", gt=0.0)] = 1.0e-99


@implements(restrain, AllowNoTension)
@lanewise
def _(algorithm: AllowNoTension, old_gradient: Tensor, gradient: Tensor, velocity_gradient: Tensor) -> Motion:
    return volumetric_motion(gradient, velocity_gradient)


@implements(erode, AllowNoTension)
@lanewise
def _(algorithm: AllowNoTension, stress: Tensor, failed_for: float) -> Tensor:
    mean = trace(stress) / 3.0
    return where(mean > 0.0, stress * math.exp(-failed_for / algorithm.char_time), isotropic(mean))


@implements(lets_fail, AllowNoTension)
def _(algorithm: AllowNoTension) -> bool:
    return True
