"""Surface normals and tractions at the nodes, from the gradient of each material's mass."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from solver.contact.law import Array, ContactScene
from solver.contact.particle_shapes import ParticleShapes, particle_shapes, shape_of
from solver.contact.vectors import dot, length, minus, over, plus, put_vector, times, vector_at
from solver.declare import Vector
from solver.deferred import deferred_kernel
from solver.dispatch import inline
from solver.grid import GridIndex
from solver.interpolation.shape import MOST_NODES, particle_domain, reach
from solver.nodal import EMPTY_MASS
from solver.particles import Particles
from solver.scratch import scratch_numbers, scratch_rows
from solver.tensor import tensor_at

SHORTEST = 1.0e-15
"""A mass gradient that is not longer has no direction; it stays as it is."""

LEAST_MASS = 1.0e-100
"""Keeps the mean over the other materials finite where there are none."""


class SurfaceFields(NamedTuple):
    """How surfaces pass the nodes that two or more materials share, first axis the material; else zeros."""

    normal: Array
    """(M, N, 3) unit vectors out of the body; 0 where there is none."""
    position: Array
    """(M, N, 3) mean position of the particles, weighted with mass and shape function."""
    traction: Array
    """(M, N) n . sigma . n with sigma the sum of S times the particles' stresses; negative in compression."""


def surface_fields(scene: ContactScene) -> SurfaceFields:
    """Normals, mean positions and normal tractions of all materials; use it with ``scene.once``.

    The normal has the direction of sum_p m_p grad S_ip, which points from the particles to the node. With
    colinear normals it is the mean of that and of the opposite of the other materials' (weighted with nodal
    mass), so that two bodies in touch have opposite normals. In axial symmetry the weights are m_p / V_p and
    the gradients, as in Uintah, those with respect to cell coordinates: where the cells are not square the
    normal leans towards their long side.
    """
    nodal, new = scene.nodal, scene.workspace.zeros
    materials, count = nodal.mass.shape
    fields = SurfaceFields(
        new("surface normals", materials, float, count, 3),
        new("surface positions", materials, float, count, 3),
        new("surface tractions", materials, float, count),
    )
    stress = new("stress at surfaces", materials, float, count, 6)
    spacing = scene.grid.spacing
    scale = (spacing[0], spacing[1], 0.0) if scene.axisymmetric else (1.0, 1.0, 1.0)
    shared = scene.once(shared_nodes)
    wanted = new("shared", count, np.uint8)
    wanted[shared] = 1
    near = new("near shared", count, np.bool_)
    scene.call(mark_cells_near, scene.grid.index, shared, near)
    for m, particles in enumerate(scene.particles):
        scene.call(
            add_particles,
            particle_shapes(scene, m),
            wanted,
            near,
            particles.mass,
            _density(scene, particles) if scene.axisymmetric else particles.mass,
            scale,
            particles.stress,
            fields.normal[m],
            fields.position[m],
            stress[m],
        )
    on_their_way = [
        scene.exchange.add(fields.normal[m], fields.position[m], stress[m]) for m in range(materials)
    ]
    for complete in on_their_way:
        complete()
    if scene.colinear_normals:
        averaged = scene.workspace.rows("normals of a node", materials, float, 3)
        scene.call(make_colinear, shared, fields.normal, nodal.mass, averaged)
    for m in range(materials):
        scene.boundary_conditions.apply_symmetry(fields.normal[m], m, wanted)
    scene.call(finish, shared, fields, nodal.mass, stress)
    return fields


def shared_nodes(scene: ContactScene) -> Array:
    """The nodes that two or more materials have mass at, in order; use it with ``scene.once``."""
    shared = scene.list_of_nodes("shared nodes")
    return shared[: scene.call(list_shared, scene.nodal.mass, shared)]


def _density(scene: ContactScene, particles: Particles) -> Array:
    density = scene.workspace.rows("density", len(particles), float)
    return np.divide(particles.mass, particles.volume, out=density)


@deferred_kernel
def list_shared(mass: Array, shared: Array) -> int:
    """Enter the nodes that two or more materials have mass at; returns how many they are."""
    count = 0
    for n in range(mass.shape[1]):
        present = 0
        for m in range(mass.shape[0]):
            if mass[m, n] > EMPTY_MASS:
                present += 1
        if present >= 2:
            shared[count] = n
            count += 1
    return count


@deferred_kernel
def mark_cells_near(grid: GridIndex, shared: Array, near: Array) -> None:
    """Mark in ``near`` (N,) the first nodes of the cells from which a particle may reach a shared node.

    A particle that reaches no farther than two cells has nodes from one before its cell to two after it.
    """
    nx, ny, nz = grid.nodes
    for n in shared:
        i, j, k = n % nx, n // nx % ny, n // (nx * ny)
        for c in range(max(0, k - 2), min(nz, k + 2)):
            for b in range(max(0, j - 2), min(ny, j + 2)):
                for a in range(max(0, i - 2), min(nx, i + 2)):
                    near[a + nx * (b + ny * c)] = True


