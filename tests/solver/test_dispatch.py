"""Functions chosen by the class of a model, in Python and in kernels."""

from __future__ import annotations

from typing import Any, NamedTuple

import pytest

from solver.dispatch import generic, implements, inline
from solver.jit import kernel


class Square(NamedTuple):
    side: float


class Circle(NamedTuple):
    radius: float


class Cube(NamedTuple):
    side: float


class Triangle(NamedTuple):
    side: float


@generic
def area(shape: Any, scale: float) -> float:
    """The area of a shape drawn to a scale."""


@inline
def squared(x: float) -> float:
    return x * x


@implements(area, Square, Cube)
def _(shape: Any, scale: float) -> float:
    return squared(shape.side * scale)


@implements(area, Circle)
def circle_area(shape: Circle, scale: float) -> float:
    return 3.0 * squared(shape.radius * scale)


@kernel
def doubled_area(shape, scale):
    return 2.0 * area(shape, scale)


def test_python_chooses_by_the_class_of_the_first_argument():
    assert area(Square(2.0), 3.0) == 36.0
    assert area(Circle(2.0), 1.0) == 12.0
    assert area(Cube(1.0), 2.0) == 4.0
    assert circle_area(Circle(1.0), 1.0) == 3.0


def test_kernels_are_specialised_for_the_class():
    assert doubled_area(Square(2.0), 3.0) == 72.0
    assert doubled_area(Circle(2.0), 1.0) == 24.0
    assert len(doubled_area.signatures) == 2


def test_a_model_without_implementation_is_named():
    with pytest.raises(TypeError, match="area has no implementation for Triangle"):
        area(Triangle(1.0), 1.0)


def test_generic_functions_keep_name_and_documentation():
    assert area.__name__ == "area"
    assert "scale" in area.__doc__
