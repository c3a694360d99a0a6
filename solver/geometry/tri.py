"""Bodies given by their surface, as a mesh of triangles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, OpenFile, as_vector
from solver.geometry.read_table import find_file, read_table

EDGE = 1.0e-8
"""How far outside a triangle, in its own coordinates, a line still meets it, so that none slips through."""

SAME_HIT = 2.0e-8
"""Hits of a line nearer to each other than this, over the size of the surface, are one hit on an edge."""

CANDIDATES = 2_000_000
"""Pairs of a line and a triangle that are looked at together."""


class Hits(NamedTuple):
    """Where lines along an axis meet a surface, sorted by line and height."""

    line: Array
    height: Array


@model("geometry", "tri")
@dataclass(frozen=True)
class Tri(GeometryPiece):
    """The inside of a closed surface of triangles.

    A point is inside if a line from it in a direction of an axis meets the surface an odd number of times,
    by the majority of the directions x, y and z, so that lines that just touch an edge do no harm.
    """

    name: Annotated[
        str, Parameter("files name.pts (x y z of each point) and name.tri (three point numbers from 0)")
    ]
    points: Array | None = field(default=None, repr=False, compare=False)
    triangles: Array | None = field(default=None, repr=False, compare=False)

    def load(self, open_file: OpenFile) -> Tri:
        """The piece with its mesh; ValueError if a file is missing or wrong."""
        points = read_table(find_file(open_file, f"{self.name}.pts", "the points of the surface"), 3)
        path = find_file(open_file, f"{self.name}.tri", "the triangles of the surface")
        triangles = read_table(path, 3, int)
        wrong = np.flatnonzero(((triangles < 0) | (triangles >= len(points))).any(axis=1))
        if len(wrong):
            row = " ".join(map(str, triangles[wrong[0]]))
            raise ValueError(
                f"{path}: triangle {wrong[0] + 1} ({row}) names a point that is not there: "
                f"there are {len(points)}, counted from 0"
            )
        return replace(self, points=points, triangles=triangles)

    def mesh(self) -> tuple[Array, Array]:
        """Points (n, 3) and triangles (m, 3); ValueError before they are loaded."""
        if self.points is None or self.triangles is None:
            raise ValueError(f"the surface {self.name!r} has not been read")
        return self.points, self.triangles

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the surface."""
        votes = np.zeros(len(points), int)
        for axis in range(3):
            across = [a for a in range(3) if a != axis]
            hits = self.hits(axis, points[:, across])
            above = hits.height > points[hits.line, axis]
            votes += np.bincount(hits.line[above], minlength=len(points)) % 2
        return votes >= 2

    def on_lattice(self, x: Array, y: Array, z: Array) -> Array:
        """Whether lattice points lie in the surface: one line for each row of points."""
        axes = (x, y, z)
        votes = np.zeros((len(x), len(y), len(z)), np.int8)
        for axis in range(3):
            first, second = (axes[a] for a in range(3) if a != axis)
            lines = np.stack([g.ravel() for g in np.meshgrid(first, second, indexing="ij")], axis=1)
            hits = self.hits(axis, lines)
            # A hit turns all points of the row below it; it is the reversed running sum that counts them.
            turns = np.zeros((len(lines), len(axes[axis]) + 1), np.int32)
            np.add.at(turns, (hits.line, np.searchsorted(axes[axis], hits.height, "left")), 1)
            above = turns[:, ::-1].cumsum(axis=1)[:, ::-1][:, 1:]
            odd = (above % 2).astype(np.int8).reshape(len(first), len(second), -1)
            votes += np.moveaxis(odd, 2, axis)
        return (votes >= 2).transpose(2, 1, 0)

    def bounding_box(self) -> BoundingBox:
        """The box around the mesh."""
        points, _ = self.mesh()
        return BoundingBox(as_vector(points.min(axis=0)), as_vector(points.max(axis=0)))

    def hits(self, axis: int, lines: Array) -> Hits:
        """Where lines along an axis meet the surface; ``lines`` (n, 2) are their two other coordinates."""
        points, triangles = self.mesh()
        across = [a for a in range(3) if a != axis]
        corner, second, third = (points[triangles[:, c]] for c in range(3))
        found = []
        for line, triangle in _pairs(lines, points[triangles][:, :, across]):
            origin = corner[triangle]
            b, c = second[triangle] - origin, third[triangle] - origin
            w0, w1 = (lines[line] - origin[:, across]).T
            b0, b1, c0, c1 = *b[:, across].T, *c[:, across].T
            with np.errstate(divide="ignore", invalid="ignore"):  # triangles seen edge-on: no hit
                u = (w0 * c1 - w1 * c0) / (b0 * c1 - b1 * c0)
                v = (w1 * b0 - w0 * b1) / (b0 * c1 - b1 * c0)
                met = (u >= -EDGE) & (v >= -EDGE) & (u + v <= 1.0 + EDGE)
            height = u * b[:, axis] + v * c[:, axis] + origin[:, axis]
            found.append((line[met], height[met]))
        line = np.concatenate([f[0] for f in found] or [np.zeros(0, int)])
        height = np.concatenate([f[1] for f in found] or [np.zeros(0)])
        order = np.lexsort((height, line))
        line, height = line[order], height[order]
        near = SAME_HIT * np.ptp(points, axis=0).max()
        fresh = np.ones(len(line), bool)
        fresh[1:] = (line[1:] != line[:-1]) | (height[1:] - height[:-1] > near)
        return Hits(line[fresh], height[fresh])


