"""UPS505."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.rules.bodies import stable_step
from ups.rules.rule import DeckView, Rule

_MANY_STEPS = 1.0e7
_MANY_FIRST_STEPS = 1.0e4
_SHORT = 1.0e-4
"""A longest step that is so much shorter than the stable one was hardly meant."""


class UnstableStep(Rule):
    """The limits of the time step do not fit the material and the grid.

    **Why.** A wave may cross no more than a cell in a step: dt <= dx / (c + v). ``<delt_min>`` above that
    makes the run unstable. ``<delt_max>`` far below it, or a ``<maxTime>`` of very many steps, make it long.

    **Example.** ``<delt_min>1e-3</delt_min>`` with cells of 1 mm of steel, whose stable step is 2e-7 s.

    **Repair.** Lower ``<delt_min>``; look at the units of time, length and moduli.
    """

    code = register_code("UPS505", "time step does not fit the material")
    title = "time step does not fit the material"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare <Time> with the stable step."""
        if deck.component not in ("mpm", "amrmpm"):
            return
        stable = stable_step(deck)
        least, end = deck.number("Time/delt_min"), deck.number("Time/maxTime")
        largest = deck.number("Time/delt_max")
        at = deck.find("Time/delt_min")
        if stable is None or least is None or at is None or not stable > 0.0:
            return
        if least > stable:
            message = (
                f"<delt_min> is {least:g}, and the stable time step about {stable:.2g}: the run is unstable"
            )
            yield self.warning(message, at, f"set it below {stable:.2g}")
        yield from self._limited(deck, stable, largest)
        usual = min(stable, largest) if largest is not None and largest > 0.0 else stable
        steps = (end or 0.0) / usual
        at_end = deck.find("Time/maxTime")
        if at_end is not None and steps > _MANY_STEPS and not deck.number("Time/max_Timesteps"):
            message = f"the run takes about {steps:.1e} steps of {usual:.2g}"
            yield self.warning(message, at_end, "look at the units of time and moduli")
        if at_end is not None and end is not None and 0.0 < end < stable:
            message = f"the run ends at {end:g}, before its first stable step of {stable:.2g}"
            yield self.warning(message, at_end, "look at the units of time and moduli")

    def _limited(self, deck: DeckView, stable: float, largest: float | None) -> Iterator[Diagnostic]:
        """Limits that keep the step far below the stable one."""
        at = deck.find("Time/delt_max")
        if at is not None and largest is not None and 0.0 < largest < _SHORT * stable:
            message = f"<delt_max> is {largest:g}, and a step of about {stable:.2g} is stable"
            yield self.warning(message, at, "raise it, unless something else needs such short steps")
        first, growth = deck.number("Time/delt_init"), deck.number("Time/max_delt_increase")
        start = deck.find("Time/delt_init")
        if start is None or first is None or not growth or not 0.0 < first < stable:
            return
        steps = math.log(stable / first) / math.log1p(growth)
        if steps > _MANY_FIRST_STEPS:
            message = (
                f"from <delt_init>, {first:g}, the step grows to {stable:.2g} in about {steps:.1g} steps only"
            )
            yield self.warning(message, start, "raise it, or <max_delt_increase>")
