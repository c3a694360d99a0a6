"""UPS405."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic
from ups.rules.rule import DeckView, Rule

_MUST_NOT_EXCEED = (
    ("delt_min", "delt_max", "the smallest time step exceeds the largest"),
    ("initTime", "maxTime", "the run ends before it begins"),
)


class TimeLimits(Rule):
    """Limits of the time or of the time step contradict each other.

    **Why.** With ``delt_min`` above ``delt_max`` the step is ``delt_max`` whatever stability asks for. With
    ``maxTime`` not after ``initTime`` no step is done. A ``timestep_multiplier`` above 1 makes steps longer than
    is stable.

    **Example.** ``<delt_min>1e-5</delt_min> <delt_max>1e-6</delt_max>``

    **Repair.** Give limits that leave room between them.
    """

    code = "UPS405"
    title = "limits contradict each other"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare the pairs of limits in <Time>."""
        for low_tag, high_tag, what in _MUST_NOT_EXCEED:
            low, high = deck.number(f"Time/{low_tag}"), deck.number(f"Time/{high_tag}")
            at = deck.find(f"Time/{high_tag}")
            if low is None or high is None or at is None:
                continue
            if low > high or (low == high and low_tag == "initTime"):
                yield self.error(f"<{low_tag}> is {low:g} and <{high_tag}> {high:g}: {what}", at)
        factor, at = deck.number("Time/timestep_multiplier"), deck.find("Time/timestep_multiplier")
        if factor is not None and at is not None and factor > 1.0:
            message = f"<timestep_multiplier> is {factor:g}: steps are longer than stability allows"
            yield self.warning(message, at, "give a number below 1")
