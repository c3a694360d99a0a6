"""The frame of the material: the rotation of the polar decomposition as elastic-plastic updates need it."""

from __future__ import annotations

import math

from solver.dispatch import inline
from solver.tensor import Tensor, double_dot, isotropic

MOST_ITERATIONS = 200
ERROR = 2.0**-53
"""Square of the norm of (R^T R - I) / 2 at which the iteration ends, that of Uintah."""


@inline
def polar_rotation(F: Tensor) -> Tensor:
    """The rotation R of F = R U for det F > 0, by the iteration of Bjorck and Bowie (1971).

    R <- R (I - E) with E = (R^T R - I) / 2 starts from F scaled to the norm of a rotation and converges
    quadratically. It ends at |E| = 1e-8 as in Uintah, whose stresses carry the error that is left
    (:func:`solver.tensor.rotation` goes to machine precision).
    """
    identity = isotropic(1.0)
    R = F * math.sqrt(3.0 / double_dot(F, F))
    E = 0.5 * (R.T @ R - identity)
    error = double_dot(E, E)
    for _ in range(MOST_ITERATIONS):
        if error <= ERROR:
            break
        R = R @ (identity - E)
        E = 0.5 * (R.T @ R - identity)
        improved = double_dot(E, E)
        if improved >= error:
            break
        error = improved
    return R
