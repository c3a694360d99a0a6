"""The loaded surface: areas, and which points lie near enough to it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated, Any

from solver.declare import SubModel, Vector
from solver.geometry.box import Box
from solver.geometry.cylinder import Cylinder
from solver.geometry.piece import Array, dot
from solver.geometry.sphere import Sphere


@dataclass(frozen=True)
class LoadedSurface:
    """The ``<geom_object>`` of a load: one piece, a part of whose surface is loaded."""

    piece: Annotated[Any, SubModel("geometry")]


def require_piece(piece: Any, load: str, *kinds: type) -> None:
    """Raise ValueError if a load cannot act on a piece of this class."""
    if not isinstance(piece, kinds):
        allowed = " or ".join(f"<{kind.__name__.lower()}>" for kind in kinds)
        given = type(piece).__name__.lower()
        raise ValueError(f"<{load}> acts on the surface of {allowed}, not of <{given}>")


def box_sides(box: Box) -> Vector:
    """The lengths of the sides of a box."""
    return (box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2])


def thinnest_direction(box: Box) -> int:
    """The axis (0, 1, 2) of the shortest side, the first of equals, which is normal to the loaded surface."""
    sides = box_sides(box)
    return sides.index(min(sides))


def face_area(box: Box) -> float:
    """The area across the thinnest direction."""
    x, y, z = box_sides(box)
    return x * y * z / min(x, y, z)


def side_area(cylinder: Cylinder) -> float:
    """The area of the curved side."""
    return 2.0 * math.pi * cylinder.radius * math.sqrt(dot(cylinder.axis, cylinder.axis))


def sphere_area(sphere: Sphere) -> float:
    """The area of a sphere."""
    return 4.0 * math.pi * sphere.radius * sphere.radius


def along_axis(cylinder: Cylinder) -> Vector:
    """The unit vector from bottom to top."""
    x, y, z = cylinder.axis
    length = math.sqrt(dot(cylinder.axis, cylinder.axis))
    return (x / length, y / length, z / length)


def in_widened_box(box: Box, points: Array, margin: Vector) -> Array:
    """Which points (n, 3) lie in the box widened by a margin at both ends of each direction."""
    (ax, ay, az), (bx, by, bz), (mx, my, mz) = box.min, box.max, margin
    return replace(box, min=(ax - mx, ay - my, az - mz), max=(bx + mx, by + my, bz + mz)).inside(points)


def near_side(cylinder: Cylinder, points: Array, tolerance: float) -> Array:
    """Which points (n, 3) lie between the ends, within a tolerance of the curved side."""
    near = replace(cylinder, radius=cylinder.radius + tolerance).inside(points)
    if cylinder.radius > tolerance:
        near &= ~replace(cylinder, radius=cylinder.radius - tolerance).inside(points)
    return near


def in_lengthened(cylinder: Cylinder, points: Array, tolerance: float) -> Array:
    """Which points (n, 3) lie in the cylinder lengthened by a tolerance at both ends."""
    (ux, uy, uz), (bx, by, bz), (tx, ty, tz) = along_axis(cylinder), cylinder.bottom, cylinder.top
    bottom = (bx - tolerance * ux, by - tolerance * uy, bz - tolerance * uz)
    top = (tx + tolerance * ux, ty + tolerance * uy, tz + tolerance * uz)
    return replace(cylinder, bottom=bottom, top=top).inside(points)


def near_sphere(sphere: Sphere, points: Array, tolerance: float) -> Array:
    """Which points (n, 3) lie within a tolerance of the sphere's surface."""
    near = replace(sphere, radius=sphere.radius + tolerance).inside(points)
    if sphere.radius > tolerance:
        near &= ~replace(sphere, radius=sphere.radius - tolerance).inside(points)
    return near
