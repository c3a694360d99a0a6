"""The one place where numba is told about this program: tensors, lanes, generic functions, options, and the cache.

Import :func:`kernel` or :func:`kernel_with_scratch` from here to compile a function.
"""

import solver.jit.generics  # noqa: F401 - tells numba what the solver declared
from solver.jit.compile import kernel, kernel_with_scratch

__all__ = ["kernel", "kernel_with_scratch"]
