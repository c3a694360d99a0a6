"""Hollow cylinders whose particles lie in rings instead of on the lattice of cells."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from solver.declare import Parameter, Vector, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, difference, dot, relative_to

SMALLEST_SHARE = 0.05
"""Pie slices get wider until their particles take this share of a cell."""


class _Rings(NamedTuple):
    """Rings of particles in a stack of layers along the axis."""

    start: float
    """Where the stack begins, from the bottom along the axis."""
    length: float
    layers: int
    inner: float
    outer: float
    sectors: tuple[int, ...]
    """Particles around in each ring, from the inside out."""


@model("geometry", "smoothcyl")
@dataclass(frozen=True)
class SmoothCylinder(GeometryPiece):
    """A hollow cylinder, or a sector of one, cut into layers, rings and sectors with a particle in each.

    Its particles have their own volumes and vectors (tangential, radial, axial). Where an axis is not along
    x, y or z, and in the end caps, Uintah puts particles in wrong places; here they are where they belong.
    """

    discretization_scheme: Annotated[
        str,
        Parameter(
            "pie_slices: the same number of sectors in each ring; constant_particle_volumes: as many as make "
            "particles about as wide as a ring",
            choices=("pie_slices", "constant_particle_volumes"),
        ),
    ]
    bottom: Annotated[Vector, Parameter("centre of one end", unit="m")]
    top: Annotated[Vector, Parameter("centre of the other end", unit="m")]
    outer_radius: Annotated[float, Parameter("outer radius", unit="m", gt=0.0)]
    num_radial: Annotated[int, Parameter("number of rings", ge=1)]
    num_axial: Annotated[int, Parameter("number of layers", ge=1)]
    num_angular: Annotated[int, Parameter("number of sectors, for pie_slices", ge=0)] = 0
    inner_radius: Annotated[float, Parameter("inner radius", unit="m", ge=0.0)] = 0.0
    endcap_thickness: Annotated[float, Parameter("thickness of solid end caps", unit="m", ge=0.0)] = 0.0
    arc_start_angle: Annotated[
        float, Parameter("angle at which the sector begins", unit="degree", ge=0.0, le=360.0)
    ] = 0.0
    arc_angle: Annotated[
        float, Parameter("angle at which the sector ends", unit="degree", gt=0.0, le=360.0)
    ] = 360.0
    output_file: Annotated[
        str, Parameter("file for the particles", ignored="the archive holds the particles")
    ] = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not math.dist(self.bottom, self.top) > 0.0:
            raise ValueError("top and bottom are the same point; a cylinder needs a length")
        if not self.inner_radius < self.outer_radius:
            raise ValueError(
                f"inner_radius is {self.inner_radius:g}; it must be less than outer_radius, which is "
                f"{self.outer_radius:g}"
            )
        if self.discretization_scheme == "pie_slices" and self.num_angular < 1:
            raise ValueError("pie_slices needs num_angular, at least 1")
        if not self.arc_angle > self.arc_start_angle:
            raise ValueError(
                f"arc_angle, where the sector ends, is {self.arc_angle:g}; it must be greater than "
                f"arc_start_angle, which is {self.arc_start_angle:g}"
            )

    @property
    def length(self) -> float:
        """Length without end caps."""
        return math.dist(self.bottom, self.top)

    @property
    def axis(self) -> Vector:
        """Unit vector from bottom to top."""
        x, y, z = difference(self.top, self.bottom)
        return (x / self.length, y / self.length, z / self.length)

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the cylinder or its caps, whole circles even where it is a sector.

        The outer surface is included, the inner one is not.
        """
        ax, ay, az = self.axis
        x, y, z = relative_to(points, self.bottom)
        along = x * ax + y * ay + z * az
        distance2 = (ay * z - az * y) ** 2 + (az * x - ax * z) ** 2 + (ax * y - ay * x) ** 2
        cap = self.endcap_thickness
        within = (along >= -cap) & (along <= self.length + cap) & (distance2 <= self.outer_radius**2)
        in_cap = (along < 0.0) | (along > self.length)
        return within & (in_cap | (distance2 > self.inner_radius**2))

    def bounding_box(self) -> BoundingBox:
        """A box around the cylinder and its caps."""
        reach = self.outer_radius + self.endcap_thickness
        pairs = list(zip(self.bottom, self.top, strict=True))
        x, y, z = ((min(b, t) - reach, max(b, t) + reach) for b, t in pairs)
        return BoundingBox((x[0], y[0], z[0]), (x[1], y[1], z[1]))

    def particles(self, spacing: Vector, tetrahedral: bool) -> dict[str, Array]:
        """Positions, volumes and vectors: layer by layer, in each ring by ring, in each sector by sector.

        ``tetrahedral`` has no meaning for this piece.
        """
        stacks = [*self._end_caps(), self._wall(spacing)]
        parts = [self._stack(rings, np.array(spacing)) for rings in stacks]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def _wall(self, spacing: Vector) -> _Rings:
        arc = math.radians(self.arc_angle) - math.radians(self.arc_start_angle)
        width = (self.outer_radius - self.inner_radius) / self.num_radial
        layer = self.length / self.num_axial
        sectors = []
        for ring in range(self.num_radial):
            radius = self.inner_radius + (ring + 0.5) * width
            if self.discretization_scheme == "constant_particle_volumes":
                sectors.append(max(int(arc * radius / width), 1))
                continue
            number, share = self.num_angular, 1.0
            smallest = SMALLEST_SHARE * spacing[0] * spacing[1] * spacing[2]
            while number > 1 and arc * radius * width * layer / number < smallest:
                share *= 0.9
                number = max(int(self.num_angular * share), 1)
            sectors.append(number)
        return _Rings(0.0, self.length, self.num_axial, self.inner_radius, self.outer_radius, tuple(sectors))

    def _end_caps(self) -> list[_Rings]:
        """Solid discs, with layers about as thick as those of the wall and particles as wide as a ring."""
        cap = self.endcap_thickness
        if cap == 0.0:
            return []
        arc = math.radians(self.arc_angle) - math.radians(self.arc_start_angle)
        layers = max(1, round(cap * self.num_axial / self.length))
        sectors = tuple(max(int(arc * (ring + 0.5)), 1) for ring in range(self.num_radial))
        return [_Rings(start, cap, layers, 0.0, self.outer_radius, sectors) for start in (-cap, self.length)]

    def _stack(self, rings: _Rings, spacing: Array) -> dict[str, Array]:
        """The particles of a stack of rings."""
        start_angle = math.radians(self.arc_start_angle)
        arc = math.radians(self.arc_angle) - start_angle
        width = (rings.outer - rings.inner) / len(rings.sectors)
        layer = rings.length / rings.layers
        inner = np.repeat(rings.inner + np.arange(len(rings.sectors)) * width, rings.sectors)
        step = np.repeat([arc / n for n in rings.sectors], rings.sectors)
        angle = start_angle + (np.concatenate([np.arange(n) for n in rings.sectors]) + 0.5) * step
        radius = inner + 0.5 * width
        area = 0.5 * step * ((inner + width) ** 2 - inner**2)
        zero = np.zeros_like(angle)
        x, y = radius * np.cos(angle), radius * np.sin(angle)
        vectors = np.array(
            [
                [step * y, width * x / radius, zero],
                [-step * x, width * y / radius, zero],
                [zero, zero, zero + layer],
            ]
        ).transpose(2, 0, 1)
        turn, relabel = self._turn()
        ring_positions = np.stack([x, y, zero], axis=1) @ turn.T
        heights = rings.start + (np.arange(rings.layers) + 0.5) * layer
        centres = np.array(self.bottom) + np.outer(heights, self.axis)
        size = turn @ vectors @ relabel / spacing[:, None]
        return {
            "position": (centres[:, None] + ring_positions).reshape(-1, 3),
            "volume": np.tile(layer * area, rings.layers),
            "size": np.tile(size, (rings.layers, 1, 1)),
        }

    def _turn(self) -> tuple[Array, Array]:
        """The rotation from z to the axis, and a relabelling of the particle vectors.

        About the axis z x axis by Rodrigues' formula. Uintah turns the other way round and relabels the
        vectors by the rotation, which gives the same cylinder when the axis is along x, y or z: then it is
        followed, so that particles come in the same order and vectors stay beside the grid's directions.
        """
        cosine = dot((0.0, 0.0, 1.0), self.axis)
        ax, ay, _ = self.axis
        sine = math.hypot(ax, ay)
        if sine == 0.0:
            return cosine * np.eye(3), cosine * np.eye(3)
        about = np.array([-ay, ax, 0.0]) / sine
        cross = np.array([[0.0, 0.0, about[1]], [0.0, 0.0, -about[0]], [-about[1], about[0], 0.0]])
        turn = cosine * np.eye(3) + sine * cross + (1.0 - cosine) * np.outer(about, about)
        if max(map(abs, self.axis)) == 1.0:
            return turn.T, turn
        return turn, np.eye(3)
