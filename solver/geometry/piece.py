"""What every geometry piece provides, and what pieces share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from solver.declare import Parameter, Vector, fields

Array = NDArray[Any]

OpenFile = Callable[[str], Path]
"""Where a file named in a deck lies; raises FileNotFoundError when it is nowhere."""


class BoundingBox(NamedTuple):
    """Opposite corners of a box around a piece."""

    lower: Vector
    upper: Vector


@dataclass(frozen=True, kw_only=True)
class GeometryPiece:
    """A closed shape in space that answers which points lie in it.

    Constructing a piece checks its parameters; what is wrong is said in a ValueError.
    """

    label: Annotated[
        str,
        Parameter(
            "name by which the piece can be used again, without parameters",
            attribute=True,
            old_tags=("name",),
        ),
    ] = ""

    def __post_init__(self) -> None:
        check_declared_bounds(self)

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the piece, (n,)."""
        raise NotImplementedError

    def bounding_box(self) -> BoundingBox:
        """A box that holds the piece."""
        raise NotImplementedError

    def on_lattice(self, x: Array, y: Array, z: Array) -> Array:
        """Whether points (x[i], y[j], z[k]) lie in the piece, as an array [k, j, i]; coordinates ascend."""
        found = np.zeros((len(z), len(y), len(x)), bool)
        window = lattice_window(self.bounding_box(), x, y, z)
        points = np.empty((3, *found[window].shape))
        if points.size:
            points[0] = x[window[2]]
            points[1] = y[window[1]][:, None]
            points[2] = z[window[0]][:, None, None]
            found[window] = self.inside(points.reshape(3, -1).T).reshape(points.shape[1:])
        return found


@runtime_checkable
class ParticleSource(Protocol):
    """A piece that says itself where its particles are, instead of filling cells."""

    def particles(self, spacing: Vector, tetrahedral: bool) -> dict[str, Array]:
        """The particles in the order in which they are created.

        ``spacing`` is the cell size; ``tetrahedral`` is True when particle vectors span tetrahedra (cpti)
        instead of parallelepipeds. The arrays are named as the fields of ``solver.particles.Particles``
        (``position`` always, others where the piece knows them), and ``normal`` for surface normals (n, 3).
        """


def lattice_window(box: BoundingBox, x: Array, y: Array, z: Array) -> tuple[slice, slice, slice]:
    """The slices of z, y and x that may lie in a box, one point wider to be safe from rounding."""

    def window(along: Array, lower: float, upper: float) -> slice:
        first = int(np.searchsorted(along, lower, "left")) - 1
        return slice(max(first, 0), int(np.searchsorted(along, upper, "right")) + 1)

    (x0, y0, z0), (x1, y1, z1) = box
    return window(z, z0, z1), window(y, y0, y1), window(x, x0, x1)


def check_declared_bounds(record: Any) -> None:
    """Raise ValueError if a number of a record is outside the bounds that its Parameter declares."""
    record_class: Any = type(record)
    for info in fields(record_class):
        parameter, given = info.parameter, getattr(record, info.name)
        if parameter.choices and isinstance(given, str) and given not in parameter.choices:
            raise ValueError(f"{info.tag} is {given!r}; it must be one of {', '.join(parameter.choices)}")
        values = given if isinstance(given, tuple) else (given,)
        for value in (v for v in values if isinstance(v, int | float)):
            for bound, words, holds in (
                (parameter.gt, "greater than", lambda v, b: v > b),
                (parameter.ge, "at least", lambda v, b: v >= b),
                (parameter.lt, "less than", lambda v, b: v < b),
                (parameter.le, "at most", lambda v, b: v <= b),
            ):
                if bound is not None and not holds(value, bound):
                    raise ValueError(f"{info.tag} is {value:g}; it must be {words} {bound:g}")


def difference(a: Vector, b: Vector) -> Vector:
    """The vector a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a: Vector, b: Vector) -> float:
    """The scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def as_vector(array: Any) -> Vector:
    """Three numbers of an array as a plain tuple."""
    return (float(array[0]), float(array[1]), float(array[2]))


def relative_to(points: Array, origin: Vector) -> tuple[Array, Array, Array]:
    """The components (n,) of points (n, 3) seen from an origin."""
    return points[:, 0] - origin[0], points[:, 1] - origin[1], points[:, 2] - origin[2]
