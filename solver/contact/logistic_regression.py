"""Where bodies touch at a node: the plane that separates their particles, and how far each reaches across.

Source: Nairn, Hammerquist and Smith (2020), New material point method contact algorithms for improved
accuracy, large-deformation problems, and proper null-space filtering, CMAME 362, 112859.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from solver.contact.law import Array, ContactScene
from solver.contact.particle_shapes import ParticleShapes, shape_of, shapes_of
from solver.contact.vectors import dot, length, over, plus, put_vector, times, vector_at
from solver.declare import Vector
from solver.deferred import deferred_kernel
from solver.dispatch import inline
from solver.interpolation.shape import MOST_NODES, particle_domain
from solver.nodal import EMPTY_MASS
from solver.particles import Particles
from solver.scratch import scratch_numbers, scratch_rows
from solver.tensor import tensor_at

NO_ALPHA = -1
LEAST_SHARE = 1.0e-8
"""Share of the nodal mass from which a material counts as being at a node."""
LEAST_MASS = 1.0e-16
"""Mass above which a material counts as being at a node."""
LEAST_RIGID_MASS = 1.0e-90
LEAST_WEIGHT = 1.0e-8
"""Shape function above which a particle takes part in the regression at a node."""
PENALTY = 1.0e-7
"""Penalty on the slope of the separating plane, times the square of the cell size in x."""
TOLERANCE = 1.0e-7
MOST_ITERATIONS = 51
ON_SURFACE = 0.9
"""Value of ``Particles.surface`` above which a particle may be the most prominent of its body."""
TINY = 1.0e-100
"""Added to lengths that are divided by."""


class TouchingSurfaces(NamedTuple):
    """What contact by logistic regression knows of each node."""

    alpha: Array
    """(N,) the material that the normal points away from; NO_ALPHA where fewer than two bodies meet."""
    normal: Array
    """(N, 3) unit normal of the separating plane, from the alpha material to the others."""
    prominence: Array
    """(M, N) position along the normal that the body's surface reaches: the farthest of the alpha material,
    the nearest of another; minus infinity where it has no surface particle."""


class Neighbours(NamedTuple):
    """The particles around each node where bodies meet, material after material."""

    start: Array
    """(N + 1,) first entry of each node."""
    position: Array
    """(K, 3)"""
    side: Array
    """(K,) -1 for a particle of the alpha material, 1 for another."""


def touching_surfaces(scene: ContactScene) -> TouchingSurfaces:
    """Alpha materials, normals and prominences of a scene; use it with ``scene.once``."""
    workspace, (materials, count) = scene.workspace, scene.nodal.mass.shape
    alpha = alpha_materials(scene)
    bodies = [_with_neighbours(scene, particles) for particles in scene.particles]
    shapes = [shapes_of(scene, body) for body in bodies]
    counts = workspace.zeros("counts of neighbours", materials, np.int64, count)
    latest = scene.list_of_nodes("latest particle at nodes")
    near = []
    for m, shape in enumerate(shapes):
        near.append(workspace.rows(f"near touching {m}", len(shape.position), np.bool_))
        scene.call(count_neighbours, shape, alpha, latest, counts[m], near[m])
    nodes = scene.list_of_nodes("nodes with neighbours")
    nodes = nodes[: scene.call(list_touching, counts, alpha, nodes)]

    neighbours = _neighbours(scene, alpha, counts, shapes, near)
    normal = workspace.zeros("separating normals", count, float, 3)
    newton = Newton(
        workspace.rows("separation: phi", 4, float),
        workspace.rows("separation: matrix", 4, float, 4),
        workspace.rows("separation: right-hand side", 4, float),
        workspace.rows("separation: position", 4, float),
    )
    scene.call(separate, nodes, neighbours, PENALTY * scene.grid.spacing[0] ** 2, newton, normal)
    scene.boundary_conditions.apply_symmetry(normal, 0)
    _make_unit(scene, normal, alpha)

    prominence = workspace.rows("prominence", materials, float, count)
    prominence[:] = -np.inf
    surfaces = TouchingSurfaces(alpha, normal, prominence)
    for m, shape in enumerate(shapes):
        scene.call(reach, shape, near[m], bodies[m].surface, scene.grid.spacing, m, surfaces)
    _share(scene, surfaces)
    return surfaces


def touching_nodes(scene: ContactScene) -> Array:
    """The nodes where bodies touch, in order; use it with ``scene.once``."""
    nodes = scene.list_of_nodes("touching nodes")
    return nodes[: scene.call(list_chosen, scene.once(touching_surfaces).alpha, nodes)]


class _Seen(NamedTuple):
    """What of a particle matters here."""

    position: Array
    deformation_gradient: Array
    size: Array
    surface: Array


def _with_neighbours(scene: ContactScene, particles: Particles) -> _Seen:
    """The particles of this rank and those of others that reach nodes which this one counts."""
    own = _Seen(particles.position, particles.deformation_gradient, particles.size, particles.surface)
    seen: _Seen = scene.exchange.with_neighbours(own)
    return seen


def _share(scene: ContactScene, surfaces: TouchingSurfaces) -> None:
    """Give all copies of a node what the rank found that counts it, and so saw all particles there."""
    alpha = scene.workspace.rows("alpha shared", len(surfaces.alpha), float)
    alpha[:] = surfaces.alpha
    scene.exchange.share(alpha)
    surfaces.alpha[:] = alpha
    scene.exchange.share(surfaces.normal)
    for prominence in surfaces.prominence:
        scene.exchange.share(prominence)


def alpha_materials(scene: ContactScene) -> Array:
    """(N,) at the patches' nodes that several materials share, a rigid one, else that of most mass."""
    alpha = scene.list_of_nodes("alpha materials")
    possible, rigid = np.array(scene.possible_alpha, bool), np.array(scene.rigid, bool)
    scene.call(choose_alpha, scene.nodal.mass, possible, rigid, scene.owned_nodes, alpha)
    return alpha


