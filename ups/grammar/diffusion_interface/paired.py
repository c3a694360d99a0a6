"""An interface that Uintah's validator knows, and its program does not."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section
from ups.grammar import known


@known("diffusion_interface", "paired")
class PairedInterface(Section):
    """Exchange between pairs of materials."""

    materials: Annotated[tuple[int, ...], Parameter("indices of the materials", ge=0)] = ()
