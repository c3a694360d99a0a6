"""Viscosity of gases against temperature or place."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import Parameter, Section, SubModel, model


@model("ice_viscosity", "Sutherland")
class Sutherland(Section):
    """Sutherland's law of a dilute gas."""

    a: Annotated[float, Parameter("factor of the law")]
    b: Annotated[float, Parameter("Sutherland's temperature", unit="K")]


@model("ice_viscosity", "SpongeLayer")
class SpongeLayer(Section):
    """A layer of high viscosity that swallows waves."""

    maxDynamicViscosity: Annotated[float, Parameter("viscosity in the layer", unit="Pa s")]
    pieces: Annotated[tuple[Any, ...], SubModel("geometry", many=True)] = ()
