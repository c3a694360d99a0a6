"""Sources, reactions and mixing of gases: ``<Models>``."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import Parameter, Section, SectionOf, Vector
from ups.grammar.ice_material import PlainRegion
from ups.reader import Opaque

_PROFILE_AXES = ("x", "X", "y", "Y", "z", "Z")


class FixedSource(Section):
    """What the material is set to in a region."""

    type: Annotated[str, Parameter("kind of source", choices=("fixedPrimitiveValues",), attribute=True)]
    velocity_src: Annotated[Vector, Parameter("velocity that is held", unit="m/s")]
    temperature_src: Annotated[float, Parameter("temperature that is held", unit="K")]
    density_src: Annotated[float, Parameter("density that is held", unit="kg/m^3")]
    timeStart: Annotated[float, Parameter("time of the start", unit="s")] = 0.0
    timeStop: Annotated[float, Parameter("time of the end", unit="s")] = 1.0e99


class SourceRegion(PlainRegion):
    """A region with a source."""

    algorithm: Annotated[FixedSource, Parameter("what is held in the region")]


class Sources(Section):
    """Regions with sources."""

    geom_object: Annotated[tuple[SourceRegion, ...], Parameter("a region")] = ()


class MassMomentumEnergySource(Section):
    """Sources of mass, momentum and energy."""

    material: Annotated[str, Parameter("material that is fed")]
    sources: Annotated[Sources, Parameter("regions with sources")]


class Profile(Section):
    """A profile that is read from a file."""

    filename: Annotated[str, Parameter("the file")]
    axis: Annotated[str, Parameter("axis along which it varies", choices=_PROFILE_AXES)]


class ConstantSources(Section):
    """Constant sources of heat and of a scalar."""

    material: Annotated[str, Parameter("material that is fed")]
    qdot_Wm3: Annotated[float, Parameter("heat source", unit="W/m^3")] = 0.0
    scalar_remove_per_s: Annotated[float, Parameter("rate at which the scalar vanishes", unit="1/s")]
    phi_init: Annotated[float, Parameter("scalar at the start")] = 0.0
    geom_object: Annotated[PlainRegion | None, Parameter("where")] = None
    qdotProfile: Annotated[Profile | None, Parameter("profile of the heat source")] = None
    initProfile: Annotated[Profile | None, Parameter("profile at the start")] = None


class DecayFactor(Section):
    """The factor of the decay, constant or from a file."""

    type: Annotated[str, Parameter("where it comes from", choices=("constant", "variable"), attribute=True)]
    value: Annotated[float, Parameter("the constant", ge=0.0)] = 0.0
    filename: Annotated[str, Parameter("the file")] = ""


class ExponentialDecay(Section):
    """Decay of a scalar with time."""

    c1: Annotated[float, Parameter("first constant", ge=0.0)]
    c2: Annotated[DecayFactor, Parameter("second constant")]
    c3: Annotated[float, Parameter("third constant")] = 0.0


class TracerScalar(Section):
    """A scalar that tracers carry."""

    name: Annotated[str, Parameter("name of the scalar", attribute=True)] = ""
    initialValue: Annotated[float, Parameter("value at the start")]
    exponentialDecay: Annotated[ExponentialDecay | None, Parameter("decay with time")] = None


class TracerRegion(PlainRegion):
    """Where tracers are at the start."""

    particlesPerCell: Annotated[float, Parameter("tracers in a cell")]


class TracerSource(PlainRegion):
    """Where tracers appear."""

    particlesPerCellPerSecond: Annotated[float, Parameter("tracers a cell and second", unit="1/s")]


class TracerStart(Section):
    """Where tracers are at the start."""

    geom_object: Annotated[tuple[TracerRegion, ...], Parameter("a region")] = ()


class TracerSources(Section):
    """Where tracers appear."""

    geom_object: Annotated[tuple[TracerSource, ...], Parameter("a region")] = ()


class Tracer(Section):
    """A kind of tracer."""

    name: Annotated[str, Parameter("name of the tracer", attribute=True)] = ""
    initialization: Annotated[TracerStart, Parameter("where tracers are at the start")]
    interiorSources: Annotated[TracerSources | None, Parameter("where tracers appear")] = None


class ClonedLabel(Section):
    """A variable of the gas that tracers carry along."""

    label: Annotated[str, Parameter("label of the variable", attribute=True)]


class ClonedVariables(Section):
    """Variables of the gas that tracers carry along."""

    CCVarLabel: Annotated[tuple[ClonedLabel, ...], Parameter("a variable")] = ()


class TracerParticles(Section):
    """Massless particles that follow the gas."""

    modelPreviouslyInitialized: Annotated[bool, Parameter("go on from an earlier run")] = False
    reinitializeDomain: Annotated[bool, Parameter("begin anew")] = False
    material: Annotated[str, Parameter("material that is followed")] = ""
    timeStart: Annotated[float, Parameter("time of the start", unit="s", ge=0.0)] = 0.0
    timeStop: Annotated[float, Parameter("time of the end", unit="s", ge=0.0)] = 1.0e99
    cloneVariables: Annotated[ClonedVariables | None, Parameter("variables carried along")] = None
    scalar: Annotated[TracerScalar | None, Parameter("a scalar carried along")] = None
    tracer: Annotated[Tracer | None, Parameter("the tracers")] = None


class Conversion(Section):
    """A reaction that turns one material into another."""

    fromMaterial: Annotated[str, Parameter("material that reacts")]
    toMaterial: Annotated[str, Parameter("material that forms")]


class TestModel(Section):
    """A conversion at a constant rate."""

    fromMaterial: Annotated[str, Parameter("material that reacts")] = ""
    toMaterial: Annotated[str, Parameter("material that forms")] = ""
    rate: Annotated[float, Parameter("rate of conversion", unit="1/s", ge=0.0)]
    startTime: Annotated[float, Parameter("time of the start", unit="s", ge=0.0)] = 0.0


class LightTime(Section):
    """Detonation by the time at which the front arrives."""

    fromMaterial: Annotated[str, Parameter("material that reacts")] = ""
    toMaterial: Annotated[str, Parameter("material that forms")] = ""
    D: Annotated[float, Parameter("speed of the front", unit="m/s", ge=0.0)]
    E0: Annotated[float, Parameter("energy that is set free", unit="J/kg", ge=0.0)]
    starting_location: Annotated[Vector, Parameter("where the front starts", unit="m")]
    react_mixed_cells: Annotated[bool, Parameter("let mixed cells react")]
    direction_if_plane: Annotated[Vector, Parameter("direction of a plane front")]


class JwlPlusPlus(Conversion):
    """Detonation by the JWL++ law: rate G p^b (1 - F)."""

    ThresholdPressure: Annotated[float, Parameter("pressure from which it reacts", unit="Pa", ge=0.0)]
    ThresholdVolFrac: Annotated[float, Parameter("volume fraction below which all reacts", ge=0.0)] = 0.01
    rho0: Annotated[float, Parameter("density of the explosive", unit="kg/m^3", ge=0.0)]
    G: Annotated[float, Parameter("factor of the rate", ge=0.0)]
    b: Annotated[float, Parameter("exponent of the pressure", ge=0.0)]
    E0: Annotated[float, Parameter("energy that is set free", unit="J/kg", ge=0.0)]


class BinaryConstants(Section):
    """Properties of two gases and of their mixing."""

    diffusivity: Annotated[float, Parameter("diffusion coefficient", unit="m^2/s", ge=0.0)]
    rho_A: Annotated[float, Parameter("density of gas A", unit="kg/m^3", ge=0.0)]
    rho_B: Annotated[float, Parameter("density of gas B", unit="kg/m^3", ge=0.0)]
    cv_A: Annotated[float, Parameter("specific heat of gas A", unit="J/(kg K)", ge=0.0)]
    cv_B: Annotated[float, Parameter("specific heat of gas B", unit="J/(kg K)", ge=0.0)]
    R_A: Annotated[float, Parameter("gas constant of gas A", unit="J/(kg K)", ge=0.0)]
    R_B: Annotated[float, Parameter("gas constant of gas B", unit="J/(kg K)", ge=0.0)]
    thermalCond_A: Annotated[float, Parameter("conductivity of gas A", unit="W/(m K)", ge=0.0)]
    thermalCond_B: Annotated[float, Parameter("conductivity of gas B", unit="W/(m K)", ge=0.0)]
    dynamic_viscosity_A: Annotated[float, Parameter("viscosity of gas A", unit="Pa s", ge=0.0)]
    dynamic_viscosity_B: Annotated[float, Parameter("viscosity of gas B", unit="Pa s", ge=0.0)]
    initialize_diffusion_knob: Annotated[float, Parameter("smoothings at the start", ge=0.0)]


class BinaryScalar(Section):
    """Share of gas A."""

    name: Annotated[str, Parameter("name of the scalar", attribute=True)] = ""
    constants: Annotated[BinaryConstants | None, Parameter("properties of the gases")] = None
    geom_object: Annotated[tuple[PlainRegion, ...], Parameter("where gas A is")] = ()
    test_conservation: Annotated[bool, Parameter("print the sum of the scalar")] = False


class BinaryProperties(Section):
    """Mixing of two gases."""

    material: Annotated[str, Parameter("material that is the mixture")]
    scalar: Annotated[BinaryScalar | None, Parameter("share of gas A")] = None


class FlameSheetConstants(Section):
    """Constants of a flame sheet."""

    f_stoichometric: Annotated[float, Parameter("mixture fraction of the flame", ge=0.0, le=1.0)]
    delta_H_combustion: Annotated[float, Parameter("heat of combustion", unit="J/kg", ge=0.0)]
    oxidizer_temp_infinity: Annotated[float, Parameter("temperature of the oxidiser", unit="K", ge=0.0)]
    initial_fuel_temp: Annotated[float, Parameter("temperature of the fuel", unit="K", ge=0.0)]
    diffusivity: Annotated[float, Parameter("diffusion coefficient", unit="m^2/s", ge=0.0)]


class FlameSheetScalar(Section):
    """The mixture fraction."""

    name: Annotated[str, Parameter("name of the scalar", attribute=True)] = ""
    reaction_constants: Annotated[FlameSheetConstants | None, Parameter("constants of the flame")] = None
    geom_object: Annotated[tuple[PlainRegion, ...], Parameter("where the fuel is")] = ()


class FlameSheet(Section):
    """Fast combustion in a thin sheet."""

    material: Annotated[str, Parameter("material that burns")]
    scalar: Annotated[FlameSheetScalar | None, Parameter("the mixture fraction")] = None


class RateConstant(Section):
    """Arrhenius' law."""

    type: Annotated[str, Parameter("the law", choices=("Arrhenius", "ModifiedArrhenius"), attribute=True)] = (
        ""
    )
    A: Annotated[float, Parameter("factor")]
    Ea: Annotated[float, Parameter("activation energy", unit="J/mol")]
    b: Annotated[float, Parameter("exponent of the temperature")] = 0.0


