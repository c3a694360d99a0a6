"""Convected boundary domain interpolation: a load goes to the grid from the corners of the particle's face.

The counterpart, for loads, of the convected particle domains of Sadeghirad, Brannon and Burghardt (2011): the
face deforms with the particle, so the load stays on the boundary instead of half a particle inside the body.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.declare import Vector
from solver.dispatch import inline
from solver.grid import GridIndex
from solver.jit import kernel
from solver.loads.action import Action
from solver.loads.direction import (
    Components,
    cross,
    force_for_unit_load,
    length,
    scaled,
    surface_normal,
    turned,
)
from solver.particles import Particles
from solver.tensor import Tensor, matmul, rotation, tensor_at


class Face(NamedTuple):
    """The face of a parallelepiped particle: centre, half edges, and its area over the initial area."""

    centre: Components
    half_first: Components
    half_second: Components
    area_ratio: float


class CornerLoad(NamedTuple):
    """A particle's loaded face, and the force on each of its four corners."""

    face: Face
    force: Components


@inline
def column(a: Tensor, i: int) -> Components:
    """Column 0, 1 or 2 of a tensor."""
    if i == 0:
        return Components(a.xx, a.yx, a.zx)
    if i == 1:
        return Components(a.xy, a.yy, a.zy)
    return Components(a.xz, a.yz, a.zz)


@inline
def half_edge(domain: Tensor, i: int, spacing: Vector) -> Components:
    """Half of edge 0, 1 or 2 of a particle whose edges are columns in cell units, as a length."""
    edge = column(domain, i)
    return Components(0.5 * edge.x * spacing[0], 0.5 * edge.y * spacing[1], 0.5 * edge.z * spacing[2])


@inline
def loaded_face(normal: Components, x: Components, initial: Tensor, current: Tensor, spacing: Vector) -> Face:
    """The face of a particle on the boundary: the one whose edge out of the particle best follows the normal.

    ``initial`` and ``current`` hold the particle's edges as columns in cell units. Uintah takes an edge
    within about 26 degrees of the normal and divides by zero where there is none; taking the best one gives
    the same face where Uintah has one.
    """
    best, side, chosen = -1.0, 1.0, 0
    for i in range(3):
        edge = half_edge(current, i, spacing)
        alignment = (normal.x * edge.x + normal.y * edge.y + normal.z * edge.z) / length(edge)
        if abs(alignment) > best:
            best, side, chosen = abs(alignment), (1.0 if alignment >= 0.0 else -1.0), i
    first, second = (chosen + 1) % 3, (chosen + 2) % 3
    out = scaled(half_edge(current, chosen, spacing), side)
    area = length(cross(column(current, first), column(current, second)))
    initial_area = length(cross(column(initial, first), column(initial, second)))
    return Face(
        Components(x.x + out.x, x.y + out.y, x.z + out.z),
        half_edge(current, first, spacing),
        half_edge(current, second, spacing),
        area / initial_area,
    )


@inline
def corner_load(
    law: Any, action: Action, p: int, particles: Particles, normals: Any, spacing: Vector
) -> CornerLoad:
    """The face of particle ``p`` that carries a load, and a quarter of it, scaled by the face's area."""
    x = Components(particles.position[p, 0], particles.position[p, 1], particles.position[p, 2])
    F = tensor_at(particles.deformation_gradient, p)
    initial = tensor_at(particles.size, p)
    normal = scaled(surface_normal(law, p, x, normals), 1.0 if action.outward else -1.0)
    face = loaded_face(normal, x, initial, matmul(F, initial), spacing)
    f = scaled(force_for_unit_load(law, p, x, normals), 0.25 * action.magnitude * face.area_ratio)
    if action.follow_rotation:
        f = turned(rotation(F), f)
    return CornerLoad(face, f)


@inline
def spread(grid: GridIndex, x: Components, f: Components, nodal_force: Any) -> None:
    """Share a force among the eight nodes around a point by trilinear weights; nodes not stored lose it."""
    qx = (x.x - grid.anchor[0]) / grid.spacing[0]
    qy = (x.y - grid.anchor[1]) / grid.spacing[1]
    qz = (x.z - grid.anchor[2]) / grid.spacing[2]
    for c in range(2):
        k = math.floor(qz) + c - grid.first[2]
        for b in range(2):
            j = math.floor(qy) + b - grid.first[1]
            for a in range(2):
                i = math.floor(qx) + a - grid.first[0]
                if 0 <= i < grid.nodes[0] and 0 <= j < grid.nodes[1] and 0 <= k < grid.nodes[2]:
                    weight = hat(qx, a) * hat(qy, b) * hat(qz, c)
                    node = i + grid.nodes[0] * (j + grid.nodes[1] * k)
                    nodal_force[node, 0] += f.x * weight
                    nodal_force[node, 1] += f.y * weight
                    nodal_force[node, 2] += f.z * weight


@inline
def hat(q: float, side: int) -> float:
    """The linear weight at ``q`` (in cells) of the node below (``side`` 0) or above (1)."""
    part = q - math.floor(q)
    return part if side else 1.0 - part


@kernel
def add_corner_force(law: Any, action: Action, particles: Particles, normals: Any, spacing: Vector) -> None:
    """Add to ``particles.external_force`` what a load gives to each corner of the particle's loaded face."""
    for p in range(particles.load_curve.shape[0]):
        for k in range(3):
            if particles.load_curve[p, k] == action.curve:
                f = corner_load(law, action, p, particles, normals, spacing).force
                particles.external_force[p, 0] += f.x
                particles.external_force[p, 1] += f.y
                particles.external_force[p, 2] += f.z


@kernel
def scatter_from_corners(
    law: Any, action: Action, particles: Particles, normals: Any, grid: GridIndex, nodal_force: Any
) -> None:
    """Add one load to ``nodal_force`` (N, 3): from each corner to the eight nodes around it."""
    for p in range(particles.load_curve.shape[0]):
        for k in range(3):
            if particles.load_curve[p, k] != action.curve:
                continue
            face, f = corner_load(law, action, p, particles, normals, grid.spacing)
            for a in (-1.0, 1.0):
                for b in (-1.0, 1.0):
                    corner = Components(
                        face.centre.x + a * face.half_first.x + b * face.half_second.x,
                        face.centre.y + a * face.half_first.y + b * face.half_second.y,
                        face.centre.z + a * face.half_first.z + b * face.half_second.z,
                    )
                    spread(grid, corner, f, nodal_force)
