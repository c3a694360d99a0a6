"""Options of gas dynamics: ``<CFD>``."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import IntVector, Parameter, Section, SubModel, Vector, family, model
from ups.grammar.linear_solver import SolverParameters
from ups.reader import Opaque

TURBULENCE = family("turbulence", "turbulence", "ups.grammar.ice", "@model", "stress of unresolved eddies")
WALL_STRESS = family("wall_shear_stress", "wallShearStress", "ups.grammar.ice", "@model", "stress at a wall")
MANUFACTURED = family(
    "manufactured_solution",
    "manufacturedSolution",
    "ups.grammar.ice",
    "@type",
    "problem with a known solution",
)

_AXES = ("x", "X", "y", "Y", "z", "Z")
_FACES = ("x-", "x+", "y-", "y+", "z-", "z+")


class Advection(Section):
    """How materials are carried with the flow."""

    type: Annotated[
        str,
        Parameter(
            "order of the scheme", choices=("FirstOrder", "FirstOrderGPU", "SecondOrder"), attribute=True
        ),
    ]
    useCompatibleFluxes: Annotated[bool, Parameter("limit all fluxes alike", attribute=True)] = True
    compatibleFluxes: Annotated[bool, Parameter("limit all fluxes alike", attribute=True)] = True


class AddHeat(Section):
    """Heat that is added for some time."""

    add_heat_matls: Annotated[str, Parameter("indices of the materials")]
    add_heat_coeff: Annotated[str, Parameter("rates of heating")]
    add_heat_t_start: Annotated[float, Parameter("time of the start", unit="s", ge=0.0)]
    add_heat_t_final: Annotated[float, Parameter("time of the end", unit="s", ge=0.0)]


@model("turbulence", "Smagorinsky")
class Smagorinsky(Section):
    """Smagorinsky's eddy viscosity."""

    model_constant: Annotated[float, Parameter("Smagorinsky's constant", ge=0.0)]


@model("turbulence", "Germano")
class Germano(Section):
    """Germano's dynamic eddy viscosity."""

    model_constant: Annotated[float, Parameter("constant of the model", ge=0.0)]
    filter_width: Annotated[float, Parameter("width of the filter", ge=0.0, le=1.0)]


@model("wall_shear_stress", "smoothWall")
class SmoothWall(Section):
    """Laminar stress at a smooth wall."""

    domainFace: Annotated[str, Parameter("the face", choices=_FACES)]


@model("wall_shear_stress", "logLawModel")
class LogLaw(SmoothWall):
    """Stress at a rough wall by the logarithmic law."""

    roughnessConstant: Annotated[float, Parameter("roughness of the wall", unit="m", ge=0.0)] = 0.0
    roughnessInputFile: Annotated[str, Parameter("file of roughness")] = ""
    vonKarmanConstant: Annotated[float, Parameter("von Karman's constant", ge=0.0, le=0.5)] = 0.4


@model("manufactured_solution", "mms_1", "mms_2", "mms_3")
class ManufacturedSolution(Section):
    """A flow with a known solution."""

    A: Annotated[float, Parameter("amplitude")] = 1.0
    angle: Annotated[float, Parameter("angle of the flow", unit="degrees")] = 0.0


class Vortex(Section):
    """One vortex."""

    axis: Annotated[str, Parameter("axis of rotation", choices=_AXES)]
    origin: Annotated[Vector, Parameter("centre", unit="m")]
    strength: Annotated[float, Parameter("circulation", unit="m^2/s")]
    radius: Annotated[float, Parameter("radius of the core", unit="m", ge=0.0)]


class Vortices(Section):
    """Vortices at the start."""

    vortex: Annotated[tuple[Vortex, ...], Parameter("a vortex")] = ()


class VortexPairs(Section):
    """Pairs of vortices at the start."""

    numVortexPairs: Annotated[float, Parameter("number of pairs")]
    axis: Annotated[str, Parameter("axis of rotation", choices=_AXES)]
    strength: Annotated[float, Parameter("circulation", unit="m^2/s")]


class GaussianTemperature(Section):
    """A hot spot at the start."""

    origin: Annotated[Vector, Parameter("centre", unit="m")]
    spread_x: Annotated[float, Parameter("width in x", unit="m")]
    spread_y: Annotated[float, Parameter("width in y", unit="m")]
    amplitude: Annotated[float, Parameter("greatest rise of temperature", unit="K", ge=0.0)]


class Counterflow(Section):
    """Two opposing flows at the start."""

    strainRate: Annotated[float, Parameter("rate of strain", unit="1/s", ge=0.0)]
    referenceCell: Annotated[IntVector, Parameter("cell of the stagnation point")]


class LogLawProfile(Section):
    """A logarithmic profile at the start."""

    verticalDir: Annotated[int, Parameter("axis that points up", ge=0, le=2)]
    principalFlowDir: Annotated[int, Parameter("axis of the flow", ge=0, le=2)]
    frictionVel: Annotated[Vector, Parameter("friction velocity", unit="m/s")]
    roughness: Annotated[float, Parameter("roughness", unit="m")] = 0.0
    vonKarmanConstant: Annotated[float, Parameter("von Karman's constant", ge=0.0, le=0.5)] = 0.4