class RateModel(Section):
    """How the rate depends on what has reacted."""

    type: Annotated[
        str,
        Parameter(
            "the law",
            choices=(
                "AvaramiErofeev",
                "ContractingCylinder",
                "ContractingSphere",
                "Diffusion",
                "NthOrder",
                "Power",
                "ProutTompkins",
            ),
            attribute=True,
        ),
    ] = ""
    a: Annotated[float, Parameter("first constant")] = 0.0
    b: Annotated[float, Parameter("second constant")] = 0.0
    dimension: Annotated[float, Parameter("dimension of the diffusion")] = 1.0
    n: Annotated[float, Parameter("order")] = 1.0
    m: Annotated[float, Parameter("second order")] = 1.0
    p: Annotated[float, Parameter("third constant")] = 0.0
    q: Annotated[float, Parameter("fourth constant")] = 0.0


class SolidReaction(Conversion):
    """A reaction of solids."""

    E0: Annotated[float, Parameter("energy that is set free", unit="J/kg")]
    RateConstantModel: Annotated[RateConstant | None, Parameter("rate against temperature")] = None
    RateModel: Annotated[
        Any, SectionOf("ups.grammar.models:RateModel"), Parameter("rate against progress")
    ] = None


class SimpleBurn(Conversion):
    """Burning of a surface at a rate that follows the pressure."""

    ThresholdPressure: Annotated[float, Parameter("pressure from which it burns", unit="Pa", ge=0.0)]
    ThresholdTemp: Annotated[float, Parameter("temperature from which it burns", unit="K", ge=0.0)]
    Enthalpy: Annotated[float, Parameter("heat of reaction", unit="J/kg", ge=0.0)]
    BurnCoeff: Annotated[
        float, Parameter("burning rate at the reference pressure", unit="kg/(m^2 s)", ge=0.0)
    ]
    refPressure: Annotated[float, Parameter("reference pressure", unit="Pa", ge=0.0)]


