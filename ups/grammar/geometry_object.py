"""Tags of ``<geom_object>`` that other methods of Uintah read."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section, Vector

_SCALAR = "initial values of a scalar in a gas"
_CHARGE = "electrostatics only"


class GeometryObjectExtension(Section):
    """What a body may say besides what the material point method reads."""

    scalar: Annotated[float, Parameter("value of the scalar in the body", ignored=_SCALAR)] = 0.0
    coeff: Annotated[Vector, Parameter("coefficients of the initial profile", ignored=_SCALAR)] = (
        0.0,
        0.0,
        0.0,
    )
    freq: Annotated[Vector, Parameter("waves of the initial profile", ignored=_SCALAR)] = (0.0, 0.0, 0.0)
    slope: Annotated[Vector, Parameter("slope of the initial profile", ignored=_SCALAR)] = (0.0, 0.0, 0.0)
    maxScalar: Annotated[float, Parameter("greatest value of the scalar", ignored=_SCALAR)] = 0.0
    rateOfChange: Annotated[float, Parameter("source of the scalar", unit="1/s", ignored=_SCALAR)] = 0.0
    linearInitialize: Annotated[bool, Parameter("a linear profile", ignored=_SCALAR)] = False
    sinusoidalInitialize: Annotated[bool, Parameter("a wave as profile", ignored=_SCALAR)] = False
    triangularInitialize: Annotated[bool, Parameter("a triangular profile", ignored=_SCALAR)] = False
    quadraticInitialize: Annotated[bool, Parameter("a parabola as profile", ignored=_SCALAR)] = False
    cubicInitialize: Annotated[bool, Parameter("a cubic profile", ignored=_SCALAR)] = False
    exponentialInitialize_1D: Annotated[bool, Parameter("a Gaussian profile along x", ignored=_SCALAR)] = (
        False
    )
    exponentialInitialize_2D: Annotated[bool, Parameter("a Gaussian profile in x, y", ignored=_SCALAR)] = (
        False
    )
    conductivity: Annotated[float, Parameter("electrical conductivity", unit="S/m", ignored=_CHARGE)] = 0.0
    permittivity: Annotated[float, Parameter("permittivity", unit="F/m", ignored=_CHARGE)] = 0.0
    pos_charge_density: Annotated[float, Parameter("positive charges", unit="C/m^3", ignored=_CHARGE)] = 0.0
    neg_charge_density: Annotated[float, Parameter("negative charges", unit="C/m^3", ignored=_CHARGE)] = 0.0