def _pairs(lines: Array, corners: Array) -> Iterator[tuple[Array, Array]]:
    """Lines (n, 2) and triangles (m, 3, 2), seen along the lines, whose bounding rectangle holds the line.

    The lines are sorted into square bins, and each triangle is paired with those in the bins that it covers.
    Yields index arrays (line, triangle), a limited number of pairs at a time.
    """
    low, high = corners.min(axis=1), corners.max(axis=1)
    origin = low.min(axis=0)
    extent = np.maximum(high.max(axis=0) - origin, np.finfo(float).tiny)
    bins = max(1, int(np.sqrt(len(lines))))

    def bin_of(place: Array) -> Array:
        scaled = (place - origin) / extent * bins
        return np.clip(scaled, -1.0, bins).astype(np.int64).clip(0, bins - 1)

    bin_x, bin_y = bin_of(lines).T
    order = np.argsort(bin_x * bins + bin_y, kind="stable")
    start = np.searchsorted((bin_x * bins + bin_y)[order], np.arange(bins * bins + 1))
    first, last = bin_of(low), bin_of(high)
    # Bins of one row lie together, so a triangle covers one run of sorted lines in each row.
    rows = last[:, 0] - first[:, 0] + 1
    triangle = np.repeat(np.arange(len(corners)), rows)
    row = _counted(rows) + first[triangle, 0]
    begin = start[row * bins + first[triangle, 1]]
    count = start[row * bins + last[triangle, 1] + 1] - begin
    total = np.concatenate([[0], np.cumsum(count)])
    cuts = np.searchsorted(total, np.arange(0, total[-1] + CANDIDATES, CANDIDATES), "left")
    for a, b in pairwise(cuts):
        line = order[np.repeat(begin[a:b], count[a:b]) + _counted(count[a:b])]
        paired = np.repeat(triangle[a:b], count[a:b])
        place = lines[line]
        held = np.all((place >= low[paired]) & (place <= high[paired]), axis=1)
        yield line[held], paired[held]


def _counted(lengths: Array) -> Array:
    """0, 1, .. n - 1 for each length n, one after the other."""
    ends = np.cumsum(lengths)
    return np.arange(ends[-1] if len(ends) else 0) - np.repeat(ends - lengths, lengths)