class BurningSurface(Conversion):
    """Burning of a surface after Ward, Son and Brewster (WSB)."""

    IdealGasConst: Annotated[float, Parameter("gas constant", unit="J/(mol K)", ge=0.0)]
    PreExpCondPh: Annotated[float, Parameter("rate factor in the solid", ge=0.0)]
    ActEnergyCondPh: Annotated[float, Parameter("activation energy in the solid", unit="J/mol", ge=0.0)]
    PreExpGasPh: Annotated[float, Parameter("rate factor in the gas", ge=0.0)]
    CondPhaseHeat: Annotated[float, Parameter("heat set free in the solid", unit="J/kg", ge=0.0)]
    GasPhaseHeat: Annotated[float, Parameter("heat set free in the gas", unit="J/kg", ge=0.0)]
    HeatConductGasPh: Annotated[float, Parameter("conductivity of the gas", unit="W/(m K)", ge=0.0)]
    HeatConductCondPh: Annotated[float, Parameter("conductivity of the solid", unit="W/(m K)", ge=0.0)]
    SpecificHeatBoth: Annotated[float, Parameter("specific heat of both", unit="J/(kg K)", ge=0.0)]
    MoleWeightGasPh: Annotated[float, Parameter("molar mass of the gas", unit="kg/mol", ge=0.0)]
    BoundaryParticles: Annotated[int, Parameter("particles in a cell below which it is at the surface", ge=0)]
    IgnitionTemp: Annotated[float, Parameter("temperature of ignition", unit="K", ge=0.0)]


