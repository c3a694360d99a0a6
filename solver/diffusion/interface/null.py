"""Materials that exchange nothing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from solver.declare import Parameter, model
from solver.diffusion.interface import DiffusionInterface


@model("diffusion_interface", "null")
@dataclass(frozen=True)
class NullInterface(DiffusionInterface):
    """The surface of a material lets nothing through."""

    materials: Annotated[
        tuple[int, ...], Parameter("indices of the materials", ge=0, ignored="nothing passes")
    ] = ()
