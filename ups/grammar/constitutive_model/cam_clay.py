"""Cam clay after Borja."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import Parameter, Section, SectionOf
from ups.grammar import known

_HERE = "ups.grammar.constitutive_model.cam_clay"


class BorjaPressure(Section):
    """Pressure against elastic strain."""

    type: Annotated[str, Parameter("the model", choices=("borja_pressure",), attribute=True)]
    p0: Annotated[float, Parameter("reference pressure, negative", unit="Pa", lt=0.0)]
    alpha: Annotated[float, Parameter("coupling of shear and pressure", ge=0.0)]
    kappatilde: Annotated[float, Parameter("slope of unloading", ge=0.0)]
    epse_v0: Annotated[float, Parameter("elastic volume strain at the reference pressure")]


class BorjaShear(BorjaPressure):
    """Shear modulus against pressure."""

    type: Annotated[str, Parameter("the model", choices=("borja_shear_modulus",), attribute=True)]
    mu0: Annotated[float, Parameter("shear modulus without pressure", unit="Pa", ge=0.0)]


class CamClayYield(Section):
    """The ellipse of Cam clay."""

    type: Annotated[str, Parameter("the model", choices=("camclay_yield_function",), attribute=True)]
    M: Annotated[float, Parameter("slope of the critical state line", ge=0.0)]


class Consolidation(Section):
    """Growth of the ellipse."""

    type: Annotated[str, Parameter("the model", choices=("borja_consolidation_pressure",), attribute=True)]
    pc0: Annotated[float, Parameter("consolidation pressure at the start, negative", unit="Pa", lt=0.0)]
    lambdatilde: Annotated[float, Parameter("slope of loading", ge=0.0)]
    kappatilde: Annotated[float, Parameter("slope of unloading", ge=0.0)]


@known("constitutive_model", "camclay")
class CamClay(Section):
    """Modified Cam clay at finite strain."""

    pressure_model: Annotated[Any, SectionOf(f"{_HERE}:BorjaPressure"), Parameter("law of the pressure")]
    elastic_shear_modulus_model: Annotated[
        Any, SectionOf(f"{_HERE}:BorjaShear"), Parameter("law of the shear")
    ]
    plastic_yield_condition: Annotated[Any, SectionOf(f"{_HERE}:CamClayYield"), Parameter("the ellipse")]
    internal_variable_model: Annotated[Any, SectionOf(f"{_HERE}:Consolidation"), Parameter("its growth")]
