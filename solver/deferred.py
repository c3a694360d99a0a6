"""Kernels beside what they belong to, in modules that can be imported without numba."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


def deferred_kernel(function: Function) -> Function:
    """A ``kernel`` that is compiled, or taken from the disk cache, when it is first called."""

    @functools.cache
    def compiled() -> Callable[..., Any]:
        from solver.jit import kernel

        return kernel(function)

    @functools.wraps(function)
    def call(*args: Any) -> Any:
        return compiled()(*args)

    return call  # type: ignore[return-value]  # same signature by wraps
