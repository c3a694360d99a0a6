"""The one place where numba is told about this program: tensors, lanes, generic functions, options, and the cache.

Import :func:`kernel` from here to compile a function.
"""

from solver.jit.compile import kernel  # first, as it imports numba as it should be

# isort: split
import solver.jit.generics  # noqa: F401 - tells numba what the solver declared

__all__ = ["kernel"]