class PowerLawProfile(Section):
    """A profile by a power of the height at the start."""

    verticalDir: Annotated[int, Parameter("axis that points up", ge=0, le=2)]
    profileHeight: Annotated[float, Parameter("height of the profile", unit="m")]
    U_infinity: Annotated[Vector, Parameter("velocity above the profile", unit="m/s")]
    exponent: Annotated[float, Parameter("exponent", ge=0.0)]


class ChannelProfile(Section):
    """The mean flow of a turbulent channel at the start."""

    Re_tau: Annotated[float, Parameter("friction Reynolds number", ge=0.0)]
    verticalDir: Annotated[int, Parameter("axis that points up", ge=0, le=2)]
    principalDir: Annotated[int, Parameter("axis of the flow", ge=0, le=2)]
    halfChannelHeight: Annotated[float, Parameter("half the height", unit="m", ge=0.0)]
    channelFloor: Annotated[float, Parameter("position of the floor", unit="m")] = 0.0
    channelCeiling: Annotated[float, Parameter("position of the ceiling", unit="m")] = 0.0


class DnsMoser(Section):
    """Moser's channel at the start."""

    verticalDir: Annotated[int, Parameter("axis that points up", ge=0, le=2)]
    dpdx: Annotated[float, Parameter("pressure gradient", unit="Pa/m")]


class CustomInitialization(Section):
    """Flows that the gas starts with."""

    manufacturedSolution: Annotated[Any, SubModel("manufactured_solution")] = None
    vortices: Annotated[Vortices | None, Parameter("vortices")] = None
    vortexPairs: Annotated[VortexPairs | None, Parameter("pairs of vortices")] = None
    gaussianTemperature: Annotated[GaussianTemperature | None, Parameter("a hot spot")] = None
    counterflow: Annotated[Counterflow | None, Parameter("opposing flows")] = None
    logLawProfile: Annotated[LogLawProfile | None, Parameter("a logarithmic profile")] = None
    powerLawProfile: Annotated[PowerLawProfile | None, Parameter("a profile by a power")] = None
    powerLawProfile2: Annotated[ChannelProfile | None, Parameter("a turbulent channel")] = None
    DNS_Moser: Annotated[DnsMoser | None, Parameter("Moser's channel")] = None


class ImplicitSolver(Section):
    """The implicit solution for the pressure."""

    max_outer_iterations: Annotated[int, Parameter("greatest number of outer iterations", ge=0)]
    outer_iteration_tolerance: Annotated[float, Parameter("residual at which they end", ge=0.0)]
    iters_before_timestep_restart: Annotated[int, Parameter("iterations after which the step is cut", ge=0)]
    Parameters: Annotated[SolverParameters | None, Parameter("the linear solver")] = None


class TimeStepControl(Section):
    """What limits the time step."""

    Scheme_for_delT_calc: Annotated[str, Parameter("the rule", choices=("aggressive", "conservative"))]
    knob_for_speedSound: Annotated[float, Parameter("weight of the speed of sound", ge=0.0, le=1.0)]
    knob_for_diffusion: Annotated[float, Parameter("weight of diffusion", ge=0.0, le=1.0)] = 1.0


class FixedPressureGradient(Section):
    """A pressure gradient that drives the flow."""

    x_dir: Annotated[float, Parameter("in x", unit="Pa/m")] = 0.0
    y_dir: Annotated[float, Parameter("in y", unit="Pa/m")] = 0.0
    z_dir: Annotated[float, Parameter("in z", unit="Pa/m")] = 0.0


class IceOptions(Section):
    """Options of the multi-material gas dynamics."""

    advection: Annotated[Advection, Parameter("how materials are carried")]
    applyHydrostaticPressure: Annotated[bool, Parameter("start with the pressure of the weight")] = True
    ADD_HEAT: Annotated[AddHeat | None, Parameter("heat that is added")] = None
    ClampSpecificVolume: Annotated[bool, Parameter("keep specific volumes positive")] = False
    turbulence: Annotated[Any, SubModel("turbulence")] = None
    wallShearStress: Annotated[Any, SubModel("wall_shear_stress")] = None
    customInitialization: Annotated[CustomInitialization | None, Parameter("flows at the start")] = None
    ImplicitSolver: Annotated[ImplicitSolver | None, Parameter("solve for the pressure implicitly")] = None
    max_iteration_equilibration: Annotated[
        int, Parameter("iterations of the equilibration of pressure", ge=0)
    ] = 100
    TimeStepControl: Annotated[TimeStepControl | None, Parameter("what limits the time step")] = None
    fixedPressureGradient: Annotated[
        FixedPressureGradient | None, Parameter("a gradient that drives the flow")
    ] = None


class Cfd(Section):
    """Options of gas dynamics."""

    cfl: Annotated[float, Parameter("Courant number", ge=0.0, le=1.0)] = 0.25
    ICE: Annotated[IceOptions | None, Parameter("options of the method")] = None
    ARCHES: Annotated[Opaque | None, Parameter("options of combustion")] = None
