"""Arrays that every step needs for a while: made once and kept, so that steps allocate nothing large."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray


class Workspace:
    """Arrays by name, as long as they were ever asked for; each user has names of its own."""

    def __init__(self) -> None:
        self._arrays: dict[str, NDArray[Any]] = {}

    def rows(self, name: str, count: int, dtype: DTypeLike, *width: int) -> NDArray[Any]:
        """An array (count, ..width) with anything in it; the same memory at every call with that name."""
        array = self._arrays.get(name)
        if array is None or len(array) < count or array.shape[1:] != width:
            array = self._arrays[name] = np.empty((count, *width), dtype)
        return array[:count]

    def zeros(self, name: str, count: int, dtype: DTypeLike, *width: int) -> NDArray[Any]:
        """The same, with zeros in it."""
        array = self.rows(name, count, dtype, *width)
        array[:] = 0
        return array
