"""Laws of diffusion of Uintah that this program does not run, and what all laws may say besides."""

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
