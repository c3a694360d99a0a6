"""Load curves: how a load changes with time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solver.declare import Parameter

ALL_MATERIALS = -99
"""Value of ``<material>`` of a load curve that acts on every material."""


@dataclass(frozen=True)
class TimePoint:
    """One point of a load curve."""

    time: Annotated[float, Parameter("time of the point", unit="s")]
    load: Annotated[float, Parameter("load at that time, in the unit of the load it belongs to")]


@dataclass(frozen=True)
class LoadCurve:
    """Load against time: straight lines between the points, constant before the first and after the last.

    Uintah continues the first line backwards to times before the first point; a load that nobody asked for
    would act there, so the first value is held instead. The two agree for curves that start at time 0.

    Raises
    ------
    ValueError : there is no point, the times do not increase, or one after the first is negative.
    """

    id: Annotated[int, Parameter("number of the curve; p.loadCurveID holds it", ge=1)]
    time_point: Annotated[tuple[TimePoint, ...], Parameter("points of the curve in order of time")]
    material: Annotated[
        int, Parameter("index of the material that the load acts on; -99 for all of them")
    ] = ALL_MATERIALS

    def __post_init__(self) -> None:
        if not self.time_point:
            raise ValueError(f"load curve {self.id} has no <time_point>: give at least one time and load")
        for number, (before, after) in enumerate(pairwise(self.time_point), start=2):
            if not after.time > before.time:
                raise ValueError(
                    f"load curve {self.id}: time {after.time:g} of point {number} does not exceed time "
                    f"{before.time:g} of point {number - 1}: put the points in order of time, each time once"
                )
            if after.time < 0.0:
                raise ValueError(
                    f"load curve {self.id}: time {after.time:g} of point {number} is negative: "
                    "runs start at time 0"
                )

    @cached_property
    def _table(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        times = np.array([point.time for point in self.time_point])
        return times, np.array([point.load for point in self.time_point])

    def at(self, time: ArrayLike) -> Any:
        """The load at one or many times; a number gives a number, an array an array of its shape."""
        times, loads = self._table
        if len(times) == 1:
            return np.full(np.shape(time), loads[0])[()]
        t = np.clip(time, times[0], times[-1])
        after = np.clip(np.searchsorted(times, t), 1, len(times) - 1)
        left = (times[after] - t) / (times[after] - times[after - 1])
        return loads[after - 1] * left + loads[after] * (1.0 - left)

    def acts_on(self, material: int) -> bool:
        """Whether the particles of a material (by index) can carry the load."""
        return self.material in (material, ALL_MATERIALS)
