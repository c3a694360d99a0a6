"""Tangent moduli of porous rock: stiffer under pressure, softer with compaction, stiffer with pore fluid.

Homel, Guilkey and Brannon, Acta Mechanica 227 (2016), and the Arenisca manual.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.dispatch import generic, inline


class Pores(NamedTuple):
    """Constants that follow from the parameters."""

    porosity: float
    """At the start: 1 - exp(-p3)."""
    matrix_bulk_modulus: float
    fluid_bulk_modulus: float
    mixture: float
    """K_f (1 - phi) + K_m phi with the porosity phi at the start."""
    unpressurized_strain: float
    """Volume strain at which the fluid's pressure is zero."""


class Moduli(NamedTuple):
    """Tangent moduli, Pa."""

    bulk: float
    shear: float


@inline
def pores_of(model: Any) -> Pores:
    """The constants of a model's pores and what fills them."""
    porosity = 1.0 - math.exp(-model.p3_crush_curve)
    matrix, fluid = model.B0 + model.B1, model.fluid_B0
    mixture = fluid * (1.0 - porosity) + matrix * porosity
    unpressurized = 0.0
    if fluid > 0.0:
        unpressurized = mixture * model.fluid_pressure_initial / (fluid * matrix)
    return Pores(porosity, matrix, fluid, mixture, unpressurized)


@inline
def is_saturated(pores: Pores, volume_strain: float) -> bool:
    """Whether there is a fluid and it is under pressure."""
    return pores.fluid_bulk_modulus != 0.0 and volume_strain <= pores.unpressurized_strain


@inline
def stiffest(model: Any) -> Moduli:
    """The limit of high pressure, by which time steps are bounded."""
    return Moduli(model.B0 + model.B1, model.G0)


@generic
def least_stiffness(model: Any) -> float:  # type: ignore[empty-body]  # bodies come from the models
    """The part of the moduli that is left to disaggregated material."""


@inline
def compaction_softening(model: Any, volume_strain: float) -> float:
    """Bulk modulus lost at a plastic volume strain, B3 exp(B4 / strain) in compression."""
    if volume_strain < 0.0:
        return float(model.B3 * math.exp(model.B4 / volume_strain))
    return 0.0


@inline
def drained_moduli(model: Any, stress_trace: float, volume_strain: float) -> Moduli:
    """Moduli of the dry skeleton at a stress and a plastic volume strain."""
    bulk, shear = model.B0, model.G0
    if volume_strain > 0.0:
        return Moduli(bulk, shear)
    if stress_trace < 0.0:
        gained = math.exp(model.B2 / stress_trace)
        bulk = bulk + model.B1 * gained
        if model.G1 != 0.0 and model.G2 != 0.0:
            poisson_ratio = model.G1 + model.G2 * gained
            shear = 1.5 * bulk * (1.0 - 2.0 * poisson_ratio) / (1.0 + poisson_ratio)
    return Moduli(bulk - compaction_softening(model, volume_strain), shear)


@inline
def saturated_bulk_modulus(model: Any, pores: Pores, volume_strain: float) -> float:
    """Gassmann's bulk modulus (1951) of a skeleton whose pores hold fluid under pressure.

    As in Uintah the compliance phi / K_m is taken off twice (Gassmann takes it off once), which is stiffer.
    """
    matrix, fluid = pores.matrix_bulk_modulus, pores.fluid_bulk_modulus
    skeleton = model.B0 - compaction_softening(model, volume_strain)
    open_part = math.exp(volume_strain * matrix / pores.mixture) * pores.porosity
    solid_part = math.exp(volume_strain * fluid / pores.mixture) * (pores.porosity - 1.0)
    porosity = open_part / (open_part - solid_part)
    biot = 1.0 - skeleton / matrix
    return skeleton + biot * biot / ((biot - porosity) / matrix + (1.0 / fluid - 1.0 / matrix) * porosity)


@inline
def moduli(model: Any, pores: Pores, stress_trace: float, volume_strain: float, crush_limit: float) -> Moduli:
    """Tangent moduli at a stress and a plastic volume strain."""
    drained = drained_moduli(model, stress_trace, volume_strain)
    bulk, shear = drained.bulk, drained.shear
    if model.Use_Disaggregation_Algorithm:
        scale = max(math.exp(-(crush_limit + volume_strain)), least_stiffness(model))
        bulk, shear = bulk * scale, shear * scale
    if is_saturated(pores, volume_strain):
        bulk = saturated_bulk_modulus(model, pores, volume_strain)
    return Moduli(bulk, shear)
