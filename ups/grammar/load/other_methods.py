"""Loads of combustion."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section
from ups.grammar import known
from ups.reader import Opaque


@known("load", "arches_heat_flux")
class ArchesHeatFlux(Section):
    """Heat from a computed fire."""

    geom_object: Annotated[Opaque | None, Parameter("where")] = None
    load_curve: Annotated[Opaque | None, Parameter("the heat against time")] = None
    polynomial_data: Annotated[Opaque | None, Parameter("files of the heat")] = None
