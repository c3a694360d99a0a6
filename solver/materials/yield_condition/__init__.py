"""Yield conditions: the surface in stress space on which an elastic-plastic material flows."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.declare import family
from solver.dispatch import generic
from solver.tensor import Tensor

YIELD_CONDITION = family(
    "yield_condition",
    tag="yield_condition",
    package="solver.materials.yield_condition",
    key="@type",
    meaning="surface in stress space on which the material flows",
)


class YieldValue(NamedTuple):
    """Where a stress lies."""

    function: float
    """Negative inside the yield surface, Pa^2."""
    strength: float
    """Equivalent stress of the yield surface at this mean stress and porosity, Pa."""


@generic
def yield_value(
    condition: Any, equivalent_stress: float, stress_trace: float, flow_stress: float, porosity: float
) -> YieldValue:
    """Yield function at a stress; ``equivalent_stress`` is sqrt(3/2) |s|."""
    raise NotImplementedError


@generic
def yield_normal(condition: Any, stress: Tensor, flow_stress: float, porosity: float) -> Tensor:
    """Derivative of the yield function by the stress."""
    raise NotImplementedError


@generic
def hardening_term(
    condition: Any,
    stress: Tensor,
    normal: Tensor,
    flow_stress: float,
    slope: float,
    porosity: float,
    nucleation: float,
) -> float:
    """Rate of the yield function by its internal variables, for a unit plastic multiplier.

    ``slope`` is the derivative of the flow stress by plastic strain, ``nucleation`` the porosity that a unit
    of plastic strain nucleates, ``normal`` the answer of :func:`yield_normal`.
    """
    raise NotImplementedError
