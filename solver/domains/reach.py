"""How far particles reach beyond the cells that hold them, which decides how wide the halo has to be."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from solver.interpolation.bspline import BSpline
from solver.interpolation.cpti import Cpti
from solver.interpolation.gimp import Gimp, GimpAxisymmetric
from solver.interpolation.linear import Linear, LinearAxisymmetric
from solver.jit import kernel
from solver.particles import Particles
from solver.tensor import matmul, tensor_at

LAYERS: dict[type, int] = {Linear: 0, LinearAxisymmetric: 0, Gimp: 1, GimpAxisymmetric: 1, BSpline: 1}
"""Layers of cells around its own whose nodes a particle can reach, whatever its deformation. Other interpolators
follow the corners of the deformed particle."""


def reach(interpolator: Any, bodies: Sequence[Particles], on_corners: bool) -> int:
    """Layers of cells around those of a rank whose nodes its particles reach.

    Parameters
    ----------
    interpolator : the interpolator's record.
    bodies : the particles of each body.
    on_corners : whether loads act at the corners of particles, wherever the interpolator reaches.
    """
    least = LAYERS.get(type(interpolator))
    if least is not None and not on_corners:
        return least
    share = 0.75 if isinstance(interpolator, Cpti) else 0.5
    edges = max((float(longest_edges(p.deformation_gradient, p.size)) for p in bodies), default=0.0)
    farthest = share * edges
    return max(least or 0, 1, int(-(-min(farthest, MOST) // 1)))


MOST = 1.0e6
"""Cells; a corner that is farther away belongs to a run that has failed."""


@kernel
def longest_edges(deformation_gradient: Any, size: Any) -> float:
    """The largest |r1| + |r2| + |r3| along a direction of the grid, in cells, r being the deformed edges.

    The corners of a parallelepiped lie at (+-r1 +-r2 +-r3) / 2 from its centre, those of a tetrahedron at no more
    than three quarters of the edges.
    """
    farthest = 0.0
    for p in range(size.shape[0]):
        r = matmul(tensor_at(deformation_gradient, p), tensor_at(size, p))
        farthest = max(farthest, abs(r.xx) + abs(r.xy) + abs(r.xz))
        farthest = max(farthest, abs(r.yx) + abs(r.yy) + abs(r.yz))
        farthest = max(farthest, abs(r.zx) + abs(r.zy) + abs(r.zz))
    return farthest
