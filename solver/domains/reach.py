"""How far particles reach beyond the cells that hold them, which decides how wide the halo has to be."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from solver.declare import Vector
from solver.interpolation.cpdi import Cpdi
from solver.interpolation.shape import particle_domain, reach
from solver.jit import kernel
from solver.materials.constitutive import coupling_length
from solver.tensor import tensor_at

if TYPE_CHECKING:
    from solver.body import Body

MOST = 1.0e6
"""Cells; a corner that is farther away belongs to a run that has failed."""


def layers_reached(interpolator: Any, bodies: Iterable[Body], spacing: Vector, on_corners: bool) -> int:
    """Layers of cells around those of a rank whose nodes its particles give to or take from.

    Parameters
    ----------
    interpolator : the interpolator's record.
    bodies : the bodies.
    spacing : cell sizes.
    on_corners : whether loads act at the corners of particles, wherever the interpolator reaches.
    """
    giving = [interpolator, Cpdi()] if on_corners else [interpolator]
    farthest = 1.0
    for body in bodies:
        # A particle that looks at nodes within a length looks into as many layers as one of that half width.
        farthest = max(farthest, 1.0 + coupling_length(body.model) / min(spacing))
        particles = body.particles
        for shape in giving:
            farthest = max(farthest, farthest_reach(shape, particles.deformation_gradient, particles.size))
    # The nodes of a particle's own cell are at most one cell away from it, those of the next layer two.
    return math.ceil(min(farthest, MOST)) - 1


@kernel
def farthest_reach(interpolator: Any, deformation_gradient: Any, size: Any) -> float:
    """The largest reach of particles (n, 3, 3), in cells; no loop remains where it is the same for all."""
    farthest = 0.0
    for p in range(size.shape[0]):
        domain = particle_domain(interpolator, tensor_at(deformation_gradient, p), tensor_at(size, p))
        farthest = max(farthest, reach(interpolator, domain))
    return farthest
