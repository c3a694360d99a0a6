"""Exchange of momentum and heat between the materials of gas dynamics."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section

_LAWS = ("constant", "linearVariation")


class ExchangeCoefficients(Section):
    """Coefficients for the pairs of materials: 0-1, 0-2, 1-2 and so on."""

    momentum: Annotated[tuple[float, ...], Parameter("exchange of momentum, for each pair", ge=0.0)]
    heat: Annotated[tuple[float, ...], Parameter("exchange of heat, for each pair", ge=0.0)] = ()


class CoefficientModel(Section):
    """How the coefficients depend on the volume fractions."""

    momentum: Annotated[str, Parameter("law for momentum", choices=_LAWS)] = "constant"
    heat: Annotated[str, Parameter("law for heat", choices=_LAWS)] = "constant"


class SlipExchange(Section):
    """Exchange with slip at the surface of a solid."""

    type: Annotated[str, Parameter("the model", choices=("slip",), attribute=True)]
    solidMatlIndex: Annotated[int, Parameter("index of the solid", ge=0)]
    fluidMatlIndex: Annotated[int, Parameter("index of the gas", ge=0)]
    momentum_accommodation_coeff: Annotated[float, Parameter("accommodation of momentum")]
    thermal_accommodation_coeff: Annotated[float, Parameter("accommodation of heat")]
    useSlipCoeffs: Annotated[bool, Parameter("use the coefficients of slip")] = True


class ExchangeProperties(Section):
    """What the materials exchange."""

    exchange_coefficients: Annotated[
        ExchangeCoefficients, Parameter("coefficients for the pairs of materials")
    ]
    CoefficientModel: Annotated[CoefficientModel | None, Parameter("law of the coefficients")] = None
    Model: Annotated[SlipExchange | None, Parameter("exchange with slip")] = None
    do_convective_heat_transfer: Annotated[bool, Parameter("heat a solid by convection")] = False
    convective_fluid: Annotated[int, Parameter("index of the gas that heats")] = 0
    convective_solid: Annotated[int, Parameter("index of the solid that is heated")] = 0
