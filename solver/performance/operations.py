"""Counting the operations on numbers that a function of Python makes.

Kernels are functions of Python before numba compiles them. Called with numbers of :class:`Counted`, they do the same
and leave a count: sums, differences, products, quotients and powers are one each; what ``math`` computes (``exp``,
``log``, ``sqrt``) and comparisons are not counted.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np


class Counted(np.float64):
    """A number that counts the operations made with it, all together in ``Counted.operations``."""

    operations = 0


def _counting(name: str) -> Callable[[Any, Any], Any]:
    plain = getattr(np.float64, name)

    def operation(a: Any, b: Any) -> Any:
        if not isinstance(b, (int, float)):
            return NotImplemented  # such as a tensor, which knows how to be multiplied
        Counted.operations += 1
        return Counted(plain(a, float(b)))

    return operation


def _counted_result(name: str) -> Callable[[Any], Any]:
    plain = getattr(np.float64, name)
    return lambda a: Counted(plain(a))


for _name in ("add", "sub", "mul", "truediv", "pow"):
    setattr(Counted, f"__{_name}__", _counting(f"__{_name}__"))
    setattr(Counted, f"__r{_name}__", _counting(f"__r{_name}__"))
for _name in ("__neg__", "__abs__", "__pos__"):
    setattr(Counted, _name, _counted_result(_name))


def counted(values: Any) -> Any:
    """The same numbers, arrays or NamedTuples of these, of the class :class:`Counted`; others as they are.

    Arrays are copied, so that the function may change them.
    """
    if isinstance(values, np.ndarray):
        if values.dtype != np.float64:
            return values.copy()
        numbers = np.empty(values.shape, object)
        numbers[...] = np.vectorize(Counted, otypes=[object])(values) if values.size else 0.0
        return numbers
    if isinstance(values, tuple):
        parts = [counted(value) for value in values]
        return type(values)(*parts) if hasattr(values, "_fields") else tuple(parts)
    return Counted(values) if isinstance(values, float) else values


def operations_of(function: Callable[..., Any], *arguments: Any) -> int:
    """Call a function with counted copies of its arguments; how many operations it made.

    Raises
    ------
    ArithmeticError, ValueError
        where Python refuses what compiled code answers with inf or nan, such as a logarithm of 0.
    """
    given = counted(arguments)
    before = Counted.operations
    with np.errstate(all="ignore"):
        function(*given)
    return Counted.operations - before
