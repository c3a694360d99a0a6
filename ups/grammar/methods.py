"""The sections of decks for methods that are known and not run."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import Parameter, Section, SectionOf
from solver.flags import Flags
from solver.time_control import TimeControl
from ups.deck import (
    Component,
    DataArchiver,
    GridSection,
    MaterialProperties,
    Meta,
    MPMMaterials,
    PhysicalBC,
    PhysicalConstants,
)
from ups.grammar.sections import CommonSections


class AnyMethod(CommonSections):
    """Sections that every method needs."""

    SimulationComponent: Annotated[Component, Parameter("which method runs the deck")]
    Time: Annotated[TimeControl, Parameter("limits of time and time step")]
    Grid: Annotated[GridSection, Parameter("the grid")]
    DataArchiver: Annotated[DataArchiver, Parameter("what is written")]
    Meta: Annotated[Meta | None, Parameter("what the deck says of itself")] = None
    PhysicalConstants: Annotated[PhysicalConstants | None, Parameter("constants")] = None


class MpmLike(AnyMethod):
    """A deck of a kin of the material point method."""

    MaterialProperties: Annotated[MaterialProperties, Parameter("the materials")]
    MPM: Annotated[Flags | None, Parameter("options of the material point method")] = None
    PhysicalBC: Annotated[PhysicalBC | None, Parameter("loads")] = None
    CFD: Annotated[Any, SectionOf("ups.grammar.ice:Cfd"), Parameter("options of gas dynamics")] = None
    Models: Annotated[Any, SectionOf("ups.grammar.models:Models"), Parameter("sources and reactions")] = None


class MpmIceMaterials(Section):
    """Materials of particles and of gases, and what they exchange."""

    MPM: Annotated[MPMMaterials, Parameter("materials of the material point method")]
    ICE: Annotated[Any, SectionOf("ups.grammar.ice_material:IceMaterials"), Parameter("gases and liquids")]
    exchange_properties: Annotated[
        Any, SectionOf("ups.grammar.exchange:ExchangeProperties"), Parameter("exchange between materials")
    ]
    add: Annotated[bool, Parameter("add the materials during a run", attribute=True)] = False


class MpmIce(AnyMethod):
    """A deck of the coupled gas-solid method."""

    MaterialProperties: Annotated[MpmIceMaterials, Parameter("the materials")]
    CFD: Annotated[Any, SectionOf("ups.grammar.ice:Cfd"), Parameter("options of gas dynamics")]
    MPM: Annotated[Flags, Parameter("options of the material point method")]
    PhysicalBC: Annotated[PhysicalBC | None, Parameter("loads")] = None
    Models: Annotated[Any, SectionOf("ups.grammar.models:Models"), Parameter("sources and reactions")] = None


class IceMaterialProperties(Section):
    """Materials of gases, and what they exchange."""

    ICE: Annotated[Any, SectionOf("ups.grammar.ice_material:IceMaterials"), Parameter("gases and liquids")]
    exchange_properties: Annotated[
        Any, SectionOf("ups.grammar.exchange:ExchangeProperties"), Parameter("exchange between materials")
    ] = None
    add: Annotated[bool, Parameter("add the materials during a run", attribute=True)] = False


class Ice(AnyMethod):
    """A deck of gas dynamics."""

    MaterialProperties: Annotated[IceMaterialProperties, Parameter("the materials")]
    CFD: Annotated[Any, SectionOf("ups.grammar.ice:Cfd"), Parameter("options of gas dynamics")]
    Models: Annotated[Any, SectionOf("ups.grammar.models:Models"), Parameter("sources and reactions")] = None
    MPM: Annotated[Flags | None, Parameter("options of particles", ignored="there are no particles")] = None
    PhysicalBC: Annotated[PhysicalBC | None, Parameter("loads", ignored="there are no particles")] = None
