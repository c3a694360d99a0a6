"""The parameters that the laws of diffusion share, each declared once."""

from __future__ import annotations

from typing import Annotated, Any, TypeAlias

from solver.declare import Parameter, SectionOf

Diffusivity: TypeAlias = Annotated[float, Parameter("diffusion coefficient", unit="m^2/s", ge=0.0)]
MaxConcentration: TypeAlias = Annotated[float, Parameter("concentration at saturation, not exceeded")]
MinConcentration: TypeAlias = Annotated[float, Parameter("least concentration")]
Tolerance: TypeAlias = Annotated[
    float,
    Parameter("how far from these two the concentration stops", tag="conc_tolerance", ge=0.0),
]
InitialConcentration: TypeAlias = Annotated[
    float,
    Parameter(
        "concentration at the start",
        old_tags=("init_conc",),
        ignored="each geom_object gives its own <concentration>",
    ),
]
Conductivity: TypeAlias = Annotated[
    Any,
    SectionOf("ups.grammar.diffusion:ConductivityEquation"),
    Parameter("electrical conductivity", ignored="nothing conducts electricity here"),
]
