"""Materials of gas dynamics: gases and liquids, their equations of state and where they are at the start."""

from typing import Annotated, Any

from solver.declare import IntVector, Parameter, Section, SubModel, Vector, family
from ups.grammar.geometry_object import GeometryObjectExtension

EQUATION_OF_STATE = family(
    "ice_equation_of_state",
    "EOS",
    "ups.grammar.ice_equation_of_state",
    "@type",
    "pressure of a gas or liquid",
)
SPECIFIC_HEAT = family(
    "ice_specific_heat",
    "SpecificHeatModel",
    "ups.grammar.ice_specific_heat",
    "@type",
    "specific heat of a gas against temperature",
)
VISCOSITY = family(
    "ice_viscosity",
    "Model",
    "ups.grammar.ice_viscosity",
    "@name",
    "viscosity of a gas against temperature or place",
)


class PlainRegion(GeometryObjectExtension):
    """A region given by shapes."""

    name: Annotated[str, Parameter("a name for the reader", attribute=True)] = ""
    pieces: Annotated[tuple[Any, ...], SubModel("geometry", many=True)] = ()
    res: Annotated[IntVector | None, Parameter("sampling of the region, points a cell", ge=1)] = None
    velocity: Annotated[Vector | None, Parameter("velocity", unit="m/s")] = None
    temperature: Annotated[float, Parameter("temperature", unit="K")] = 0.0
    density: Annotated[float, Parameter("density", unit="kg/m^3")] = 0.0
    pressure: Annotated[float, Parameter("pressure", unit="Pa")] = 0.0
    volumeFraction: Annotated[float, Parameter("share of the volume", ge=0.0, le=1.0)] = 1.0
    concentration: Annotated[float, Parameter("concentration")] = 0.0
    level: Annotated[int, Parameter("level of the grid")] = 0
    color: Annotated[float, Parameter("a number to tell regions apart")] = 0.0
    numLevelsParticleFilling: Annotated[int, Parameter("sizes of particle that fill gaps")] = 1


class GasRegion(PlainRegion):
    """Where a gas is at the start, and in which state."""

    res: Annotated[IntVector, Parameter("sampling of the region, points a cell", ge=1)]
    velocity: Annotated[Vector, Parameter("velocity at the start", unit="m/s")]
    temperature: Annotated[float, Parameter("temperature at the start", unit="K", ge=0.0)]
    density: Annotated[float, Parameter("density at the start", unit="kg/m^3", ge=0.0)]
    pressure: Annotated[float, Parameter("pressure at the start", unit="Pa")]


class ViscosityModels(Section):
    """Laws of the viscosity."""

    models: Annotated[tuple[Any, ...], SubModel("ice_viscosity", many=True)] = ()


class IceMaterial(Section):
    """A gas or a liquid."""

    name: Annotated[str, Parameter("name of the material", attribute=True)] = ""
    index: Annotated[int, Parameter("index of the material", attribute=True)] = -1
    EOS: Annotated[Any, SubModel("ice_equation_of_state")]
    dynamic_viscosity: Annotated[float, Parameter("viscosity", unit="Pa s", ge=0.0)]
    thermal_conductivity: Annotated[float, Parameter("thermal conductivity", unit="W/(m K)", ge=0.0)]
    specific_heat: Annotated[float, Parameter("specific heat at constant volume", unit="J/(kg K)", gt=0.0)]
    gamma: Annotated[float, Parameter("ratio of the specific heats", ge=0.0)]
    geom_object: Annotated[tuple[GasRegion, ...], Parameter("where the material is at the start")] = ()
    dynamicViscosityModels: Annotated[ViscosityModels | None, Parameter("laws of the viscosity")] = None
    SpecificHeatModel: Annotated[Any, SubModel("ice_specific_heat")] = None
    tiny_rho: Annotated[float, Parameter("density where the material is absent", unit="kg/m^3", ge=0.0)] = (
        1.0e-12
    )
    includeFlowWork: Annotated[bool, Parameter("count the work of expansion")] = True
    isSurroundingMatl: Annotated[bool, Parameter("fill what other materials leave free")] = False


class IceMaterials(Section):
    """The materials of gas dynamics."""

    material: Annotated[tuple[IceMaterial, ...], Parameter("a gas or liquid")]
