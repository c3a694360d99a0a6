"""A tube under internal pressure in one dimension: finite differences on rings, independent of the solver.

Lagrangian rings of equal width in plane strain carry radial, hoop and axial stress. Plasticity is J2
flow with the stress of Johnson and Cook, pressure that of Mie and Grueneisen, the scheme that of M. L.
Wilkins, Methods in Computational Physics 3 (1964) 211-263. Constants are those of
inputs/MPM/thickCylinderMPM.ups.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DENSITY, SHEAR, BULK = 7830.0, 80.0e9, 173.33e9
A, B, C, N, M = 792.0e6, 510.0e6, 0.014, 0.26, 1.03
ROOM, MELTING, START, HEAT_CAPACITY, HEAT_SHARE = 298.0, 1793.0, 300.0, 477.0, 0.9
SOUND, SLOPE, GRUNEISEN = 3574.0, 1.92, 1.69
FASTEST = 6000.0


class Tube(NamedTuple):
    """Radii at the start and displacements at the end, of the edges of the rings."""

    radius: Array
    displacement: Array


def burst(
    pressure: Callable[[float], float], end: float, inner: float = 0.5, outer: float = 1.0, rings: int = 200
) -> Tube:
    """The tube at the time ``end`` under a pressure inside that depends on time; none outside."""
    start = np.linspace(inner, outer, rings + 1)
    r, u = start.copy(), np.zeros(rings + 1)
    mass = 0.5 * DENSITY * np.diff(r**2)
    nodal_mass = 0.5 * (np.append(mass, 0.0) + np.append(0.0, mass))
    deviator, stress = np.zeros((3, rings)), np.zeros((3, rings))
    strain, energy, viscous = np.zeros(rings), np.zeros(rings), np.zeros(rings)
    temperature = np.full(rings, START)
    time = 0.0
    while time < end:
        dt = min(0.4 * np.diff(r).min() / FASTEST, end - time)
        u += dt * _force(r, stress - viscous, pressure(time)) / nodal_mass
        r += dt * u
        time += dt
        rate = np.array([np.diff(u) / np.diff(r), (u[1:] + u[:-1]) / (r[1:] + r[:-1]), np.zeros(rings)])
        dilatation = rate.sum(axis=0)
        density = mass / (0.5 * np.diff(r**2))
        trial = deviator + 2.0 * SHEAR * dt * (rate - dilatation / 3.0)
        speed = np.sqrt(2.0 / 3.0 * (rate**2).sum(axis=0))
        deviator, growth, flow = _return(trial, strain, speed, temperature)
        strain += growth
        temperature += HEAT_SHARE * flow * growth / (density * HEAT_CAPACITY)
        temperature -= dt * temperature * GRUNEISEN * DENSITY / density * dilatation
        energy += dt * (stress * rate).sum(axis=0) / density
        stress = deviator - _pressure(density, energy)
        viscous = _viscosity(density, np.diff(r), dilatation)
    return Tube(start, r - start)


def _force(r: Array, stress: Array, pressure: float) -> Array:
    """Force on the edges of rings, per radian and length: d(r sigma_r)/dr - sigma_theta."""
    middle, width = 0.5 * (r[1:] + r[:-1]), np.diff(r)
    force = np.zeros_like(r)
    force[1:] -= stress[0] * middle + 0.5 * stress[1] * width
    force[:-1] += stress[0] * middle - 0.5 * stress[1] * width
    force[0] += pressure * r[0]
    return force


def _return(trial: Array, strain: Array, rate: Array, temperature: Array) -> tuple[Array, Array, Array]:
    """Deviator on the yield surface, growth of plastic strain, and flow stress, by Newton's method."""
    size = np.sqrt(1.5 * (trial**2).sum(axis=0))
    homologous = np.clip((temperature - ROOM) / (MELTING - ROOM), 0.0, 1.0)
    speed = np.where(rate < 1.0, (1.0 + rate) ** C, 1.0 + C * np.log(np.maximum(rate, 1.0)))
    factor = speed * (1.0 - homologous**M)
    yields = size > (A + B * strain**N) * factor
    growth = np.zeros_like(strain)
    for _ in range(30):
        total = np.maximum(strain + growth, 1.0e-12)
        excess = size - 3.0 * SHEAR * growth - (A + B * total**N) * factor
        slope = 3.0 * SHEAR + B * N * total ** (N - 1.0) * factor
        growth = np.where(yields, np.maximum(growth + excess / slope, 0.0), 0.0)
    scale = 1.0 - 3.0 * SHEAR * growth / np.maximum(size, 1.0)
    return trial * scale, growth, (A + B * (strain + growth) ** N) * factor


def _pressure(density: Array, energy: Array) -> Array:
    """Pressure from the shock velocity SOUND + SLOPE times the particle velocity."""
    eta = 1.0 - DENSITY / density
    squeezed = (1.0 - 0.5 * GRUNEISEN * eta) / (1.0 - SLOPE * eta) ** 2
    cold = DENSITY * SOUND**2 * eta * np.where(eta > 0.0, squeezed, 1.0)
    return cold + DENSITY * GRUNEISEN * energy


def _viscosity(density: Array, width: Array, dilatation: Array) -> Array:
    """Von Neumann and Richtmyer's viscous pressure with Landshoff's linear term."""
    closing = np.minimum(width * dilatation, 0.0)
    return density * (2.0 * closing**2 - 0.2 * np.sqrt(BULK / density) * closing)
