"""Kernels that are called in every step with values of the same types.

To look at the types of all arrays in a record takes longer than what many a kernel does.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

from solver.jit.cache import Kernel

# isort: split
from numba import typeof
from numba._dispatcher import compute_fingerprint


class Calls:
    """Calls kernels, looking at the types of values at the first call of each only.

    Whoever calls a kernel so gives it records of one class and arrays of one kind each time; records of a class have
    arrays of the same kinds, one row after the other.

    Attributes
    ----------
    checks : look at the types each time, and raise a TypeError where they are others; for tests.
    """

    checks: ClassVar[bool] = False

    def __init__(self) -> None:
        self._known: dict[Kernel, Callable[..., Any]] = {}
        self._types: dict[Kernel, Any] = {}

    def __call__(self, kernel: Any, *values: Any) -> Any:
        """What the kernel returns for the values."""
        known = self._known.get(kernel)
        if known is None:
            known = self._known[kernel] = kernel.for_types_of(*values)
        if self.checks:
            self._check(kernel, values)
        return known(*values)

    def _check(self, kernel: Any, values: tuple[Any, ...]) -> None:
        types = _types_of(values)
        if self._types.setdefault(kernel, types) != types:
            raise TypeError(f"{kernel.__name__} is called with values of other types than before")


def _types_of(values: tuple[Any, ...]) -> Any:
    """The types of values, as numba tells them apart: soon, where it knows how, else by looking at each part."""
    try:
        return compute_fingerprint(values)
    except NotImplementedError:
        return tuple(map(typeof, values))