@deferred_kernel
def choose_alpha(mass: Array, possible: Array, rigid: Array, owned: Array, alpha: Array) -> None:
    """Enter the alpha material of each node (N,), or NO_ALPHA."""
    for n in range(owned.shape[0]):
        alpha[n] = NO_ALPHA
        total = 0.0
        for m in range(mass.shape[0]):
            total += mass[m, n]
        least = max(LEAST_SHARE * (EMPTY_MASS + total), LEAST_MASS)
        present, most, most_rigid = 0, 0.0, 0.0
        heaviest = heaviest_rigid = NO_ALPHA
        for m in range(mass.shape[0]):
            own = mass[m, n]
            if possible[m] and own > least:
                present += 1
                if own > most:
                    most, heaviest = own, m
            if possible[m] and rigid[m] and own > LEAST_RIGID_MASS and own > most_rigid:
                most_rigid, heaviest_rigid = own, m
        if owned[n] and present >= 2:
            alpha[n] = heaviest if heaviest_rigid == NO_ALPHA else heaviest_rigid


@deferred_kernel
def list_touching(counts: Array, alpha: Array, listed: Array) -> int:
    """List the nodes where particles of two materials are; others get NO_ALPHA. Returns how many they are."""
    count = 0
    for n in range(alpha.shape[0]):
        bodies = 0
        for m in range(counts.shape[0]):
            if counts[m, n] > 0:
                bodies += 1
        if bodies < 2:
            alpha[n] = NO_ALPHA
        if alpha[n] != NO_ALPHA:
            listed[count] = n
            count += 1
    return count


@deferred_kernel
def list_chosen(alpha: Array, listed: Array) -> int:
    """List the nodes that have an alpha material; returns how many they are."""
    count = 0
    for n in range(alpha.shape[0]):
        if alpha[n] != NO_ALPHA:
            listed[count] = n
            count += 1
    return count


def _neighbours(
    scene: ContactScene, alpha: Array, counts: Array, shapes: list[ParticleShapes], near: list[Array]
) -> Neighbours:
    start = scene.workspace.rows("first neighbours", len(alpha) + 1, np.int64)
    following = scene.list_of_nodes("following neighbours")
    total = scene.call(lay_out_lists, alpha, counts, start, following)
    neighbours = Neighbours(
        start,
        scene.workspace.rows("positions of neighbours", total, float, 3),
        scene.workspace.rows("sides of neighbours", total, float),
    )
    latest = scene.list_of_nodes("latest particle at nodes")
    for m, shape in enumerate(shapes):
        scene.call(list_neighbours, shape, near[m], m, alpha, latest, following, neighbours)
    return neighbours


@deferred_kernel
def lay_out_lists(alpha: Array, counts: Array, start: Array, following: Array) -> int:
    """Enter where the lists of the nodes begin (N + 1,) and go on (N,); returns how long they are together."""
    total = 0
    for n in range(alpha.shape[0]):
        start[n] = following[n] = total
        if alpha[n] != NO_ALPHA:
            for m in range(counts.shape[0]):
                total += counts[m, n]
    start[alpha.shape[0]] = total
    return total


