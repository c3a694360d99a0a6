"""Parameters of the Arenisca models that do not go together."""

from __future__ import annotations

from typing import Any

from solver.materials.arenisca.yield_surface import limit_faults
from solver.random import weibull_law


def faults_of(model: Any) -> list[tuple[str, str]]:
    """Each fault with the field to change."""
    found = limit_faults(model)
    if (model.T1_rate_dependence == 0.0) != (model.T2_rate_dependence == 0.0):
        found.append(("T1_rate_dependence", "rate dependence needs T1 and T2 both above 0"))
    if model.Use_Disaggregation_Algorithm and model.fluid_B0 != 0.0:
        found.append(("Use_Disaggregation_Algorithm", "material with pore fluid cannot disaggregate"))
    try:
        weibull_law(model.PEAKI1IDIST)
    except ValueError as problem:
        found.append(("PEAKI1IDIST", str(problem)))
    return found
