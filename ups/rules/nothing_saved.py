"""UPS418."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.rules.rule import DeckView, Rule


class NothingSaved(Rule):
    """The deck does not say when, or what, to write.

    **Why.** Output needs ``<outputInterval>`` or ``<outputTimestepInterval>``, which Uintah's validator asks
    for, and ``<save>`` for each variable.

    **Example.** A ``<DataArchiver>`` with a ``<filebase>`` alone.

    **Repair.** Give an interval and the variables.
    """

    code = register_code("UPS418", "no output interval")
    title = "no output interval"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look for an interval in <DataArchiver>."""
        archiver = deck.find("DataArchiver")
        if archiver is None or not deck.deck.document.complete:
            return
        intervals = [archiver.get(tag) for tag in ("outputInterval", "outputTimestepInterval")]
        if not any(intervals):
            yield self.warning(
                "no output interval is given: nothing is written", archiver, "add <outputInterval>"
            )
