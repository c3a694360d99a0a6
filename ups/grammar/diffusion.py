"""Diffusion of a scalar between particles: models and interfaces of Uintah that are not run."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section


class ConductivityEquation(Section):
    """Electrical conductivity against concentration."""

    type: Annotated[str, Parameter("form of the law", choices=("fixed", "binary"), attribute=True)]
    min_conc: Annotated[float, Parameter("concentration of the lower conductivity")] = 0.0
    max_conc: Annotated[float, Parameter("concentration of the upper conductivity")] = 1.0
    conductivity: Annotated[float, Parameter("conductivity of the fixed law", unit="S/m")] = 0.0
    min_conductivity: Annotated[float, Parameter("lower conductivity", unit="S/m")] = 0.0
    max_conductivity: Annotated[float, Parameter("upper conductivity", unit="S/m")] = 0.0


class FluxTime(Section):
    """From when on the flux has a direction."""

    time: Annotated[float, Parameter("time of the change", unit="s")]
    flux_direction: Annotated[
        str, Parameter("direction of the flux from then on", choices=("in", "out", "transition"))
    ]


class FluxCurve(Section):
    """Direction of the flux against time."""

    time_point: Annotated[tuple[FluxTime, ...], Parameter("a change of direction")] = ()


class DiffusionModel(Section):
    """How a concentration spreads in a material."""

    type: Annotated[
        str,
        Parameter(
            "form of the law",
            choices=("jg", "rf1", "non_linear1", "non_linear2", "constant_rate"),
            attribute=True,
        ),
    ]
    diffusivity: Annotated[float, Parameter("diffusion coefficient", unit="m^2/s")] = 0.0
    max_concentration: Annotated[float, Parameter("concentration at saturation")] = 0.0
    initial_concentration: Annotated[float, Parameter("concentration at the start")] = 0.0
    init_conc: Annotated[float, Parameter("concentration at the start")] = 0.0
    boltzmann_const: Annotated[float, Parameter("Boltzmann's constant", unit="J/K")] = 0.0
    operating_temp: Annotated[float, Parameter("temperature of the process", unit="K")] = 0.0
    partial_atomic_vol: Annotated[float, Parameter("volume of a diffusing atom", unit="m^3")] = 0.0
    unit_charge: Annotated[float, Parameter("charge of a diffusing ion", unit="C")] = 0.0
    tuning1: Annotated[float, Parameter("first coefficient of a non-linear law")] = 0.0
    tuning2: Annotated[float, Parameter("second coefficient of a non-linear law")] = 0.0
    tuning3: Annotated[float, Parameter("third coefficient of a non-linear law")] = 0.0
    tuning4: Annotated[float, Parameter("fourth coefficient of a non-linear law")] = 0.0
    tuning5: Annotated[float, Parameter("fifth coefficient of a non-linear law")] = 0.0
    ramp_time: Annotated[float, Parameter("time in which the flux grows to its value", unit="s")] = 0.0
    use_pressure: Annotated[bool, Parameter("let pressure drive the flux")] = False
    diff_curve: Annotated[FluxCurve | None, Parameter("direction of the flux against time")] = None
    constant_rate: Annotated[float, Parameter("rate of the constant_rate law", unit="1/s")] = 0.0
    conductivity_equation: Annotated[
        ConductivityEquation | None, Parameter("conductivity against concentration")
    ] = None


class DiffusionInterface(Section):
    """How a concentration passes from material to material."""

    type: Annotated[str, Parameter("kind of interface", choices=("null", "common", "paired"))]
    materials: Annotated[tuple[int, ...], Parameter("indices of the materials", ge=0)] = ()
