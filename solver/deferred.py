"""Kernels beside what they belong to, in modules that can be imported without numba."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


def deferred_kernel(function: Function) -> Function:
    """A ``kernel`` that is compiled, or taken from the disk cache, when it is first called."""

    @functools.cache
    def compiled() -> Any:
        from solver.jit import kernel

        return kernel(function)

    @functools.wraps(function)
    def call(*args: Any) -> Any:
        return compiled()(*args)

    call.for_types_of = lambda *values: compiled().for_types_of(*values)  # type: ignore[attr-defined]  # as a Kernel has it
    return call  # type: ignore[return-value]  # same signature by wraps


def directly(kernel: Callable[..., Any], *values: Any) -> Any:
    """Call a kernel. In steps ``solver.jit.calls.Calls`` takes the place of this, which looks at types each time."""
    return kernel(*values)