class SteadyBurn(BurningSurface):
    """Steady burning of a surface."""

    ThresholdPressure: Annotated[float, Parameter("pressure from which it burns", unit="Pa", ge=0.0)]


class UnsteadyBurn(SteadyBurn):
    """Burning of a surface under changing pressure."""

    BurnrateModCoef: Annotated[float, Parameter("coefficient of the change of rate", ge=0.0)]
    CondUnsteadyCoef: Annotated[float, Parameter("delay of the solid", ge=0.0)]
    GasUnsteadyCoef: Annotated[float, Parameter("delay of the gas", ge=0.0)]


class PressureSwitch(Section):
    """Output changes at a pressure."""

    PressureThreshold: Annotated[float, Parameter("the pressure", unit="Pa", ge=0.0)]
    newOutputInterval: Annotated[float, Parameter("time between outputs from then on", unit="s", ge=0.0)]
    newCheckPointInterval: Annotated[float, Parameter("time between checkpoints", unit="s", ge=0.0)]


class DetonationDetected(Section):
    """Output changes at detonation."""

    remainingTimesteps: Annotated[int, Parameter("steps that are still done", ge=0)]
    newOutputInterval: Annotated[float, Parameter("time between outputs from then on", unit="s", ge=0.0)]
    newCheckPointInterval: Annotated[float, Parameter("time between checkpoints", unit="s", ge=0.0)]


class IntervalChanges(Section):
    """When output changes."""

    PressureSwitch: Annotated[
        Any, SectionOf("ups.grammar.models:PressureSwitch"), Parameter("at a pressure")
    ] = None
    DetonationDetected: Annotated[
        Any, SectionOf("ups.grammar.models:DetonationDetected"), Parameter("at detonation")
    ] = None


class CrackedDetonation(Conversion):
    """What both models of deflagration to detonation read."""

    b: Annotated[float, Parameter("exponent of the pressure in JWL++")]
    E0: Annotated[float, Parameter("energy that is set free", unit="J/kg")]
    G: Annotated[float, Parameter("factor of the rate in JWL++")]
    useCrackModel: Annotated[bool, Parameter("let flames enter cracks")] = False
    Gcrack: Annotated[float, Parameter("factor of the crack law")] = 0.0
    CrackVolThreshold: Annotated[float, Parameter("volume fraction of cracks")] = 0.0
    nCrack: Annotated[float, Parameter("exponent of the crack law")] = 0.0
    ThresholdPressureJWL: Annotated[float, Parameter("pressure of detonation", unit="Pa", ge=0.0)]
    ThresholdPressureSB: Annotated[float, Parameter("pressure of burning", unit="Pa", ge=0.0)]
    ThresholdVolFrac: Annotated[float, Parameter("volume fraction below which all reacts", ge=0.0)] = 0.01


