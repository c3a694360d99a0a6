"""How functions are compiled: numba's options."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import solver.jit.library  # noqa: F401 - tells numba what to make machine code of
from solver.jit.cache import Kernel

OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "nsz"}}
"""Division by zero gives inf as in numpy. Sums are not reordered and divisions not replaced: where a particle just
touches a node, the last digit of its position decides whether the node takes part, as it does in Uintah."""

INLINED = {**OPTIONS, "forceinline": True, "no_cfunc_wrapper": True}
"""Models and helpers are made part of the kernel that calls them: stresses take half to a fifth of the time. C calls
none of them, so they need no second form for it."""

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile a function with numba for whatever models it is called with, cached on disk across runs.

    While it runs, other threads of Python go on. It can make no arrays but those of ``solver.scratch``: so references
    to arrays are not counted, which otherwise costs more than the work of a short loop.
    """
    always = {"nopython": True, "boundscheck": None, "nogil": True, "no_cfunc_wrapper": True, "_nrt": False}
    return Kernel(function, targetoptions={**always, **OPTIONS})
