"""Arrays that live as long as the call of a kernel, of lengths that are known when it is compiled.

In kernels they lie on the stack: nothing is allocated, and they must not be returned from the kernel.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def scratch_numbers(count: int, dtype: Any) -> Any:
    """An array (count,) with anything in it."""
    return np.empty(count, dtype)


def scratch_rows(count: int, width: int) -> Any:
    """An array of numbers (count, width) with anything in it."""
    return np.empty((count, width))
