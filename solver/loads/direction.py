"""In which direction a load pushes a particle: the laws that the kernels are compiled for."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from solver.declare import Vector
from solver.dispatch import generic, implements, inline
from solver.tensor import Tensor


class Components(NamedTuple):
    """A vector as the kernels handle it."""

    x: float
    y: float
    z: float


@generic
def force_for_unit_load(law: Any, p: int, x: Components, normals: Any) -> Components:  # type: ignore[empty-body]  # bodies come from the laws
    """Force on particle ``p`` at ``x`` for a load of one; ``normals`` (n, 3) are those of particle files."""


@generic
def surface_normal(law: Any, p: int, x: Components, normals: Any) -> Components:  # type: ignore[empty-body]  # bodies come from the laws
    """Normal of the loaded surface at a particle, of either sign and any length."""


@inline
def cross(a: Components, b: Components) -> Components:
    """The vector product."""
    return Components(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@inline
def length(a: Components) -> float:
    """The Euclidean length."""
    return math.sqrt(a.x * a.x + a.y * a.y + a.z * a.z)


@inline
def scaled(a: Components, factor: float) -> Components:
    """The vector times a number."""
    return Components(a.x * factor, a.y * factor, a.z * factor)


@inline
def unit(a: Components) -> Components:
    """The vector divided by its length; the null vector stays, for it has no direction to push in."""
    size = length(a)
    if size == 0.0:
        return a
    return Components(a.x / size, a.y / size, a.z / size)


@inline
def turned(R: Tensor, a: Components) -> Components:
    """The vector turned by a rotation."""
    return Components(
        R.xx * a.x + R.xy * a.y + R.xz * a.z,
        R.yx * a.x + R.yy * a.y + R.yz * a.z,
        R.zx * a.x + R.zy * a.y + R.zz * a.z,
    )


@inline
def from_axis(origin: Vector, axis: Vector, x: Components) -> Components:
    """The vector to a point from the nearest point of the line through ``origin`` along ``axis``."""
    d = Components(x.x - origin[0], x.y - origin[1], x.z - origin[2])
    size = math.sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2])
    along = (d.x * axis[0] + d.y * axis[1] + d.z * axis[2]) / size
    return Components(
        d.x - along * axis[0] / size, d.y - along * axis[1] / size, d.z - along * axis[2] / size
    )


class Fixed(NamedTuple):
    """The same direction for every particle: the loaded surface is a plane."""

    direction: Vector


@implements(force_for_unit_load, Fixed)
@implements(surface_normal, Fixed)
def _(law: Fixed, p: int, x: Components, normals: Any) -> Components:
    return Components(law.direction[0], law.direction[1], law.direction[2])


class Radial(NamedTuple):
    """Away from an axis: the loaded surface is the side of a cylinder."""

    origin: Vector
    axis: Vector


@implements(force_for_unit_load, Radial)
@implements(surface_normal, Radial)
def _(law: Radial, p: int, x: Components, normals: Any) -> Components:
    return unit(from_axis(law.origin, law.axis, x))


class Spherical(NamedTuple):
    """Away from a point: the loaded surface is a sphere."""

    centre: Vector


@implements(force_for_unit_load, Spherical)
@implements(surface_normal, Spherical)
def _(law: Spherical, p: int, x: Components, normals: Any) -> Components:
    return unit(Components(x.x - law.centre[0], x.y - law.centre[1], x.z - law.centre[2]))


class WedgeEnd(NamedTuple):
    """The flat end of an axisymmetric body, of which the grid holds a wedge of one radian.

    The force for a unit of pressure is the area that a particle has there: its radius x times its ``width``.
    """

    direction: Vector
    width: float


@implements(force_for_unit_load, WedgeEnd)
def _(law: WedgeEnd, p: int, x: Components, normals: Any) -> Components:
    area = x.x * law.width
    return Components(law.direction[0] * area, law.direction[1] * area, law.direction[2] * area)


@implements(surface_normal, WedgeEnd)
def _(law: WedgeEnd, p: int, x: Components, normals: Any) -> Components:
    return Components(law.direction[0], law.direction[1], law.direction[2])


class AlongNormal(NamedTuple):
    """Along the normal that the particle file gives to each particle."""


@implements(force_for_unit_load, AlongNormal)
@implements(surface_normal, AlongNormal)
def _(law: AlongNormal, p: int, x: Components, normals: Any) -> Components:
    return Components(normals[p, 0], normals[p, 1], normals[p, 2])


class Around(NamedTuple):
    """Around an axis: d / |d|^2 with d = (x - origin) x axis / |axis|, so that a unit load is a unit torque.

    A positive torque turns the body clockwise for one who looks against the axis: its moment vector is
    -axis / |axis|. Particles on the axis get no force.
    """

    origin: Vector
    axis: Vector


@implements(force_for_unit_load, Around)
def _(law: Around, p: int, x: Components, normals: Any) -> Components:
    axis = unit(Components(law.axis[0], law.axis[1], law.axis[2]))
    arm = Components(x.x - law.origin[0], x.y - law.origin[1], x.z - law.origin[2])
    tangent = cross(arm, axis)
    radius = length(tangent)
    if radius == 0.0:
        return tangent
    return scaled(tangent, 1.0 / (radius * radius))


@implements(surface_normal, Around)
def _(law: Around, p: int, x: Components, normals: Any) -> Components:
    return unit(from_axis(law.origin, law.axis, x))
