"""The transfers between particles and grid written out as dense matrices, straight from their equations.

Every particle is weighed against every node, without any thought of speed: S is (particles, nodes) and
G (particles, nodes, 3). The kernels are held against this.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from solver.grid import Grid
from solver.particles import Particles

# ---- one direction, distances q from a node in cells -----------------------------------------------------


def hat(q: Any) -> Any:
    """The linear shape function."""
    return np.maximum(0.0, 1.0 - abs(q))


def hat_slope(q: Any) -> Any:
    """Its derivative; that of the right cell on a node."""
    return np.where((q >= -1.0) & (q < 0.0), 1.0, 0.0) - np.where((q >= 0.0) & (q < 1.0), 1.0, 0.0)


def hat_integral(q: Any) -> Any:
    """Its integral from minus infinity."""
    c = np.clip(q, -1.0, 1.0)
    return 0.5 + c - 0.5 * c * abs(c)


def averaged(q: Any, half: Any) -> Any:
    """The hat averaged over a particle of the given half width."""
    return (hat_integral(q + half) - hat_integral(q - half)) / (2.0 * half)


def averaged_slope(q: Any, half: Any) -> Any:
    """The average of the hat's slope."""
    return (hat(q + half) - hat(q - half)) / (2.0 * half)


def spline(q: Any) -> Any:
    """The quadratic B-spline: the hat averaged once more over the width of a cell."""
    return averaged(q, 0.5)


def spline_slope(q: Any) -> Any:
    """Its derivative."""
    return averaged_slope(q, 0.5)


# ---- three directions ------------------------------------------------------------------------------------


def offsets(grid: Grid, positions: Any) -> Any:
    """Distances (particles, nodes, 3) from nodes to positions in cells."""
    return (positions[:, None, :] - grid.node_positions()[None, :, :]) / np.array(grid.spacing)


def product(values: Any, slopes: Any, grid: Grid) -> tuple[Any, Any]:
    """S and G of the product of one-dimensional values and slopes, both (particles, nodes, 3)."""
    x, y, z = np.moveaxis(values, -1, 0)
    dx, dy, dz = np.moveaxis(slopes, -1, 0)
    G = np.stack([dx * y * z, x * dy * z, x * y * dz], axis=-1)
    return x * y * z, G / np.array(grid.spacing)


def linear(grid: Grid, positions: Any, *_: Any) -> tuple[Any, Any]:
    """Particles are points."""
    q = offsets(grid, positions)
    return product(hat(q), hat_slope(q), grid)


def gimp(grid: Grid, positions: Any, size: Any, *_: Any) -> tuple[Any, Any]:
    """Particles are boxes."""
    q, half = offsets(grid, positions), 0.5 * np.diagonal(size, axis1=1, axis2=2)[:, None, :]
    return product(averaged(q, half), averaged_slope(q, half), grid)


def bspline(grid: Grid, positions: Any, *_: Any) -> tuple[Any, Any]:
    """Particles are points in smooth functions."""
    q = offsets(grid, positions)
    return product(spline(q), spline_slope(q), grid)


def cpdi(grid: Grid, positions: Any, size: Any, F: Any) -> tuple[Any, Any]:
    """Particles are parallelepipeds: S is the mean of their corners' S.

    G is the mean over the particle of the gradient of the function that is trilinear in its own coordinates
    and takes the corners' values: the sum over corners of S_corner s / 4 . R^-1, s the signs of the corner.
    """
    edges = F @ size * np.array(grid.spacing)[:, None]
    S = np.zeros((len(positions), grid.number_of_nodes))
    G = np.zeros((*S.shape, 3))
    for signs in np.ndindex(2, 2, 2):
        s = 2.0 * np.array(signs) - 1.0
        corner, _ = linear(grid, positions + 0.5 * edges @ s)
        S += corner / 8.0
        G += corner[..., None] * (s @ np.linalg.inv(edges) / 4.0)[:, None, :]
    return S, G


def cpti(grid: Grid, positions: Any, size: Any, F: Any) -> tuple[Any, Any]:
    """Particles are tetrahedra: the function linear in each takes the corners' values."""
    edges = F @ size * np.array(grid.spacing)[:, None]
    inverse = np.linalg.inv(edges)
    first = positions - edges.sum(axis=2) / 4.0
    corners = [(first, -inverse.sum(axis=1))] + [(first + edges[..., k], inverse[:, k, :]) for k in range(3)]
    S = np.zeros((len(positions), grid.number_of_nodes))
    G = np.zeros((*S.shape, 3))
    for corner, slope in corners:
        value, _ = linear(grid, corner)
        S += value / 4.0
        G += value[..., None] * slope[:, None, :]
    return S, G


# ---- bodies of revolution: x is the radius, y the axis; the two layers of nodes share alike --------------


def revolved(radial: tuple[Any, Any, Any, Any], axial: tuple[Any, Any], grid: Grid) -> tuple[Any, Any]:
    """S and (dS/dr, dS/dz, S/r) from radial (S, S that goes with dS/dz, slope, S/r) and axial (S, slope)."""
    w, v, slope, hoop = radial
    layers = (grid.node_positions()[:, 2] >= 0) & (grid.node_positions()[:, 2] <= grid.spacing[2] * 1.5)
    share = 0.5 * layers[None, :]
    y, dy = axial
    G = np.stack([slope * y / grid.spacing[0], v * dy / grid.spacing[1], hoop * y], axis=-1)
    return w * y * share, G * share[..., None]