class Ddt0(CrackedDetonation):
    """Deflagration by Simple_Burn, detonation by JWL++."""

    ThresholdTemp: Annotated[float, Parameter("temperature of burning", unit="K", ge=0.0)]
    Enthalpy: Annotated[float, Parameter("heat of reaction", unit="J/kg", ge=0.0)]
    BurnCoeff: Annotated[float, Parameter("burning rate at the reference pressure", ge=0.0)]
    refPressure: Annotated[float, Parameter("reference pressure", unit="Pa", ge=0.0)]


class Ddt1(CrackedDetonation, BurningSurface):
    """Deflagration by Steady_Burn, detonation by JWL++."""

    burnMaterial: Annotated[str, Parameter("material that burning forms, if another")] = ""
    useInductionTime: Annotated[bool, Parameter("wait for ignition")] = False
    IgnitionConst: Annotated[float, Parameter("constant of the induction time", ge=0.0)] = 0.0
    PressureShift: Annotated[float, Parameter("shift of the pressure", ge=0.0)] = 0.0
    PreexpoConst: Annotated[float, Parameter("factor of the induction time", ge=0.0)] = 0.0
    ExponentialConst: Annotated[float, Parameter("exponent of the induction time", ge=0.0)] = 0.0
    adjust_IO_intervals: Annotated[IntervalChanges | None, Parameter("when output changes")] = None


class IgnitionAndGrowth(Conversion):
    """Ignition and growth of detonation after Lee and Tarver."""

    I: Annotated[float, Parameter("factor of ignition", ge=0.0)]  # noqa: E741  # the tag's name
    G1: Annotated[float, Parameter("factor of the first growth", ge=0.0)]
    G2: Annotated[float, Parameter("factor of the second growth", ge=0.0)]
    a: Annotated[float, Parameter("compression of ignition", ge=0.0)]
    b: Annotated[float, Parameter("exponent of what is left, ignition", ge=0.0)]
    c: Annotated[float, Parameter("exponent of what is left, first growth", ge=0.0)]
    d: Annotated[float, Parameter("exponent of what has reacted, first growth", ge=0.0)]
    e: Annotated[float, Parameter("exponent of what is left, second growth", ge=0.0)]
    g: Annotated[float, Parameter("exponent of what has reacted, second growth", ge=0.0)]
    x: Annotated[float, Parameter("exponent of the compression", ge=0.0)]
    y: Annotated[float, Parameter("exponent of the pressure, first growth", ge=0.0)]
    z: Annotated[float, Parameter("exponent of the pressure, second growth", ge=0.0)]
    Figmax: Annotated[float, Parameter("share up to which it ignites", ge=0.0)]
    FG1max: Annotated[float, Parameter("share up to which it grows first", ge=0.0)]
    FG2min: Annotated[float, Parameter("share from which it grows next", ge=0.0)]
    rho0: Annotated[float, Parameter("density of the explosive", unit="kg/m^3", ge=0.0)]
    E0: Annotated[float, Parameter("energy that is set free", unit="J/kg", ge=0.0)]
    ThresholdPressure: Annotated[float, Parameter("pressure from which it reacts", unit="Pa", ge=0.0)]


class ScalarConstants(Section):
    """Constants of a scalar."""

    AMR_Refinement_Criteria: Annotated[float, Parameter("gradient that asks for refinement")] = 1.0e100
    diffusivity: Annotated[float, Parameter("diffusion coefficient", unit="m^2/s")] = 0.0
    rateOfChange0: Annotated[float, Parameter("constant source", unit="1/s")] = 0.0
    rateOfChange1: Annotated[float, Parameter("source that follows the scalar", unit="1/s")] = 0.0
    initialize_diffusion_knob: Annotated[
        int, Parameter("smoothings at the start", ignored="no longer read by Uintah")
    ] = 0


class Regions(Section):
    """Regions in space."""

    geom_object: Annotated[tuple[PlainRegion, ...], Parameter("a region")] = ()


class PassiveScalarField(Section):
    """A scalar carried with the gas."""

    name: Annotated[str, Parameter("name of the scalar", attribute=True)] = ""
    test_conservation: Annotated[bool, Parameter("print the sum of the scalar")] = False
    reinitializeDomain: Annotated[bool, Parameter("begin anew")] = False
    constants: Annotated[ScalarConstants | None, Parameter("its constants")] = None
    exponentialDecay: Annotated[ExponentialDecay | None, Parameter("decay with time")] = None
    initialization: Annotated[Regions, Parameter("where it is at the start")]
    interiorSources: Annotated[Regions | None, Parameter("where it appears")] = None


