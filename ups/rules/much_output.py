"""UPS506."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.rules.rule import DeckView, Rule

_MANY = 20000


class MuchOutput(Rule):
    """The deck writes an archive of very many time steps.

    **Why.** Each output is a folder with files of its own; tens of thousands fill disks and slow every tool.

    **Example.** ``<maxTime>1</maxTime>`` with ``<outputInterval>1e-6</outputInterval>``

    **Repair.** Write less often.
    """

    code = register_code("UPS506", "very much output")
    title = "very much output"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare the interval of output with the time of the run."""
        end, interval = deck.number("Time/maxTime"), deck.number("DataArchiver/outputInterval")
        at = deck.find("DataArchiver/outputInterval")
        steps = deck.number("Time/max_Timesteps")
        if end is None or not interval or at is None or steps:
            return
        if end / interval > _MANY:
            yield self.warning(f"about {end / interval:.1e} outputs will be written", at, "write less often")
