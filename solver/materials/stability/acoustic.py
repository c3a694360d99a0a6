"""Loss of hyperbolicity by the acoustic tensor, and Becker's reading of it."""

from __future__ import annotations

import math
from typing import NamedTuple

from solver.declare import model
from solver.dispatch import implements, inline, lanewise
from solver.materials.stability import TangentModulus, is_checked, localizes
from solver.tensor import Tensor, principal_values


class BandDeterminant(NamedTuple):
    """det R / (2 R_22 n_1^4) = a x^4 + b x^2 + c for bands whose normal n has the slope x = n_3 / n_1.

    R_ij = 2 M_ikjl n_k n_l - sigma_ik n_k n_j (Banerjee 2012, Eq. 77), and 1 and 3 are the directions of the
    largest and smallest principal stress.
    """

    a: float
    b: float
    c: float


@inline
def band_determinant(stress: Tensor, tangent: TangentModulus) -> BandDeterminant:
    """The determinant whose roots are the slopes of possible bands.

    After Becker (2002), Int. J. Solids Struct. 39, 3555. The yield normal has the principal directions of
    the stress, so principal values are all that is needed. Uintah takes components along the axes of the
    material instead.
    """
    sigma = principal_values(stress)
    flow = principal_values(tangent.direction)
    G = tangent.shear_modulus
    along = tangent.bulk_modulus + 4.0 / 3.0 * G
    across = tangent.bulk_modulus - 2.0 / 3.0 * G - flow.first * flow.third / tangent.resistance
    M11 = along - flow.first * flow.first / tangent.resistance
    M33 = along - flow.third * flow.third / tangent.resistance
    b = G * (sigma.third + sigma.first - 4.0 * across) + 2.0 * (M11 * M33 - across * across)
    b += sigma.first * (across - M33) + sigma.third * (across - M11)
    return BandDeterminant(G * (2.0 * M33 - sigma.third), b, G * (2.0 * M11 - sigma.first))


@model("stability", "acoustic")
class Acoustic(NamedTuple):
    """Rudnicki and Rice (1975), J. Mech. Phys. Solids 23, 371: unstable when det R <= 0 for some band.

    Bands are looked for in the plane of the largest and smallest principal stress. (Uintah names this check
    but does not have it.)
    """


@implements(is_checked, Acoustic)
def _(check: Acoustic) -> bool:
    return True


@implements(localizes, Acoustic)
@lanewise
def _(check: Acoustic, stress: Tensor, rate: Tensor, tangent: TangentModulus) -> bool:
    det = band_determinant(stress, tangent)
    at_an_end = (det.a <= 0.0) | (det.c <= 0.0)
    return at_an_end | ((det.b < 0.0) & (det.b * det.b >= 4.0 * det.a * det.c))


@inline
def has_four_bands(stress: Tensor, tangent: TangentModulus) -> bool:
    """Whether the determinant vanishes for four real slopes."""
    det = band_determinant(stress, tangent)
    discriminant = det.b * det.b - 4.0 * det.a * det.c
    root = math.sqrt(max(discriminant, 0.0))
    positive = ((root - det.b) * det.a >= 0.0) & ((-root - det.b) * det.a >= 0.0)
    return (discriminant >= 0.0) & (det.a != 0.0) & positive


@model("stability", "becker")
class Becker(NamedTuple):
    """Becker (2002): unstable when det R vanishes for four real band slopes."""


@implements(is_checked, Becker)
def _(check: Becker) -> bool:
    return True


@implements(localizes, Becker)
@lanewise
def _(check: Becker, stress: Tensor, rate: Tensor, tangent: TangentModulus) -> bool:
    return has_four_bands(stress, tangent)
