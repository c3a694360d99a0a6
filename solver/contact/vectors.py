"""Three-vectors as tuples, for nodal kernels that read like their equations."""

from __future__ import annotations

import math
from typing import Any

from solver.declare import Vector
from solver.dispatch import inline


@inline
def vector_at(array: Any, n: int) -> Vector:
    """The n-th vector of an array of shape (N, 3)."""
    return (array[n, 0], array[n, 1], array[n, 2])


@inline
def put_vector(array: Any, n: int, a: Vector) -> None:
    """Store a vector as the n-th of an array of shape (N, 3)."""
    array[n, 0] = a[0]
    array[n, 1] = a[1]
    array[n, 2] = a[2]


@inline
def plus(a: Vector, b: Vector) -> Vector:
    """The sum a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@inline
def minus(a: Vector, b: Vector) -> Vector:
    """The difference a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@inline
def times(s: float, a: Vector) -> Vector:
    """The product s a."""
    return (s * a[0], s * a[1], s * a[2])


@inline
def over(a: Vector, s: float) -> Vector:
    """The quotient a / s."""
    return (a[0] / s, a[1] / s, a[2] / s)


@inline
def dot(a: Vector, b: Vector) -> float:
    """The inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inline
def cross(a: Vector, b: Vector) -> Vector:
    """The vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inline
def length(a: Vector) -> float:
    """The Euclidean norm."""
    return math.sqrt(dot(a, a))
