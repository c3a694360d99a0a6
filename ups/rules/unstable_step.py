"""UPS505."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.rules.bodies import stable_step
from ups.rules.rule import DeckView, Rule

_MANY_STEPS = 1.0e7


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
        usual = min(stable, largest) if largest is not None and largest > 0.0 else stable
        steps = (end or 0.0) / usual
        if steps > _MANY_STEPS and not deck.number("Time/max_Timesteps"):
            at_end = deck.find("Time/maxTime")
            message = f"the run takes about {steps:.1e} steps of {usual:.2g}"
            yield self.warning(message, at_end or at, "look at the units of time and moduli")
