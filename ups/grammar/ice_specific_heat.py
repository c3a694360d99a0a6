"""Specific heat of gases against temperature."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section, model


@model("ice_specific_heat", "Debye")
class Debye(Section):
    """Debye's law of a solid."""

    Atoms: Annotated[int, Parameter("atoms in the cell of the crystal", ge=0)]
    DebyeTemperature: Annotated[float, Parameter("Debye temperature", unit="K", ge=0.0)]


@model("ice_specific_heat", "Component")
class Components(Section):
    """A mixture of combustion products."""

    XCO2: Annotated[float, Parameter("mole fraction of CO2", ge=0.0)] = 0.0
    XCO: Annotated[float, Parameter("mole fraction of CO", ge=0.0)] = 0.0
    XH2O: Annotated[float, Parameter("mole fraction of H2O", ge=0.0)] = 0.0
    XO2: Annotated[float, Parameter("mole fraction of O2", ge=0.0)] = 0.0
    XN2: Annotated[float, Parameter("mole fraction of N2", ge=0.0)] = 0.0
    XOH: Annotated[float, Parameter("mole fraction of OH", ge=0.0)] = 0.0
    XNO: Annotated[float, Parameter("mole fraction of NO", ge=0.0)] = 0.0
    XO: Annotated[float, Parameter("mole fraction of O", ge=0.0)] = 0.0
    XH: Annotated[float, Parameter("mole fraction of H", ge=0.0)] = 0.0
    XH2: Annotated[float, Parameter("mole fraction of H2", ge=0.0)] = 0.0


@model("ice_specific_heat", "Polynomial")
class Polynomial(Section):
    """A polynomial of the temperature."""

    MaxOrder: Annotated[int, Parameter("degree", ge=0)]
    Tmin: Annotated[float, Parameter("lowest temperature of the fit", unit="K")] = 0.0
    Tmax: Annotated[float, Parameter("highest temperature of the fit", unit="K")] = 1.0e30
    coefficient: Annotated[tuple[float, ...], Parameter("coefficients, constant first")] = ()


@model("ice_specific_heat", "airNasa")
class Air(Section):
    """Air, by NASA's polynomials."""
