"""The shape functions of a material's particles, with periodic images taken for the nodes they repeat."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.contact.law import Array, ContactScene
from solver.contact.periodic import Representatives, representatives
from solver.dispatch import inline
from solver.grid import GridIndex
from solver.interpolation.shape import particle_domain, shape_functions
from solver.tensor import tensor_at


class ParticleShapes(NamedTuple):
    """What kernels need to weight the n particles of a material to nodes."""

    interpolation: Any
    grid: GridIndex
    images: Representatives
    position: Array
    """(n, 3)"""
    deformation_gradient: Array
    """(n, 3, 3) at the start of the step."""
    size: Array
    """(n, 3, 3) initial particle vectors, cell units."""


def particle_shapes(scene: ContactScene, material: int) -> ParticleShapes:
    """The shapes of a material's particles at the start of the step."""
    return shapes_of(scene, scene.particles[material])


def shapes_of(scene: ContactScene, particles: Any) -> ParticleShapes:
    """The shapes of some particles, given their ``position``, ``deformation_gradient`` and ``size``."""
    return ParticleShapes(
        scene.interpolation,
        scene.grid.index,
        representatives(scene.grid),
        particles.position,
        particles.deformation_gradient,
        particles.size,
    )


@inline
def shape_of(shapes: ParticleShapes, p: int, nodes: Array, weights: Array, gradients: Array) -> int:
    """Fill in nodes, weights and gradients of particle p and return their number; see ``shape_functions``."""
    F, size = tensor_at(shapes.deformation_gradient, p), tensor_at(shapes.size, p)
    domain = particle_domain(shapes.interpolation, F, size)
    x, y, z = shapes.position[p, 0], shapes.position[p, 1], shapes.position[p, 2]
    return shape_functions(shapes.interpolation, shapes.grid, x, y, z, domain, nodes, weights, gradients)