def _make_unit(scene: ContactScene, normal: Array, alpha: Array) -> None:
    """Make the normals (N, 3) unit vectors, and zero where there is no alpha material."""
    squares = scene.workspace.rows("squares of normals", len(normal), float, 3)
    sizes = scene.workspace.rows("sizes of normals", len(normal), float)
    np.add.reduce(np.multiply(normal, normal, out=squares), axis=1, out=sizes)
    scene.call(divide_normals, normal, np.sqrt(sizes, out=sizes), alpha)


@deferred_kernel
def divide_normals(normal: Array, sizes: Array, alpha: Array) -> None:
    """Divide the normals (N, 3) by their sizes (N,); they are zero where there is no alpha material."""
    for n in range(alpha.shape[0]):
        unit = over(vector_at(normal, n), sizes[n] + TINY)
        put_vector(normal, n, unit if alpha[n] != NO_ALPHA else (0.0, 0.0, 0.0))


@deferred_kernel
def count_neighbours(shapes: ParticleShapes, alpha: Array, latest: Array, counts: Array, near: Array) -> None:
    """Count the particles at each shared node (N,), and enter which particles (n,) touch such a node.

    ``latest`` (N,) is overwritten.
    """
    latest[:] = -1
    nodes, weights, gradients = (
        scratch_numbers(MOST_NODES, np.int64),
        scratch_numbers(MOST_NODES, np.float64),
        scratch_rows(MOST_NODES, 3),
    )
    for p in range(shapes.position.shape[0]):
        near[p] = False
        for k in range(shape_of(shapes, p, nodes, weights, gradients)):
            n = shapes.images.node[nodes[k]]
            if alpha[n] == NO_ALPHA:
                continue
            near[p] = near[p] or weights[k] > 0.0
            # Some interpolators name a node more than once.
            if weights[k] > LEAST_WEIGHT and latest[n] != p:
                latest[n] = p
                counts[n] += 1


@deferred_kernel
def list_neighbours(
    shapes: ParticleShapes,
    near: Array,
    material: int,
    alpha: Array,
    latest: Array,
    following: Array,
    neighbours: Neighbours,
) -> None:
    """Enter the near particles of a material in the lists of the shared nodes; ``following`` (N,) is their end.

    ``latest`` (N,) is overwritten.
    """
    latest[:] = -1
    nodes, weights, gradients = (
        scratch_numbers(MOST_NODES, np.int64),
        scratch_numbers(MOST_NODES, np.float64),
        scratch_rows(MOST_NODES, 3),
    )
    for p in range(near.shape[0]):
        if not near[p]:
            continue
        for k in range(shape_of(shapes, p, nodes, weights, gradients)):
            n = shapes.images.node[nodes[k]]
            if alpha[n] == NO_ALPHA or weights[k] <= LEAST_WEIGHT or latest[n] == p:
                continue
            latest[n] = p
            x = plus(vector_at(shapes.position, p), vector_at(shapes.images.shift, nodes[k]))
            put_vector(neighbours.position, following[n], x)
            neighbours.side[following[n]] = -1.0 if alpha[n] == material else 1.0
            following[n] += 1


class Newton(NamedTuple):
    """Room for Newton's iteration. In memory: in registers, the compiler rounds otherwise than Uintah's does.

    Where the iteration does not settle, its last digits decide which direction is taken.
    """

    phi: Array
    """(4,)"""
    matrix: Array
    """(4, 4)"""
    right: Array
    """(4,)"""
    x: Array
    """(4,)"""


@deferred_kernel
def separate(nodes: Array, neighbours: Neighbours, penalty: float, newton: Newton, normal: Array) -> None:
    """Find the normal (N, 3) of the plane between the alpha material and the others at the given nodes.

    Newton's iteration for the phi that minimises sum (c - f)^2 + penalty |phi|^2 with
    f = 2 / (1 + exp(-(phi_xyz . x + phi_0))) - 1 and c = -1 or 1 the side of a particle. It ends when the
    direction stays; if it never does, the direction that changed least is taken.
    """
    phi, matrix, right = newton.phi, newton.matrix, newton.right
    for n in nodes:
        phi[:] = 0.0
        direction = best = (0.0, 0.0, 0.0)
        least_change = 1.0
        for _ in range(MOST_ITERATIONS):
            newton_system(neighbours, neighbours.start[n], neighbours.start[n + 1], penalty, newton)
            solve_in_place(matrix, right)
            for i in range(4):
                phi[i] += right[i]
            slope = (phi[0], phi[1], phi[2])
            turned = over(slope, length(slope) + TINY)
            change = 1.0 - dot(turned, direction)
            if change < least_change:
                least_change, best = change, turned
            if change < TOLERANCE:
                break
            direction = turned
        put_vector(normal, n, best)


