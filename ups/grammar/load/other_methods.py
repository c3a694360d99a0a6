"""Loads of scalar diffusion and of combustion."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import IntVector, Parameter, Section, SectionOf
from solver.loads.curve import LoadCurve
from ups.grammar import known
from ups.reader import Opaque


@known("load", "scalar_flux")
class ScalarFlux(Section):
    """A flux of a scalar through a surface."""

    geom_object: Annotated[
        Any,
        SectionOf("ups.grammar.ice_material:PlainRegion"),
        Parameter("shape whose surface it flows through"),
    ]
    outward_normal: Annotated[bool, Parameter("along the normal out of the body")] = False
    auto_cycle: Annotated[bool, Parameter("turn the flux at limits of the concentration")] = False
    load_curve: Annotated[LoadCurve, Parameter("the flux against time")]
    res: Annotated[IntVector | None, Parameter("particles a cell")] = None


@known("load", "arches_heat_flux")
class ArchesHeatFlux(Section):
    """Heat from a computed fire."""

    geom_object: Annotated[Opaque | None, Parameter("where")] = None
    load_curve: Annotated[Opaque | None, Parameter("the heat against time")] = None
    polynomial_data: Annotated[Opaque | None, Parameter("files of the heat")] = None