@inline
def may_reach(shapes: ParticleShapes, p: int, near: Array) -> bool:
    """Whether a particle may have a node that materials share, from the marked cells."""
    F, size = tensor_at(shapes.deformation_gradient, p), tensor_at(shapes.size, p)
    if reach(shapes.interpolation, particle_domain(shapes.interpolation, F, size)) > 2.0:
        return True
    grid = shapes.grid
    cell, stride = 0, 1
    for axis in range(3):
        q = (shapes.position[p, axis] - grid.anchor[axis]) / grid.spacing[axis]
        index = math.floor(q) - grid.first[axis]
        if index < 0 or index >= grid.nodes[axis]:
            return True
        cell += index * stride
        stride *= grid.nodes[axis]
    return bool(near[cell])


@deferred_kernel
def add_particles(
    shapes: ParticleShapes,
    wanted: Array,
    near: Array,
    mass: Array,
    gradient_weight: Array,
    gradient_scale: Vector,
    stress: Array,
    nodal_gradient: Array,
    nodal_moment: Array,
    nodal_stress: Array,
) -> None:
    """Sum gradients, mass times position, and stress (xx, yy, zz, xy, xz, yz) at the wanted nodes (N,).

    Particles in cells that ``near`` does not mark touch none of them.
    """
    nodes = scratch_numbers(MOST_NODES, np.int64)
    weights = scratch_numbers(MOST_NODES, np.float64)
    gradients = scratch_rows(MOST_NODES, 3)
    for p in range(mass.shape[0]):
        if not may_reach(shapes, p, near):
            continue
        for k in range(shape_of(shapes, p, nodes, weights, gradients)):
            n = shapes.images.node[nodes[k]]
            if not wanted[n]:
                continue
            x = plus(vector_at(shapes.position, p), vector_at(shapes.images.shift, nodes[k]))
            for axis in range(3):
                nodal_gradient[n, axis] += gradient_weight[p] * gradients[k, axis] * gradient_scale[axis]
                nodal_moment[n, axis] += x[axis] * mass[p] * weights[k]
                nodal_stress[n, axis] += stress[p, axis, axis] * weights[k]
            nodal_stress[n, 3] += stress[p, 0, 1] * weights[k]
            nodal_stress[n, 4] += stress[p, 0, 2] * weights[k]
            nodal_stress[n, 5] += stress[p, 1, 2] * weights[k]


@deferred_kernel
def make_colinear(nodes: Array, normal: Array, mass: Array, averaged: Array) -> None:
    """n_m <- (n_m - sum_k m_k n_k / sum_k m_k) / 2 over the other materials k; 0 where m has no mass.

    ``averaged`` (materials, 3) is room for the normals of a node.
    """
    materials = mass.shape[0]
    for n in nodes:
        for m in range(materials):
            others, total = (0.0, 0.0, 0.0), 0.0
            for k in range(materials):
                if k != m:
                    others = plus(others, times(mass[k, n], vector_at(normal[k], n)))
                    total += mass[k, n]
            difference = minus(vector_at(normal[m], n), over(others, total + LEAST_MASS))
            put_vector(averaged, m, times(0.5 if mass[m, n] > EMPTY_MASS else 0.0, difference))
        for m in range(materials):
            put_vector(normal[m], n, vector_at(averaged, m))


@deferred_kernel
def finish(nodes: Array, fields: SurfaceFields, mass: Array, stress: Array) -> None:
    """Make normals unit vectors and moments positions, and take the tractions."""
    for m in range(mass.shape[0]):
        for n in nodes:
            normal = vector_at(fields.normal[m], n)
            size = length(normal)
            if size > SHORTEST:
                normal = over(normal, size)
            put_vector(fields.normal[m], n, normal)
            fields.traction[m, n] = normal_component(stress[m], n, normal)
            put_vector(fields.position[m], n, over(vector_at(fields.position[m], n), mass[m, n]))


@inline
def normal_component(stress: Array, n: int, normal: Vector) -> float:
    """The product n . sigma . n for a symmetric tensor stored as xx, yy, zz, xy, xz, yz."""
    xx, yy, zz = stress[n, 0], stress[n, 1], stress[n, 2]
    xy, xz, yz = stress[n, 3], stress[n, 4], stress[n, 5]
    sigma_n = (
        xx * normal[0] + xy * normal[1] + xz * normal[2],
        xy * normal[0] + yy * normal[1] + yz * normal[2],
        xz * normal[0] + yz * normal[1] + zz * normal[2],
    )
    return dot(sigma_n, normal)
