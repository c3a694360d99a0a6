"""What every interpolator provides: the nodes that a particle touches, their weights and gradients."""

from __future__ import annotations

from typing import Any

from solver.dispatch import generic
from solver.grid import GridIndex
from solver.tensor import Tensor

MOST_NODES = 64
"""Room that callers give to :func:`shape_functions`; no interpolator touches more nodes."""


@generic
def particle_domain(interpolator: Any, deformation_gradient: Tensor, size: Tensor) -> Tensor:
    """The particle's vectors r1, r2, r3 (columns, cell units) that the shape functions of this step use.

    ``size`` holds the initial vectors; interpolators whose particle domains deform return F times that.
    """
    raise NotImplementedError


@generic
def shape_functions(
    interpolator: Any,
    grid: GridIndex,
    x: float,
    y: float,
    z: float,
    domain: Tensor,
    nodes: Any,
    weights: Any,
    gradients: Any,
) -> int:
    """Weights of a particle at (x, y, z) on the nodes around it.

    Fills ``nodes`` (storage indices), ``weights`` S and ``gradients`` (.., 3), the derivatives of S by x, y, z
    in 1/length, and returns how many entries count. Axisymmetric interpolators put S/r, which the hoop
    components need, into the third column.
    """
    raise NotImplementedError
