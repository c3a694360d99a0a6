"""Boundary conditions as a deck writes them: faces, parts of faces, and what is prescribed there."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.boundary_conditions import Condition, Region
from solver.grid import FACES
from ups.deck import BoundaryConditionSection, BoundaryType, Face

Array = NDArray[Any]
Complain = Callable[[str, str, Any], Exception]
"""(code, message, record) -> the exception to raise for a record of the deck."""

SHAPES = ("circle", "annulus", "ellipse", "rectangle", "rectangulus")
KINDS = {"velocity": "Velocity", "symmetric": "Symmetric", "temperature": "Temperature", "sd-type": "SD-Type"}


def regions(section: BoundaryConditionSection, materials: int, complain: Complain) -> list[Region]:
    """The face regions of a deck with their conditions, in its order."""
    return [_region(face, materials, complain) for face in section.Face]


def _region(face: Face, materials: int, complain: Complain) -> Region:
    given = [name for name in ("side", *SHAPES) if getattr(face, name)]
    if len(given) != 1:
        raise complain("UPS106", f"<Face> needs one of side, {', '.join(SHAPES)}; it has {len(given)}", face)
    name = getattr(face, given[0])
    if name not in FACES:
        raise complain("UPS209", f"unknown face {name!r}; faces are {', '.join(FACES)}", face)
    axis = FACES.index(name) // 2
    conditions = tuple(
        condition
        for boundary in face.BCType
        if (condition := _condition(boundary, materials, complain)) is not None
    )
    shape = None if given[0] == "side" else _shape(face, given[0], axis, complain)
    return Region(name, conditions, shape)


def _condition(boundary: BoundaryType, materials: int, complain: Complain) -> Condition | None:
    """The condition, or None for one that concerns other methods (pressure of a gas and the like)."""
    label = KINDS.get(boundary.label.lower(), "")
    if not label:
        return None
    material = _material(boundary, materials, complain)
    kind = boundary.var.strip()
    if label == "Symmetric":
        return Condition(label, "symmetry", material, (0.0, 0.0, 0.0))
    if kind not in ("Dirichlet", "Neumann"):
        return None
    width = 3 if label == "Velocity" else 1
    values = _numbers(boundary.value)
    if width == 3 and values is not None and len(values) == 1:
        return None  # as in Uintah, a number where a velocity belongs has no effect; lint says so
    if values is None or len(values) != width:
        form = "[vx, vy, vz]" if width == 3 else "a number"
        raise complain(
            "UPS207", f"the <value> of {boundary.label} must be {form}: {boundary.value!r}", boundary
        )
    v = values if width == 3 else values * 3
    return Condition(label, kind, material, (v[0], v[1], v[2]))


def _material(boundary: BoundaryType, materials: int, complain: Complain) -> int:
    text = boundary.id.strip()
    if text == "all":
        return -1
    if re.fullmatch(r"\d+", text) and int(text) < materials:
        return int(text)
    raise complain("UPS402", f"id={text!r}: there are materials 0 to {materials - 1}, or all", boundary)


def _numbers(text: str) -> list[float] | None:
    try:
        return [float(word) for word in re.split(r"[,\s]+", text.strip().strip("[]").strip()) if word]
    except ValueError:
        return None


def _point(face: Face, name: str, complain: Complain) -> Array:
    values = _numbers(getattr(face, name))
    if values is None or len(values) != 3:
        raise complain("UPS207", f"{name} of <Face> must be three numbers", face)
    return np.array(values)


def _shape(face: Face, kind: str, axis: int, complain: Complain) -> Callable[[Array], Array]:
    """Which points of the face's plane are in a region; the component across the plane does not count."""
    plane = [a for a in range(3) if a != axis]

    def corners(lower: str, upper: str) -> tuple[Array, Array]:
        return _point(face, lower, complain)[plane], _point(face, upper, complain)[plane]

    if kind in ("rectangle", "rectangulus"):
        outer = corners("lower", "upper") if kind == "rectangle" else corners("outer_lower", "outer_upper")
        inner = None if kind == "rectangle" else corners("inner_lower", "inner_upper")
        return lambda points: (
            _in_box(points[:, plane], *outer)
            & (True if inner is None else ~_in_box(points[:, plane], *inner))
        )
    origin = _point(face, "origin", complain)[plane]
    if kind == "ellipse":
        return lambda points: _in_ellipse(points[:, plane] - origin, face)
    low, high = (0.0, face.radius) if kind == "circle" else (face.inner_radius, face.outer_radius)
    if high <= low:
        raise complain(
            "UPS208", f"the radius of the {kind} must be positive, the outer above the inner", face
        )
    return lambda points: _in_ring(points[:, plane] - origin, low, high)


def _in_box(points: Array, lower: Array, upper: Array) -> Array:
    return np.asarray(np.all((points >= lower) & (points <= upper), axis=1))


def _in_ring(offset: Array, inner: float, outer: float) -> Array:
    r2 = (offset**2).sum(axis=1)
    return np.asarray((r2 <= outer * outer) & (r2 >= inner * inner))


def _in_ellipse(offset: Array, face: Face) -> Array:
    angle = np.radians(face.angle)
    along = offset[:, 0] * np.cos(angle) + offset[:, 1] * np.sin(angle)
    across = offset[:, 1] * np.cos(angle) - offset[:, 0] * np.sin(angle)
    return np.asarray((along / face.major_radius) ** 2 + (across / face.minor_radius) ** 2 <= 1.0)
