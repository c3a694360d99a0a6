"""Kernels that are called in every step with values of the same types.

To look at the types of all arrays in a record takes longer than what many a kernel does.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

from solver.jit.cache import Kernel

# isort: split
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
        self._known: dict[Kernel, tuple[Callable[..., Any], bytes]] = {}

    def __call__(self, kernel: Any, *values: Any) -> Any:
        """What the kernel returns for the values."""
        known = self._known.get(kernel)
        if known is None:
            known = self._known[kernel] = (kernel.for_types_of(*values), compute_fingerprint(values))
        elif self.checks and compute_fingerprint(values) != known[1]:
            raise TypeError(f"{kernel.__name__} is called with values of other types than before")
        return known[0](*values)
