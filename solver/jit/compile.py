"""How functions are compiled: numba's options, and where compiled kernels are kept.

Compiled kernels are kept in a folder of the user's cache named after the state of the solver's sources, so that a
change in any model file makes new kernels.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar


def _cache_directory() -> Path:
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ups-mpm"
    root = Path(__file__).parent.parent
    stamp = hashlib.sha256()
    for file in sorted(root.rglob("*.py")):
        status = file.stat()
        stamp.update(f"{file.relative_to(root)} {status.st_mtime_ns} {status.st_size}\n".encode())
    return base / stamp.hexdigest()[:16]


os.environ.setdefault("NUMBA_CACHE_DIR", str(_cache_directory()))


@contextmanager
def _without(package: str) -> Iterator[None]:
    """Make a package look absent to what is imported inside."""
    absent = package not in sys.modules
    if absent:
        sys.modules[package] = None  # type: ignore[assignment]  # Python's way to say: not to be found
    yield
    if absent:
        del sys.modules[package]


import numba  # noqa: E402 - the cache folder has to be known before numba is imported

# For a numba that was imported before this module, and so did not read the environment set above.
numba.config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]

with _without("scipy.linalg"):  # half a second of start-up to find a BLAS that no kernel here uses
    import numba.np.arraymath

OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "nsz"}}
"""Division by zero gives inf as in numpy. Sums are not reordered and divisions not replaced: where a particle just
touches a node, the last digit of its position decides whether the node takes part, as it does in Uintah."""

INLINED = {**OPTIONS, "forceinline": True}
"""Models and helpers are made part of the kernel that calls them: stresses take half to a fifth of the time."""

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile a function with numba for whatever models it is called with, cached on disk across runs.

    While it runs, other threads of Python go on. It can make no arrays: so references to arrays are not counted, which
    otherwise costs more than the work of a short loop.
    """
    return numba.njit(cache=True, nogil=True, no_cfunc_wrapper=True, _nrt=False, **OPTIONS)(function)


def kernel_with_scratch(function: Function) -> Function:
    """As :func:`kernel`, for a function that makes arrays for its own use."""
    return numba.njit(cache=True, nogil=True, no_cfunc_wrapper=True, **OPTIONS)(function)