@inline
def newton_system(neighbours: Neighbours, first: int, last: int, penalty: float, newton: Newton) -> None:
    """Matrix and right-hand side of one Newton step over the particles first <= e < last."""
    phi, matrix, right, x = newton.phi, newton.matrix, newton.right, newton.x
    x[3] = 1.0
    for i in range(4):
        for j in range(4):
            matrix[i, j] = 0.0
        weight = penalty if i < 3 else 0.0
        matrix[i, i] = weight
        right[i] = -weight * phi[i]
    for e in range(first, last):
        for i in range(3):
            x[i] = neighbours.position[e, i]
        s = phi[0] * x[0] + phi[1] * x[1] + phi[2] * x[2] + phi[3]
        decay = math.exp(-abs(s))
        slope = 2.0 * decay / ((1.0 + decay) * (1.0 + decay))
        misfit = neighbours.side[e] - math.tanh(0.5 * s)
        for i in range(4):
            for j in range(4):
                matrix[i, j] += slope * slope * x[i] * x[j]
            right[i] += slope * misfit * x[i]


@inline
def solve_in_place(matrix: Array, right: Array) -> None:
    """Solve ``matrix @ x = right`` by Gaussian elimination with row pivots; x replaces ``right``."""
    size = right.shape[0]
    for i in range(size):
        pivot = i
        for j in range(i + 1, size):
            if abs(matrix[j, i]) > abs(matrix[pivot, i]):
                pivot = j
        for k in range(i, size):
            matrix[i, k], matrix[pivot, k] = matrix[pivot, k], matrix[i, k]
        right[i], right[pivot] = right[pivot], right[i]
        for j in range(i + 1, size):
            factor = matrix[j, i] / matrix[i, i]
            right[j] -= factor * right[i]
            for k in range(i, size):
                matrix[j, k] -= factor * matrix[i, k]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            right[i] -= matrix[i, k] * right[k]
        right[i] /= matrix[i, i]


@deferred_kernel
def reach(
    shapes: ParticleShapes,
    near: Array,
    surface: Array,
    spacing: Vector,
    material: int,
    surfaces: TouchingSurfaces,
) -> None:
    """Enter how far the face centres of the near particles on the surface of a material reach along the normals."""
    nodes, weights, gradients = (
        scratch_numbers(MOST_NODES, np.int64),
        scratch_numbers(MOST_NODES, np.float64),
        scratch_rows(MOST_NODES, 3),
    )
    prominence = surfaces.prominence[material]
    for p in range(near.shape[0]):
        if not (near[p] and surface[p] > ON_SURFACE):
            continue
        edges = edge_vectors(shapes, p, spacing)
        for k in range(shape_of(shapes, p, nodes, weights, gradients)):
            n = shapes.images.node[nodes[k]]
            if surfaces.alpha[n] == NO_ALPHA or weights[k] <= 0.0:
                continue
            outwards = 1.0 if surfaces.alpha[n] == material else -1.0
            normal = vector_at(surfaces.normal, n)
            x = plus(vector_at(shapes.position, p), vector_at(shapes.images.shift, nodes[k]))
            along = (dot(edges[0], normal), dot(edges[1], normal), dot(edges[2], normal))
            half = 0.5 * max(abs(along[0]), abs(along[1]), abs(along[2]))
            farthest = dot(x, normal) + outwards * half
            if prominence[n] == -math.inf or outwards * (farthest - prominence[n]) > 0.0:
                prominence[n] = farthest


@inline
def edge_vectors(shapes: ParticleShapes, p: int, spacing: Vector) -> tuple[Vector, Vector, Vector]:
    """The vectors r1, r2, r3 of a particle: columns of its domain, r_k times the spacing of direction k."""
    r = particle_domain(
        shapes.interpolation, tensor_at(shapes.deformation_gradient, p), tensor_at(shapes.size, p)
    )
    return (
        times(spacing[0], (r.xx, r.yx, r.zx)),
        times(spacing[1], (r.xy, r.yy, r.zy)),
        times(spacing[2], (r.xz, r.yz, r.zz)),
    )


@inline
def overlaps(surfaces: TouchingSurfaces, m: int, n: int) -> bool:
    """Whether material m and the alpha material reach across each other at node n."""
    return not surfaces.prominence[m, n] > surfaces.prominence[surfaces.alpha[n], n]


@inline
def slide(relative: Vector, normal: Vector, mu: float) -> Vector:
    """Change of velocity that ends an approach relative . normal > 0 and, up to Coulomb's limit, the slip."""
    w = dot(relative, normal)
    slip = plus(relative, times(-w, normal))
    tangent = over(slip, length(slip) + TINY)
    friction = min(mu, dot(relative, tangent) / w) * w
    return times(-1.0, plus(times(w, normal), times(friction, tangent)))
