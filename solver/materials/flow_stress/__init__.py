"""Flow stress of metals and polymers as a function of plastic strain, rate and temperature."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.declare import family
from solver.dispatch import generic, generic_with_default, lanewise
from solver.materials.plasticity_state import PlasticityState

FLOW_STRESS = family(
    "flow_stress",
    tag="flow_model",
    package="solver.materials.flow_stress",
    key="@type",
    meaning="flow stress as a function of plastic strain, rate and temperature",
    old_tags=("plasticity_model",),
)


@generic
def flow_stress(model: Any, state: PlasticityState) -> float:
    """Stress at which the material flows in uniaxial loading."""
    raise NotImplementedError


@generic
def hardening_slope(model: Any, state: PlasticityState) -> float:
    """Derivative of the flow stress by the plastic strain."""
    raise NotImplementedError


@generic
def rate_slope(model: Any, state: PlasticityState) -> float:
    """Derivative of the flow stress by the strain rate, as the Newton iteration of the return uses it."""
    raise NotImplementedError


@generic_with_default
@lanewise
def in_step(model: Any, state: PlasticityState) -> Any:
    """The model for one particle in one step, in which only plastic strain and its rate are still to be found.

    A model whose factors of temperature and total rate are costly gives a record that holds them, with its own
    ``flow_stress``, ``hardening_slope`` and ``rate_slope``; others are used as they are.
    """
    return model


class Response(NamedTuple):
    """Flow stress and its derivatives at one state."""

    flow_stress: float
    hardening_slope: float
    rate_slope: float


@generic_with_default
@lanewise
def response(model: Any, state: PlasticityState) -> Response:
    """Flow stress and both derivatives; models to which they have much in common find that once."""
    return Response(flow_stress(model, state), hardening_slope(model, state), rate_slope(model, state))
