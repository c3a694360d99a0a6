"""Sections at the top of a deck that the explicit material point method does not read."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import Parameter, Section, SectionOf, Vector
from ups.reader import Opaque

_GAS = "gas dynamics only"
_OTHER = "another component of Uintah reads it"
_ONE_LEVEL = "there is one level of the grid"


class CommonSections(Section):
    """Sections that every component takes."""

    AMR: Annotated[
        Any, SectionOf("ups.grammar.amr:Amr"), Parameter("refinement of the grid", ignored=_ONE_LEVEL)
    ] = None
    Solver: Annotated[
        Any,
        SectionOf("ups.grammar.linear_solver:LinearSolver"),
        Parameter("solver of linear systems", ignored="the explicit method solves none"),
    ] = None
    LoadBalancer: Annotated[
        Any,
        SectionOf("ups.grammar.parallel:LoadBalancer"),
        Parameter("how patches are shared among processes", ignored="work is shared otherwise"),
    ] = None
    Scheduler: Annotated[
        Any,
        SectionOf("ups.grammar.parallel:Scheduler"),
        Parameter("how tasks are run", ignored="there are no tasks to schedule"),
    ] = None
    SimulationController: Annotated[
        Any,
        SectionOf("ups.grammar.parallel:SimulationController"),
        Parameter("statistics of the run", ignored="run statistics are printed otherwise"),
    ] = None
    DataAnalysis: Annotated[
        Any,
        SectionOf("ups.grammar.data_analysis:DataAnalysis"),
        Parameter("quantities computed during the run", ignored="it is not computed by this program"),
    ] = None
    PostProcess: Annotated[
        Any,
        SectionOf("ups.grammar.data_analysis:DataAnalysis"),
        Parameter("quantities computed from an archive", ignored="it is not computed by this program"),
    ] = None
    ParticlePosition: Annotated[
        Any,
        SectionOf("ups.grammar.sections:ParticlePosition"),
        Parameter("label of particle positions", ignored="positions are p.x"),
    ] = None
    InitialConditions: Annotated[
        Opaque | None, Parameter("initial conditions of other methods", ignored=_OTHER)
    ] = None
    PreprocessTools: Annotated[Opaque | None, Parameter("input of Uintah's tools", ignored=_OTHER)] = None
    ARCHES: Annotated[Opaque | None, Parameter("options of combustion", ignored=_OTHER)] = None
    Wasatch: Annotated[Opaque | None, Parameter("options of reacting flow", ignored=_OTHER)] = None
    RMCRT: Annotated[Opaque | None, Parameter("radiation by ray tracing", ignored=_OTHER)] = None
    PhaseField: Annotated[Opaque | None, Parameter("options of phase fields", ignored=_OTHER)] = None
    ParticleBC: Annotated[Opaque | None, Parameter("walls of other methods", ignored=_OTHER)] = None


class MpmSections(CommonSections):
    """Sections of other methods, which the material point method passes over."""

    CFD: Annotated[
        Any, SectionOf("ups.grammar.ice:Cfd"), Parameter("options of gas dynamics", ignored=_GAS)
    ] = None
    Models: Annotated[
        Any, SectionOf("ups.grammar.models:Models"), Parameter("sources and reactions of gases", ignored=_GAS)
    ] = None


class ParticlePosition(Section):
    """The label under which particle positions are kept."""

    label: Annotated[str, Parameter("the label, p.x", attribute=True)]


class MaterialPropertiesExtension(Section):
    """Materials of other methods."""

    ICE: Annotated[
        Any,
        SectionOf("ups.grammar.ice_material:IceMaterials"),
        Parameter("materials of gas dynamics", ignored=_GAS),
    ] = None
    exchange_properties: Annotated[
        Any,
        SectionOf("ups.grammar.exchange:ExchangeProperties"),
        Parameter("exchange between gases and solids", ignored=_GAS),
    ] = None
    add: Annotated[bool, Parameter("add the materials during a run", attribute=True, ignored=_OTHER)] = False


class GridExtension(Section):
    """What the grid may say besides what this program reads."""

    doAMR: Annotated[bool, Parameter("refine the grid", attribute=True, unsupported="several levels")] = False


class BoxExtension(Section):
    """What a block of the grid may say besides what this program reads."""

    autoPatch: Annotated[
        int, Parameter("number of patches, cut as cubes", ge=0, ignored="the whole block is one patch")
    ] = 0


class PhysicalConstantsExtension(Section):
    """Constants that the material point method does not read."""

    reference_point: Annotated[
        Vector, Parameter("where the reference pressure holds", unit="m", ignored=_GAS)
    ] = (
        0.0,
        0.0,
        0.0,
    )
    viscosity: Annotated[float, Parameter("viscosity", unit="Pa s", ignored=_OTHER)] = 0.0
