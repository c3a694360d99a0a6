"""The yield surface: a shear limit that bends over pressure, closed by an elliptic cap."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.dispatch import inline

ISOTROPIC = 1.0e-16
"""A stress with J2 below this times I1^2 counts as isotropic."""


class ShearLimit(NamedTuple):
    """sqrt(J2) = a1 - a3 exp(a2 I) - a4 I for I <= peak, with I = I1 - zeta."""

    a1: float
    a2: float
    a3: float
    a4: float
    peak: float


class Surface(NamedTuple):
    """A yield surface: the shear limit with a cap between its branch point and its end on the hydrostat."""

    limit: ShearLimit
    cap: float
    zeta: float
    branch: float


@inline
def shear_limit(model: Any, coherence: float) -> ShearLimit:
    """The limit surface of a particle whose vertex lies at ``coherence`` times PEAKI1.

    Linear (Drucker-Prager) without STREN and YSLOPE, constant (von Mises) with STREN alone, else a curve
    from the slope FSLOPE at the vertex to the asymptote of slope YSLOPE.
    """
    peak = coherence * model.PEAKI1
    if model.STREN == 0.0:
        return ShearLimit(peak * model.FSLOPE, 0.0, 0.0, model.FSLOPE, peak)
    if model.FSLOPE == 0.0:
        return ShearLimit(model.STREN, 0.0, 0.0, 0.0, peak)
    rise = model.STREN - model.YSLOPE * peak
    decay = (model.FSLOPE - model.YSLOPE) / rise
    return ShearLimit(model.STREN, decay, rise * math.exp(-decay * peak), model.YSLOPE, peak)


def limit_faults(model: Any) -> list[tuple[str, str]]:
    """What is wrong with a set of PEAKI1, FSLOPE, STREN and YSLOPE that describes no shear limit."""
    if model.STREN == 0.0:
        if model.FSLOPE == 0.0 or model.YSLOPE > 0.0:
            return [("STREN", "without STREN the limit is a line: it needs FSLOPE above 0 and YSLOPE 0")]
    elif model.FSLOPE == 0.0:
        if model.PEAKI1 > 0.0 or model.YSLOPE > 0.0:
            return [
                ("FSLOPE", "with STREN and without FSLOPE the limit is constant: PEAKI1 and YSLOPE are 0")
            ]
    elif model.YSLOPE == 0.0:
        if model.PEAKI1 > 0.0:
            return [("YSLOPE", "with STREN, FSLOPE and a PEAKI1 above 0 it has to be above 0")]
    elif model.FSLOPE <= model.YSLOPE:
        return [
            ("FSLOPE", "it has to be larger than YSLOPE: the limit bends towards the hydrostat's direction")
        ]
    elif model.STREN <= model.YSLOPE * model.PEAKI1:
        return [("STREN", "it has to be larger than YSLOPE times PEAKI1")]
    return []


@inline
def surface(model: Any, limit: ShearLimit, cap: float, zeta: float) -> Surface:
    """The yield surface with a given cap and back stress."""
    return Surface(limit, cap, zeta, limit.peak - model.CR * (limit.peak - cap))


@inline
def is_outside(at: Surface, i1: float, j2: float, root_j2: float) -> bool:
    """Whether a stress lies outside; a negative ``root_j2`` lies inside the shear limit."""
    above = i1 - at.zeta
    if above < at.cap or above > at.limit.peak:
        return True
    strength = at.limit.a1 - at.limit.a3 * math.exp(at.limit.a2 * above) - at.limit.a4 * above
    if above < at.branch:
        depth = (at.branch - above) / (at.branch - at.cap)
        return j2 > strength * strength * (1.0 - depth * depth)
    return root_j2 > strength