class PassiveScalar(Section):
    """A scalar that the gas carries and that does not act on it."""

    material: Annotated[str, Parameter("material that carries it")] = ""
    scalar: Annotated[PassiveScalarField | None, Parameter("the scalar")] = None


class TableScalar(Section):
    """The mixture fraction of a table."""

    name: Annotated[str, Parameter("name of the scalar", attribute=True)] = ""
    material: Annotated[str, Parameter("material that carries it")] = ""
    test_conservation: Annotated[bool, Parameter("print the sum of the scalar")] = False
    doTableTest: Annotated[bool, Parameter("test the table")] = False
    constants: Annotated[ScalarConstants | None, Parameter("its constants")] = None
    geom_object: Annotated[tuple[PlainRegion, ...], Parameter("where it is at the start")] = ()


class Table(Section):
    """A table of states."""

    name: Annotated[str, Parameter("the table", choices=("adiabatic",), attribute=True)] = ""
    type: Annotated[str, Parameter("format", choices=("Arches",), attribute=True)] = ""
    defaultValue: Annotated[
        tuple[float, ...],
        Parameter("value of a variable that is not given", repeated=True, tag_attributes=("name",)),
    ] = ()
    derivedValue: Annotated[
        tuple[str, ...], Parameter("a value computed from others", repeated=True, tag_attributes=("name",))
    ] = ()
    constantValue: Annotated[
        tuple[float, ...], Parameter("a constant value", repeated=True, tag_attributes=("name",))
    ] = ()
    filename: Annotated[str, Parameter("the file")]


class AdiabaticTable(Section):
    """Properties of a mixture from a table."""

    material: Annotated[str, Parameter("material that is the mixture")]
    table: Annotated[Table | None, Parameter("the table")] = None
    varianceMax: Annotated[float, Parameter("greatest variance")] = 0.0
    varianceScale: Annotated[float, Parameter("scale of the variance")] = 0.0
    tableValue: Annotated[tuple[str, ...], Parameter("a value to output", repeated=True)] = ()
    scalar: Annotated[TableScalar | None, Parameter("the mixture fraction")] = None


class EthyleneDetonation(Section):
    """Detonation of ethylene and air."""

    material: Annotated[str, Parameter("material that burns")]
    debug: Annotated[bool, Parameter("print what is done")] = False


class ReactingRegion(PlainRegion):
    """A region with its own composition."""

    Y: Annotated[tuple[float, ...], Parameter("mass fractions of the species", ge=0.0)] = ()


class ReactingGas(Section):
    """What models of detailed chemistry share."""

    material: Annotated[str, Parameter("material that reacts")]
    doChemistry: Annotated[bool, Parameter("let it react")] = True
    doDiffusion: Annotated[bool, Parameter("let species diffuse")] = True
    debug: Annotated[bool, Parameter("print what is done")] = False
    rtol: Annotated[float, Parameter("relative tolerance of the chemistry")] = 1.0e-6
    atol_T: Annotated[float, Parameter("absolute tolerance of the temperature", unit="K")] = 1.0e-3
    atol_Y: Annotated[float, Parameter("absolute tolerance of mass fractions")] = 1.0e-12
    safety: Annotated[float, Parameter("safety factor of the chemical step")] = 0.9
    max_grow: Annotated[float, Parameter("greatest growth of the chemical step")] = 5.0
    max_shrink: Annotated[float, Parameter("greatest cut of the chemical step")] = 0.1
    geom_object: Annotated[tuple[ReactingRegion, ...], Parameter("a region with its own composition")] = ()
    initProfile: Annotated[Profile | None, Parameter("profile at the start")] = None


class HydrogenBurke(ReactingGas):
    """Combustion of hydrogen by Burke's mechanism."""

    YH2_init: Annotated[float, Parameter("mass fraction of H2 at the start", ge=0.0, le=1.0)]
    YO2_init: Annotated[float, Parameter("mass fraction of O2 at the start", ge=0.0, le=1.0)]


