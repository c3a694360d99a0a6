"""Lithium in a film with a flux through one face, and the stress of a film that is held in its plane."""

from __future__ import annotations

from typing import Any

import numpy as np

THICKNESS, FLUX, DIFFUSIVITY, EXPANSION = 1.0e-7, 3.0e-11, 1.0e-16, 0.26
BULK, SHEAR = 48.0e9, 33.0e9
YOUNG = 9.0 * BULK * SHEAR / (3.0 * BULK + SHEAR)
POISSON = (3.0 * BULK - 2.0 * SHEAR) / (2.0 * (3.0 * BULK + SHEAR))


def concentration(x: Any, time: float) -> Any:
    """Carslaw and Jaeger (1959), section 3.8, at depths x from the base."""
    L, n = THICKNESS, np.arange(1, 60)[:, None]
    waves = (
        (-1.0) ** n / n**2 * np.exp(-DIFFUSIVITY * (n * np.pi / L) ** 2 * time) * np.cos(n * np.pi * x / L)
    )
    steady = (3.0 * np.asarray(x) ** 2 - L**2) / (6.0 * L**2)
    return FLUX * time / L + FLUX * L / DIFFUSIVITY * (steady - 2.0 / np.pi**2 * waves.sum(axis=0))


def stress_in_plane(c: Any) -> Any:
    """Of a film that cannot spread, -E beta c / (1 - nu)."""
    return -YOUNG * EXPANSION * np.asarray(c) / (1.0 - POISSON)


def displacement(x: float, time: float) -> float:
    """Of a depth x: beta (1 + nu) / (1 - nu) times the lithium below it."""
    depths = np.linspace(0.0, x, 2001)
    return float(
        EXPANSION * (1.0 + POISSON) / (1.0 - POISSON) * np.trapezoid(concentration(depths, time), depths)
    )