def linear_axisymmetric(grid: Grid, positions: Any, *_: Any) -> tuple[Any, Any]:
    """Particles are rings of no thickness."""
    q = offsets(grid, positions)
    w = hat(q[..., 0])
    radial = (w, w, hat_slope(q[..., 0]), w / positions[:, :1])
    return revolved(radial, (hat(q[..., 1]), hat_slope(q[..., 1])), grid)


def radius_weighted(function: Callable[[Any], Any], grid: Grid, r: float, half: float, power: int) -> Any:
    """The integral of function(q) r^power over a ring beyond the axis, over that of r, at each node."""
    nodes = grid.node_positions()[:, 0]
    h = grid.spacing[0]
    low, high = max(0.0, r - half * h), r + half * h
    knots = np.unique([*np.clip(nodes, low, high), low, high])
    points, weights = np.polynomial.legendre.leggauss(4)
    total, area = np.zeros(len(nodes)), 0.0
    for a, b in pairwise(knots):
        x, w = 0.5 * (a + b) + 0.5 * (b - a) * points, 0.5 * (b - a) * weights
        total += function((x[None, :] - nodes[:, None]) / h) * x**power @ w
        area += x @ w
    return total / area


def gimp_axisymmetric(grid: Grid, positions: Any, size: Any, *_: Any) -> tuple[Any, Any]:
    """Particles are rings of rectangular section; averages are over their volume."""
    half = 0.5 * size[:, 0, 0]
    rows = list(zip(positions[:, 0], half, strict=True))
    w, slope, hoop = (
        np.array([radius_weighted(f, grid, r, b, power) for r, b in rows])
        for f, power in ((hat, 1), (hat_slope, 1), (hat, 0))
    )
    q, half_y = offsets(grid, positions)[..., 1], 0.5 * size[:, 1, 1][:, None]
    return revolved((w, w, slope, hoop), (averaged(q, half_y), averaged_slope(q, half_y)), grid)


# ---- the step --------------------------------------------------------------------------------------------


def to_grid(
    particles: Particles, S: Any, G: Any, axisymmetric: bool, conductivity: float, specific_heat: float
) -> dict[str, Any]:
    """Nodal sums: mass, momentum, volume, forces, mass times temperature, heat rate over specific heat."""
    m, V = particles.mass, particles.volume
    s = V[:, None, None] * (particles.stress - particles.artificial_pressure[:, None, None] * np.eye(3))
    if axisymmetric:
        radial = np.einsum("pnj,pj->n", G, np.stack([s[:, 0, 0], s[:, 0, 1], s[:, 2, 2]], axis=1))
        axial = np.einsum("pnj,pj->n", G[..., :2], s[:, :2, 1])
        internal = -np.stack([radial, axial, 0.0 * axial], axis=1)
    else:
        internal = -np.einsum("pni,pij->nj", G, s)
    gradient = particles.temperature_gradient * (1.0, 1.0, 0.0 if axisymmetric else 1.0)
    heat = S.T @ particles.external_heat_rate - conductivity * np.einsum("p,pni,pi->n", V, G, gradient)
    return {
        "mass": S.T @ m,
        "momentum": S.T @ (m[:, None] * particles.velocity),
        "volume": S.T @ V,
        "internal_force": internal,
        "external_force": S.T @ particles.external_force,
        "heat_content": S.T @ (m * particles.temperature),
        "heat": heat / specific_heat,
    }


def enhanced(particles: Particles, S: Any, grid: Grid) -> tuple[Any, Any]:
    """Momentum and mass times temperature, both projected with the particles' gradients."""
    r = particles.position[:, None, :] - grid.node_positions()[None, :, :]
    v = particles.velocity[:, None, :] - np.einsum("pij,pnj->pni", particles.velocity_gradient, r)
    T = particles.temperature[:, None] - np.einsum("pj,pnj->pn", particles.temperature_gradient, r)
    mS = particles.mass[:, None] * S
    return np.einsum("pn,pni->ni", mS, v), (mS * T).sum(axis=0)


def velocity_gradient(velocity: Any, G: Any, axisymmetric: bool) -> Any:
    """L of each particle; with axial symmetry L_33 is v_r / r."""
    if not axisymmetric:
        return np.einsum("ni,pnj->pij", velocity, G)
    L = np.zeros((len(G), 3, 3))
    L[:, :2, :2] = np.einsum("ni,pnj->pij", velocity[:, :2], G[..., :2])
    L[:, 2, 2] = G[..., 2] @ velocity[:, 0]
    return L


def flip(particles: Particles, S: Any, velocity_star: Any, acceleration: Any, dt: float) -> tuple[Any, Any]:
    """New positions and velocities."""
    return particles.position + dt * S @ velocity_star, particles.velocity + dt * S @ acceleration


def xpic2(
    particles: Particles, S: Any, velocity: Any, velocity_star: Any, acceleration: Any, dt: float
) -> tuple[Any, Any]:
    """New positions and velocities by the filter of order two, Hammerquist and Nairn (2017)."""
    mass = S.T @ particles.mass
    to_nodes = np.divide(S.T * particles.mass, mass[:, None], out=np.zeros_like(S.T), where=mass[:, None] > 0)
    once = S @ velocity
    twice = S @ to_nodes @ once
    a = S @ acceleration
    v = 2.0 * once - twice + dt * a
    x = (
        particles.position
        + dt * S @ velocity_star
        - 0.5 * dt * (dt * a + particles.velocity - 2.0 * once + twice)
    )
    return x, v
