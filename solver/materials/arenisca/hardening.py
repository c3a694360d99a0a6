"""How compaction moves the cap, and pore fluid the whole yield surface.

The crush curve is that of Fossum and Brannon (Sandia report SAND2004-3226) with p2 = 0, continued into
dilatation; the fluid is that of Homel, Guilkey and Brannon (Acta Mechanica 227, 2016).
"""

from __future__ import annotations

import math
from typing import Any

from solver.dispatch import inline
from solver.materials.arenisca.elasticity import Pores, compaction_softening, is_saturated, moduli

CLOSED = 1.0e12
"""Without pores the cap lies at this times p0: out of reach."""


@inline
def cap_position(model: Any, pores: Pores, volume_strain: float, crush_limit: float) -> float:
    """X, the value of I1 - zeta at which the cap meets the hydrostat, at a plastic volume strain."""
    p0, p1 = model.p0_crush_curve, model.p1_crush_curve
    if volume_strain <= -crush_limit:
        return CLOSED * p0
    if volume_strain <= 0.0:
        cap = (p0 * p1 + math.log((volume_strain + crush_limit) / crush_limit)) / p1
    else:
        cap = p0 * (1.0 + volume_strain) ** (1.0 / (p0 * p1 * crush_limit))
    if is_saturated(pores, volume_strain):
        # The elastic strain to yield is that of the dry rock; the fluid takes more stress to reach it.
        dry = (
            model.B0 + model.B1 * math.exp(2.0 * model.B2 / cap) - compaction_softening(model, volume_strain)
        )
        cap = cap * moduli(model, pores, 0.5 * cap, volume_strain, crush_limit).bulk / dry
    return cap


@inline
def back_stress_slope(model: Any, pores: Pores, zeta: float, volume_strain: float) -> float:
    """d(zeta)/d(plastic volume strain), the change of the trace of the back stress by the pore fluid."""
    if not is_saturated(pores, volume_strain):
        return 0.0
    matrix, fluid = pores.matrix_bulk_modulus, pores.fluid_bulk_modulus
    stretch = math.exp(volume_strain)
    solid = math.exp(zeta / (3.0 * matrix)) * matrix * (pores.porosity - 1.0)
    liquid = math.exp((3.0 * model.fluid_pressure_initial + zeta) / (3.0 * fluid)) * fluid * pores.porosity
    return (3.0 * stretch * fluid * matrix) / (stretch * (fluid + matrix) + solid - liquid)


@inline
def pore_pressure(model: Any, pores: Pores, volume_strain: float) -> float:
    """Pressure of the pore fluid at a total volume strain; it is only reported."""
    if not is_saturated(pores, volume_strain):
        return 0.0
    matrix, fluid = pores.matrix_bulk_modulus, pores.fluid_bulk_modulus
    solid = math.exp(volume_strain * fluid / pores.mixture) * (1.0 - pores.porosity)
    liquid = math.exp(volume_strain * matrix / pores.mixture) * pores.porosity
    closure = math.exp(volume_strain * (-1.0 - matrix / pores.mixture))
    return float(model.fluid_pressure_initial + fluid * math.log(closure * (solid + liquid)))
