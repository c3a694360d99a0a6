"""Functions chosen by the class of a model, in Python and in kernels."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from solver.dispatch import generic, implements, inline, lanewise, singly
from solver.jit import kernel
from solver.lanes import Eight, where
from solver.tensor import Tensor, put_tensor, tensor_at


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


class Answer(NamedTuple):
    """All kinds of things that a body can answer."""

    stretch: Tensor
    size: float
    large: bool
    rank: int


@generic
def judged(shape: Any, p: int, stretch: Tensor, size: float, marks: Any) -> Answer:
    """Of a particle."""


@implements(judged, Square)
def _(shape: Square, p: int, stretch: Tensor, size: float, marks: Any) -> Answer:
    if size > shape.side:  # a branch on a number of the particle
        return Answer(stretch * size, size, True, 1)
    marks[p] = size
    return Answer(stretch, -size, False, 2)


@implements(judged, Circle)
@lanewise
def _(shape: Circle, p: int, stretch: Tensor, size: float, marks: Any) -> Answer:
    large = size > shape.radius
    marks[p] = where(large, marks[p], size)
    return Answer(
        where(large, stretch * size, stretch), where(large, size, -size), large, where(large, 1.0, 2.0)
    )


@singly
def steps_to(goal: float, step: float) -> int:
    steps = 0
    while steps * step < goal:
        steps += 1
    return steps


@kernel
def judge_eight(shape, stretches, sizes, marks, results):
    p = Eight(1)
    answer = judged(shape, p, tensor_at(stretches, p), sizes[p], marks)
    put_tensor(stretches, p, answer.stretch)
    results[p, 0] = answer.size
    results[p, 1] = where(answer.large, 10.0, 20.0)
    results[p, 2] = answer.rank
    results[p, 3] = steps_to(sizes[p], 0.25)


@pytest.mark.parametrize("shape", [Square(0.5), Circle(0.5)], ids=lambda shape: type(shape).__name__)
def test_eight_particles_are_asked_at_once_or_one_after_the_other(shape):
    """Whether a body branches or not, the answers are those of each particle."""
    rng = np.random.default_rng(4)
    stretches, sizes = rng.normal(size=(10, 3, 3)), rng.uniform(size=10)
    marks, results = np.zeros(10), np.zeros((10, 4))
    before = stretches.copy()
    judge_eight(shape, stretches, sizes, marks, results)
    eight = slice(1, 9)
    large = sizes[eight] > 0.5
    assert large.any()
    assert not large.all()
    factor = np.where(large, sizes[eight], 1.0)[:, None, None]
    np.testing.assert_array_equal(stretches[eight], before[eight] * factor)
    np.testing.assert_array_equal(marks[eight], np.where(large, 0.0, sizes[eight]))
    np.testing.assert_array_equal(results[eight, 0], np.where(large, sizes[eight], -sizes[eight]))
    np.testing.assert_array_equal(results[eight, 1], np.where(large, 10.0, 20.0))
    np.testing.assert_array_equal(results[eight, 2], np.where(large, 1.0, 2.0))
    np.testing.assert_array_equal(results[eight, 3], np.ceil(sizes[eight] / 0.25))
    assert not results[[0, 9]].any()
    np.testing.assert_array_equal(stretches[[0, 9]], before[[0, 9]])
