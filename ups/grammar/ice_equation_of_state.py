"""Equations of state of gases and liquids in gas dynamics."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section, model


@model("ice_equation_of_state", "ideal_gas")
class IdealGas(Section):
    """p = (gamma - 1) rho c_v T."""

    gas_constant: Annotated[float, Parameter("gas constant", unit="J/(kg K)")] = 0.0


@model("ice_equation_of_state", "hard_sphere_gas")
class HardSphereGas(Section):
    """A gas whose molecules take space."""

    b: Annotated[float, Parameter("space the molecules take", unit="m^3/kg")] = 0.0


@model("ice_equation_of_state", "TST")
class Tst(Section):
    """Twu, Sim and Tassone's cubic equation of state."""

    a: Annotated[float, Parameter("attraction of the molecules")]
    b: Annotated[float, Parameter("space the molecules take")]
    u: Annotated[float, Parameter("first constant of the denominator")]
    w: Annotated[float, Parameter("second constant of the denominator")]
    Gamma: Annotated[float, Parameter("ratio of the specific heats")]


@model("ice_equation_of_state", "Thomsen_Hartka_water")
class ThomsenHartkaWater(Section):
    """Water after Thomsen and Hartka."""

    a: Annotated[float, Parameter("first constant of the fit")]
    b: Annotated[float, Parameter("second constant of the fit")]
    co: Annotated[float, Parameter("specific heat", unit="J/(kg K)", ge=0.0)]
    ko: Annotated[float, Parameter("compressibility", unit="1/Pa", ge=0.0)]
    To: Annotated[float, Parameter("reference temperature", unit="K", ge=0.0)]
    L: Annotated[float, Parameter("third constant of the fit", ge=0.0)]
    vo: Annotated[float, Parameter("reference specific volume", unit="m^3/kg", ge=0.0)]


@model("ice_equation_of_state", "JWL")
class Jwl(Section):
    """Detonation products after Jones, Wilkins and Lee."""

    A: Annotated[float, Parameter("first pressure coefficient", unit="Pa", ge=0.0)]
    B: Annotated[float, Parameter("second pressure coefficient", unit="Pa")]
    R1: Annotated[float, Parameter("first exponent", ge=0.0)]
    R2: Annotated[float, Parameter("second exponent", ge=0.0)]
    om: Annotated[float, Parameter("Gruneisen coefficient", ge=0.0)]
    rho0: Annotated[float, Parameter("density of the unreacted explosive", unit="kg/m^3", ge=0.0)]


@model("ice_equation_of_state", "JWLC")
class JwlC(Jwl):
    """The isentrope of Jones, Wilkins and Lee."""

    C: Annotated[float, Parameter("third pressure coefficient", unit="Pa")]


@model("ice_equation_of_state", "Murnaghan")
class Murnaghan(Section):
    """Murnaghan's equation of state."""

    n: Annotated[float, Parameter("exponent", ge=0.0)]
    K: Annotated[float, Parameter("compressibility at the reference pressure", unit="1/Pa", ge=0.0)]
    rho0: Annotated[float, Parameter("density at the reference pressure", unit="kg/m^3", ge=0.0)]
    P0: Annotated[float, Parameter("reference pressure", unit="Pa", ge=0.0)]


@model("ice_equation_of_state", "BirchMurnaghan")
class BirchMurnaghan(Section):
    """Birch and Murnaghan's equation of state."""

    n: Annotated[float, Parameter("derivative of the bulk modulus", ge=0.0)] = 0.0
    K: Annotated[float, Parameter("compressibility", unit="1/Pa", ge=0.0)] = 0.0
    rho0: Annotated[float, Parameter("density at the reference pressure", unit="kg/m^3", ge=0.0)] = 0.0
    P0: Annotated[float, Parameter("reference pressure", unit="Pa", ge=0.0)] = 0.0
    a: Annotated[float, Parameter("first thermal constant")] = 0.0
    b: Annotated[float, Parameter("second thermal constant")] = 0.0
    useSpecificHeatModel: Annotated[bool, Parameter("take the specific heat from the law below")] = False
    c0: Annotated[float, Parameter("first coefficient of the specific heat")] = 0.0
    c1: Annotated[float, Parameter("second coefficient of the specific heat")] = 0.0
    c2: Annotated[float, Parameter("third coefficient of the specific heat")] = 0.0
    c3: Annotated[float, Parameter("fourth coefficient of the specific heat")] = 0.0


@model("ice_equation_of_state", "Gruneisen")
class Gruneisen(Section):
    """Pressure linear in density and temperature."""

    A: Annotated[float, Parameter("change of pressure with density", unit="Pa", ge=0.0)]
    B: Annotated[float, Parameter("change of pressure with temperature", unit="Pa/K")]
    rho0: Annotated[float, Parameter("reference density", unit="kg/m^3", ge=0.0)]
    T0: Annotated[float, Parameter("reference temperature", unit="K", ge=0.0)]
    P0: Annotated[float, Parameter("reference pressure", unit="Pa", ge=0.0)]


@model("ice_equation_of_state", "Tillotson")
class Tillotson(Section):
    """Metals under impact after Tillotson."""

    a: Annotated[float, Parameter("first constant of the energy term")]
    b: Annotated[float, Parameter("second constant of the energy term")]
    A: Annotated[float, Parameter("linear coefficient of compression", unit="Pa", ge=0.0)]
    B: Annotated[float, Parameter("quadratic coefficient of compression", unit="Pa")]
    E0: Annotated[float, Parameter("reference energy", unit="J/kg", ge=0.0)]
    Es: Annotated[float, Parameter("energy at which vaporising begins", unit="J/kg", ge=0.0)]
    Esp: Annotated[float, Parameter("energy at which vaporising is complete", unit="J/kg", ge=0.0)]
    alpha: Annotated[float, Parameter("first decay of the expanded state", ge=0.0)]
    beta: Annotated[float, Parameter("second decay of the expanded state", ge=0.0)]
    rho0: Annotated[float, Parameter("reference density", unit="kg/m^3", ge=0.0)]


@model("ice_equation_of_state", "KnaussSeaWater")
class KnaussSeaWater(Section):
    """Sea water after Knauss."""

    a: Annotated[float, Parameter("thermal expansion", unit="kg/(m^3 K)")] = 0.0
    b: Annotated[float, Parameter("change of density with salinity")] = 0.0
    K: Annotated[float, Parameter("change of density with pressure", ge=0.0)] = 0.0
    T0: Annotated[float, Parameter("reference temperature", unit="K", ge=0.0)] = 0.0
    P0: Annotated[float, Parameter("reference pressure", unit="Pa", ge=0.0)] = 0.0
    S0: Annotated[float, Parameter("reference salinity", ge=0.0)] = 0.0
    S: Annotated[float, Parameter("salinity", ge=0.0)] = 0.0
    rho0: Annotated[float, Parameter("reference density", unit="kg/m^3", ge=0.0)] = 0.0


@model("ice_equation_of_state", "KumariDass")
class KumariDass(Section):
    """Kumari and Dass's equation of state."""

    rho0: Annotated[float, Parameter("reference density", unit="kg/m^3", ge=0.0)]
    B0: Annotated[float, Parameter("bulk modulus", unit="Pa", ge=0.0)]
    B0prime: Annotated[float, Parameter("derivative of the bulk modulus", ge=0.0)]
    decay: Annotated[float, Parameter("decay of that derivative with pressure", tag="lambda", ge=0.0)]
