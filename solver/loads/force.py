"""The <force> tag, which Uintah reads and never uses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from solver.declare import Parameter, Vector, model

_NEVER_APPLIED = "Uintah reads <force> and applies nothing; use <pressure> or gravity instead"


@model("load", "force")
@dataclass(frozen=True)
class Force:
    """A force density in a box. It has no effect, as in Uintah, and counts for no load curve's number."""

    lower: Annotated[Vector, Parameter("lower corner of the box", unit="m", ignored=_NEVER_APPLIED)]
    upper: Annotated[Vector, Parameter("upper corner of the box", unit="m", ignored=_NEVER_APPLIED)]
    force_density: Annotated[Vector, Parameter("force by volume", unit="N/m^3", ignored=_NEVER_APPLIED)]
