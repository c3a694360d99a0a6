"""Checks of material stability: whether deformation of a plastic particle localizes."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.declare import family
from solver.dispatch import generic, inline
from solver.tensor import Tensor, double_dot, isotropic, trace

STABILITY = family(
    "stability",
    tag="stability_check",
    package="solver.materials.stability",
    key="@type",
    meaning="when deformation of a plastic particle localizes",
)


class TangentModulus(NamedTuple):
    """Elastic-plastic tangent of an isotropic material, C_ep = C - a (x) a / b.

    C is the elastic stiffness, a = C : n with the normal n of the yield surface, b = n : C : n - h with the
    hardening term h.
    """

    bulk_modulus: float
    shear_modulus: float
    direction: Tensor
    """a, Pa times the unit of the normal."""
    resistance: float
    """b."""


@inline
def elastic_stress(bulk_modulus: float, shear_modulus: float, strain: Tensor) -> Tensor:
    """Isotropic elasticity C : strain for a symmetric strain."""
    volumetric = (bulk_modulus - 2.0 / 3.0 * shear_modulus) * trace(strain)
    return 2.0 * shear_modulus * strain + isotropic(volumetric)


@inline
def tangent_modulus(
    bulk_modulus: float, shear_modulus: float, normal: Tensor, hardening: float
) -> TangentModulus:
    """Tangent of a material with the given normal of the yield surface and hardening term."""
    direction = elastic_stress(bulk_modulus, shear_modulus, normal)
    return TangentModulus(bulk_modulus, shear_modulus, direction, double_dot(normal, direction) - hardening)


@generic
def localizes(check: Any, stress: Tensor, rate: Tensor, tangent: TangentModulus) -> bool:
    """Whether deformation at this stress and rate of deformation localizes."""
    raise NotImplementedError


@generic
def is_checked(check: Any) -> bool:
    """Whether there is anything to check."""
    raise NotImplementedError
