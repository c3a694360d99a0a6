"""Quantities that Uintah computes during a run or from an archive: ``<DataAnalysis>``, ``<PostProcess>``."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import IntVector, Parameter, Section, SectionOf, SubModel, Vector, family, model

MODULE = family(
    "analysis_module",
    "Module",
    "ups.grammar.data_analysis",
    "@name",
    "quantity that is computed during the run",
)

_PLANES = ("XY", "XZ", "YZ")
_WEIGHTS = ("none", "nCells", "mass")


class AnalysedVariable(Section):
    """A variable that is analysed."""

    label: Annotated[str, Parameter("its label", attribute=True)]
    matl: Annotated[str, Parameter("material index", attribute=True)] = ""
    level: Annotated[str, Parameter("level of the grid", attribute=True)] = ""
    computeReynoldsStress: Annotated[str, Parameter("compute its Reynolds stress", attribute=True)] = ""
    fluidVelocityLabel: Annotated[str, Parameter("velocity that carries it", attribute=True)] = ""
    weighting: Annotated[str, Parameter("weight of the mean", choices=_WEIGHTS, attribute=True)] = "none"


class Variables(Section):
    """The variables that are analysed."""

    analyze: Annotated[tuple[AnalysedVariable, ...], Parameter("a variable")] = ()


class NamedLabel(Section):
    """A label."""

    label: Annotated[str, Parameter("the label", attribute=True)]
    weighting: Annotated[str, Parameter("weight of the mean", choices=_WEIGHTS, attribute=True)] = "none"


class Line(Section):
    """A line through the grid."""

    name: Annotated[str, Parameter("its name", attribute=True)]
    startingPt: Annotated[Vector, Parameter("its start", unit="m")]
    endingPt: Annotated[Vector, Parameter("its end", unit="m")]
    stepSize: Annotated[float, Parameter("distance of points on it", unit="m", ge=0.0)] = 0.0


class Lines(Section):
    """Lines through the grid."""

    line: Annotated[tuple[Line, ...], Parameter("a line")] = ()


class Plane(Section):
    """A plane through the grid."""

    name: Annotated[str, Parameter("its name", attribute=True)] = ""
    startingPt: Annotated[Vector, Parameter("one corner", unit="m")]
    endingPt: Annotated[Vector, Parameter("the opposite corner", unit="m")]


class Planes(Section):
    """Planes through the grid."""

    plane: Annotated[tuple[Plane, ...], Parameter("a plane")] = ()


class ControlFace(Section):
    """A face of the control volume."""

    side: Annotated[str, Parameter("the face", choices=("x-", "x+", "y-", "y+", "z-", "z+"), attribute=True)]
    extents: Annotated[
        str, Parameter("all of it or a part", choices=("entireFace", "partialFace"), attribute=True)
    ]
    startPt: Annotated[Vector | None, Parameter("one corner of the part", unit="m")] = None
    endPt: Annotated[Vector | None, Parameter("the opposite corner", unit="m")] = None


class ControlVolume(Section):
    """The volume whose balance is computed."""

    Face: Annotated[tuple[ControlFace, ...], Parameter("a face")] = ()


class ControlVolumes(Section):
    """The volumes whose fluxes are computed."""

    pieces: Annotated[tuple[Any, ...], SubModel("geometry", many=True)] = ()


class AnyModule(Section):
    """What every quantity may say."""

    material: Annotated[str, Parameter("name of the material")] = ""
    materialIndex: Annotated[int, Parameter("index of the material")] = 0


class TimedModule(AnyModule):
    """A quantity that is computed at times."""

    samplingFrequency: Annotated[float, Parameter("samples a second", unit="1/s")] = 0.0
    timeStart: Annotated[float, Parameter("time of the first", unit="s")]
    timeStop: Annotated[float, Parameter("time of the last", unit="s")]
    Variables: Annotated[
        Any, SectionOf("ups.grammar.data_analysis:Variables"), Parameter("variables that are analysed")
    ] = None


@model("analysis_module", "vorticity", "SGS_ReynoldsStress")
class CellModule(AnyModule):
    """A quantity of every cell."""


@model("analysis_module", "minMax", "particleExtract", "spatialAvg", "statistics", "turbulentFluxes")
class VariableModule(TimedModule):
    """Extremes, values or averages of variables."""

    colorThreshold: Annotated[float, Parameter("color from which particles are extracted")] = 0.0
    monitorCell: Annotated[IntVector | None, Parameter("cell whose values are printed")] = None
    enableVerification: Annotated[bool, Parameter("test with random numbers")] = False
    domain: Annotated[
        str, Parameter("cells that are averaged", choices=("everywhere", "interior", "boundaries"))
    ] = "everywhere"
    avgBoxCells: Annotated[IntVector | None, Parameter("cells of the box of the average")] = None
    computeHigherOrderStats: Annotated[bool, Parameter("compute skewness and kurtosis")] = False


@model("analysis_module", "lineExtract")
class LineModule(TimedModule):
    """Values along lines."""

    lines: Annotated[Lines | None, Parameter("the lines")] = None


@model("analysis_module", "planeExtract")
class PlaneModule(TimedModule):
    """Values on planes."""

    planes: Annotated[Planes | None, Parameter("the planes")] = None


@model("analysis_module", "planeAverage", "planeAvgTurbFluxes")
class PlaneAverageModule(TimedModule):
    """Averages over planes."""

    planeOrientation: Annotated[str, Parameter("the planes", choices=_PLANES)]
    weight: Annotated[NamedLabel | None, Parameter("weight of the average")] = None
    velocity: Annotated[NamedLabel | None, Parameter("the velocity")] = None


@model("analysis_module", "controlVolFluxes")
class FluxModule(TimedModule):
    """Fluxes through control volumes."""

    controlVolumes: Annotated[ControlVolumes | None, Parameter("the volumes")] = None


@model("analysis_module", "firstLawThermo", "momentumAnalysis")
class BalanceModule(TimedModule):
    """Balance of energy or momentum over a control volume."""

    engy_convt_factor: Annotated[float, Parameter("factor on energies")] = 1.0
    controlVolume: Annotated[ControlVolume | None, Parameter("the volume")] = None
    uvel_FC: Annotated[NamedLabel | None, Parameter("velocity in x at faces")] = None
    vvel_FC: Annotated[NamedLabel | None, Parameter("velocity in y at faces")] = None
    wvel_FC: Annotated[NamedLabel | None, Parameter("velocity in z at faces")] = None
    vel_CC: Annotated[NamedLabel | None, Parameter("velocity in cells")] = None
    rho_CC: Annotated[NamedLabel | None, Parameter("density in cells")] = None


@model("analysis_module", "flatPlate_heatFlux")
class HeatFluxModule(AnyModule):
    """Heat that flows through a plate."""

    plane: Annotated[
        Any, SectionOf("ups.grammar.data_analysis:Plane", many=True), Parameter("the plate")
    ] = ()


@model("analysis_module", "radiometer")
class RadiometerModule(AnyModule):
    """Radiation that a radiometer sees."""


class DataAnalysis(Section):
    """Quantities that are computed during the run."""

    modules: Annotated[tuple[Any, ...], SubModel("analysis_module", many=True)] = ()