class Units(Section):
    """Units of the deck."""

    length: Annotated[str, Parameter("unit of length", choices=("m", "cm", "mm", "ft", "in"))] = "m"
    mass: Annotated[str, Parameter("unit of mass", choices=("kg", "g", "lbm", "slug"))] = "kg"
    time: Annotated[str, Parameter("unit of time", choices=("s", "ms", "us"))] = "s"
    temperature: Annotated[str, Parameter("unit of temperature", choices=("K", "R"))] = "K"


class GasCombustion(ReactingGas):
    """Combustion by a mechanism from a file."""

    mechanismFile: Annotated[str, Parameter("file of the mechanism")]
    closureSpecies: Annotated[str, Parameter("species that makes the sum one")]
    Y_init: Annotated[tuple[float, ...], Parameter("mass fractions at the start", ge=0.0)]
    units: Annotated[Units | None, Parameter("units of the deck")] = None


_MODELS = (
    "AdiabaticTable ConstantSources DDT0 DDT1 ethyleneDetonation gasCombustion hydrogenBurke flameSheet_rxn "
    "Gruneisen IandG JWL JWLC JWLpp LightTime mass_momentum_energy_src MesoBurn PassiveScalar Radiation "
    "Simple_Burn BinaryProperties SolidReactionModel Steady_Burn Test TracerParticles Unsteady_Burn ZeroOrder"
)


class Model(Section):
    """A model: its type, and its options in the tag of that name."""

    type: Annotated[str, Parameter("the model", choices=tuple(_MODELS.split()), attribute=True)]
    MassMomEng_src: Annotated[MassMomentumEnergySource | None, Parameter("sources of mass and energy")] = None
    ConstantSources: Annotated[
        Any, SectionOf("ups.grammar.models:ConstantSources"), Parameter("constant sources")
    ] = None
    TracerParticles: Annotated[
        Any, SectionOf("ups.grammar.models:TracerParticles"), Parameter("particles that follow the gas")
    ] = None
    Test: Annotated[TestModel | None, Parameter("conversion at a constant rate")] = None
    LightTime: Annotated[
        Any, SectionOf("ups.grammar.models:LightTime"), Parameter("detonation by arrival times")
    ] = None
    JWLpp: Annotated[JwlPlusPlus | None, Parameter("detonation by JWL++")] = None
    ZeroOrder: Annotated[JwlPlusPlus | None, Parameter("detonation at a rate of order zero")] = None
    BinaryProperties: Annotated[
        Any, SectionOf("ups.grammar.models:BinaryProperties"), Parameter("mixing of two gases")
    ] = None
    flameSheet_rxn: Annotated[FlameSheet | None, Parameter("combustion in a thin sheet")] = None
    SolidReactionModel: Annotated[SolidReaction | None, Parameter("a reaction of solids")] = None
    Simple_Burn: Annotated[SimpleBurn | None, Parameter("burning that follows the pressure")] = None
    Steady_Burn: Annotated[SteadyBurn | None, Parameter("steady burning")] = None
    Unsteady_Burn: Annotated[UnsteadyBurn | None, Parameter("unsteady burning")] = None
    DDT0: Annotated[Ddt0 | None, Parameter("deflagration to detonation")] = None
    DDT1: Annotated[Ddt1 | None, Parameter("deflagration to detonation")] = None
    IandG: Annotated[IgnitionAndGrowth | None, Parameter("ignition and growth")] = None
    PassiveScalar: Annotated[
        Any, SectionOf("ups.grammar.models:PassiveScalar"), Parameter("a scalar that is carried")
    ] = None
    AdiabaticTable: Annotated[
        Any, SectionOf("ups.grammar.models:AdiabaticTable"), Parameter("properties from a table")
    ] = None
    RadiationModel: Annotated[Opaque | None, Parameter("radiation")] = None
    ethyleneDetonation: Annotated[EthyleneDetonation | None, Parameter("detonation of ethylene")] = None
    hydrogenBurke: Annotated[HydrogenBurke | None, Parameter("combustion of hydrogen")] = None
    gasCombustion: Annotated[GasCombustion | None, Parameter("combustion by a mechanism")] = None


class Models(Section):
    """Sources, reactions and mixing of gases."""

    Model: Annotated[Any, SectionOf("ups.grammar.models:Model", many=True), Parameter("a model")] = ()
    RMCRT: Annotated[Opaque | None, Parameter("radiation by ray tracing")] = None
