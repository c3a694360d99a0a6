"""Heat between two half spaces: the exact temperatures, and those of the grid."""

from __future__ import annotations

import math

import numpy as np

import ups

HOT, COLD = 400.0, 300.0
COPPER, STEEL = (401.0, 8960.0, 385.0), (38.0, 7830.0, 477.0)
"""Conductivity, density and specific heat."""


def effusivity(k: float, rho: float, c: float) -> float:
    return math.sqrt(k * rho * c)


def diffusivity(k: float, rho: float, c: float) -> float:
    return k / (rho * c)


E1, E2 = effusivity(*COPPER), effusivity(*STEEL)
INTERFACE = (E1 * HOT + E2 * COLD) / (E1 + E2)


def exact(x: np.ndarray, time: float) -> np.ndarray:
    """Temperature at x (copper where negative) and a time."""
    diffusion = np.where(x < 0.0, diffusivity(*COPPER), diffusivity(*STEEL))
    far = np.where(x < 0.0, HOT, COLD)
    share = np.array([math.erf(z) for z in np.abs(x) / (2.0 * np.sqrt(diffusion * time))])
    return INTERFACE + (far - INTERFACE) * share


def nodal_temperature(result: ups.Result) -> np.ndarray:
    """Temperature of the nodes on the axis of the bar at the last stored step: sum m c T / sum m c."""
    heat, capacity = np.zeros(81), np.zeros(81)
    for material, (_, _, specific_heat) in enumerate((COPPER, STEEL)):
        mass = result.series("g.mass", material)[-1][1:-1, 1, 1]
        heat += mass * specific_heat * result.series("g.temperature", material)[-1][1:-1, 1, 1]
        capacity += mass * specific_heat
    return heat / capacity
