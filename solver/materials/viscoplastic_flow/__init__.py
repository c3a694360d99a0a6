"""Unified viscoplastic flow: inelastic strain from an overstress, with hardening by internal stresses."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.declare import family
from solver.dispatch import generic, inline
from solver.tensor import Tensor, isotropic, trace

VISCOPLASTIC_FLOW = family(
    "viscoplastic_flow",
    tag="visco_plasticity_model",
    package="solver.materials.viscoplastic_flow",
    key="@type",
    meaning="rate of inelastic strain over stress, and how the material hardens",
)


class Hardening(NamedTuple):
    """Internal stresses of a particle."""

    yield_stress: float
    drag_stress: float
    back_stress: Tensor


class Elasticity(NamedTuple):
    """Moduli of the step."""

    bulk_modulus: float
    shear_modulus: float


@inline
def stiffness_of(elasticity: Elasticity, a: Tensor) -> Tensor:
    """C:a for isotropic elasticity."""
    G = elasticity.shear_modulus
    return isotropic((elasticity.bulk_modulus - 2.0 / 3.0 * G) * trace(a)) + 2.0 * G * a


class FlowStep(NamedTuple):
    """What a flow law answers."""

    rate: float
    """Equivalent rate of the inelastic strain, 1/s."""
    direction: Tensor
    """The rate of the inelastic strain for a unit of ``rate``."""
    hardening: Hardening
    """At the end of the step."""


@generic
def initial_hardening(model: Any) -> Hardening:  # type: ignore[empty-body]  # bodies come from the models
    """Internal stresses of undeformed material."""


@generic
def overstress(  # type: ignore[empty-body]  # bodies come from the models
    model: Any, hardening: Hardening, stress: Tensor
) -> float:
    """Equivalent stress beyond the yield stress; the material flows where it is positive."""


@generic
def flow(  # type: ignore[empty-body]  # bodies come from the models
    model: Any, hardening: Hardening, stress: Tensor, rate: Tensor, elasticity: Elasticity, dt: float
) -> FlowStep:
    """Inelastic strain and hardening in a step of material that flows, deformed at ``rate``."""
