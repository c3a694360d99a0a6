"""What is doubtful about the loads of a deck without being wrong."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from solver.declare import Vector
from solver.geometry.cylinder import Cylinder
from solver.grid import Grid
from solver.loads.load import Load


class Notice(NamedTuple):
    """Something about a load that its author should know; the run can go on."""

    load: Load
    message: str


def no_particle(load: Load) -> str:
    """What to say of a load that acts on no particle."""
    start = f"load curve {load.load_curve.id} acts on no particle: "
    if load.piece is None:
        return start + "no particle file gives its id as p.loadCurveID"
    return start + (
        f"no surface particle lies near enough to the geom_object of this <{load.tag}>; check that "
        "it touches the body, and its <material>"
    )


def doubts(loads: Sequence[Load], grid: Grid) -> list[Notice]:
    """The notices that need no particles; ``loads`` are in the order in which Uintah numbers them."""
    found = []
    for number, load in enumerate(loads, start=1):
        checks = (_misnumbered(load, number), _late(load), _outside(load, grid))
        found += [Notice(load, message) for message in checks if message]
    return found


def _misnumbered(load: Load, number: int) -> str:
    if load.load_curve.id == number:
        return ""
    return (
        f"load curve {load.load_curve.id} of this <{load.tag}> is number {number} in the order pressure, "
        "pressure_pts, torque, heat_flux; Uintah needs that as its <id>, and would apply another load here"
    )


def _late(load: Load) -> str:
    points = load.load_curve.time_point
    if len(points) == 1 or points[0].time <= 0.0:
        return ""
    return (
        f"load curve {load.load_curve.id} starts at time {points[0].time:g}: its first load is held before "
        "that; Uintah continues the first line backwards"
    )


def _outside(load: Load, grid: Grid) -> str:
    if load.piece is None or not _exceeds(load.piece, grid.anchor, grid.upper):
        return ""
    return (
        f"the geom_object of load curve {load.load_curve.id} reaches out of the domain; its whole area counts"
    )


def _exceeds(piece: Any, lower: Vector, upper: Vector) -> bool:
    """Whether a piece reaches out of the domain; one that is cut to a wedge always does, and is meant to."""
    if isinstance(piece, Cylinder) and (piece.axisymmetric_end or piece.axisymmetric_side):
        return False
    box = piece.bounding_box()
    return any(box.lower[axis] < lower[axis] or box.upper[axis] > upper[axis] for axis in range(3))
