"""Boundary conditions of gas dynamics, which the material point method ignores."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import Parameter, Section, SectionOf, Vector

_GAS = "gas dynamics only"
_ARCHES = "combustion only"


class Lodi(Section):
    """A face that lets waves out (locally one-dimensional inviscid relations)."""

    press_infinity: Annotated[float, Parameter("pressure far away", unit="Pa", ge=0.0)]
    sigma: Annotated[float, Parameter("strength of the pull to the pressure far away", ge=0.0, le=3.15)]
    Li_scale: Annotated[float, Parameter("scale of the incoming waves", ge=0.0, le=1.0)] = 1.0
    vel_infinity: Annotated[Vector, Parameter("velocity far away", unit="m/s")] = (0.0, 0.0, 0.0)
    rho_infinity: Annotated[float, Parameter("density far away", unit="kg/m^3", ge=0.0)] = 0.0
    material: Annotated[str, Parameter("material whose state is far away")]


class SineCondition(Section):
    """A face whose state oscillates."""

    omega: Annotated[float, Parameter("frequency", unit="1/s", ge=0.0)]
    A: Annotated[float, Parameter("amplitude")]
    reference_pressure: Annotated[float, Parameter("mean pressure", unit="Pa", ge=0.0)]
    reference_velocity: Annotated[Vector, Parameter("mean velocity", unit="m/s")]


class SlipModel(Section):
    """Order of the slip at a wall of a rarefied gas."""

    type: Annotated[
        str,
        Parameter(
            "the law",
            choices=("FirstOrder", "SecondOrder_Deissler", "SecondOrder_Karniadakis-Beskok"),
            attribute=True,
        ),
    ]


class MicroSlip(Section):
    """Slip of a rarefied gas at a wall."""

    alpha_momentum: Annotated[float, Parameter("accommodation of momentum", ge=0.0)]
    alpha_temperature: Annotated[float, Parameter("accommodation of heat", ge=0.0)]
    SlipModel: Annotated[
        Any, SectionOf("ups.grammar.boundary_conditions:SlipModel"), Parameter("the law of slip")
    ]
    CreepFlow: Annotated[bool, Parameter("let a gradient of temperature drive the slip")]


class InletVelocity(Section):
    """Profile of the velocity over a face where gas flows in."""

    type: Annotated[
        str, Parameter("form of the profile", choices=("powerLawProfile", "logLawProfile"), attribute=True)
    ]
    material: Annotated[str, Parameter("material that flows in")]
    roughness: Annotated[float, Parameter("roughness of the ground, for the log law", unit="m", ge=0.0)] = 0.0
    vonKarmanConstant: Annotated[float, Parameter("von Karman's constant", ge=0.0, le=0.5)] = 0.4
    exponent: Annotated[float, Parameter("exponent of the power law", ge=0.0)] = 0.0
    verticalDirection: Annotated[int, Parameter("axis that points up: 0, 1 or 2", ge=0, le=2)]
    maxHeight: Annotated[float, Parameter("height of the profile", unit="m")] = 0.0


class Wall(Section):
    """A wall for the particles of other methods."""

    walltype: Annotated[
        str, Parameter("kind of wall", choices=("Elastic", "Inelastic", "PartiallyElastic"), attribute=True)
    ]
    Restitution: Annotated[float, Parameter("coefficient of restitution", ge=0.0)] = 1.0


class Inlet(Section):
    """Where the particles of other methods come in."""

    ParticlesPerSecond: Annotated[float, Parameter("particles a second", unit="1/s")] = 0.0


class ParticleCondition(Section):
    """What a face does to the particles of other methods."""

    Wall: Annotated[Any, SectionOf("ups.grammar.boundary_conditions:Wall"), Parameter("a wall")] = None
    Inlet: Annotated[Any, SectionOf("ups.grammar.boundary_conditions:Inlet"), Parameter("an inlet")] = None


class BoundaryConditionsExtension(Section):
    """What the boundary conditions may hold besides faces."""

    LODI: Annotated[Lodi | None, Parameter("data of faces that let waves out", ignored=_GAS)] = None
    SINE_BC: Annotated[SineCondition | None, Parameter("data of oscillating faces", ignored=_GAS)] = None
    microSlip: Annotated[MicroSlip | None, Parameter("data of faces with slip", ignored=_GAS)] = None
    inletVelocity: Annotated[InletVelocity | None, Parameter("profile of inflow", ignored=_GAS)] = None
    DefaultMaterial: Annotated[str, Parameter("material of conditions without id", ignored=_GAS)] = ""
    InteriorFace: Annotated[
        Any,
        SectionOf("ups.deck:Face", many=True),
        Parameter("a face inside the domain", ignored=_ARCHES),
    ] = ()


class FaceExtension(Section):
    """What a face may hold besides conditions."""

    ParticleBC: Annotated[ParticleCondition | None, Parameter("what particles meet", ignored=_GAS)] = None


class BoundaryTypeExtension(Section):
    """What a condition may say besides its value."""

    ids: Annotated[str, Parameter("material indices", attribute=True, ignored=_ARCHES)] = ""
    type: Annotated[str, Parameter("kind of value", attribute=True, ignored=_ARCHES)] = ""
    inputfile: Annotated[str, Parameter("file of a turbulent inlet", ignored=_ARCHES)] = ""
    period: Annotated[int, Parameter("period of a turbulent inlet", ge=0, ignored=_ARCHES)] = 0
    timeperiod: Annotated[float, Parameter("period of a turbulent inlet", ge=0.0, ignored=_ARCHES)] = 0.0
    which_vel: Annotated[str, Parameter("velocity of a custom condition", ignored=_ARCHES)] = ""
