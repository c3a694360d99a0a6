"""UPS407."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic
from ups.element import Element
from ups.rules.rule import DeckView, Rule


class LoadCurveId(Rule):
    """Two load curves have the same id.

    **Why.** Particles remember the ids of the curves that act on them, three at most. With one id for two
    curves the second is never found.

    **Example.** Two ``<load_curve> <id>1</id> ... </load_curve>``

    **Repair.** Number the curves 1, 2, 3 in the order of the deck.
    """

    code = "UPS407"
    title = "name used twice"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at the ids of all load curves."""
        first: dict[str, Element] = {}
        for curve in (
            e for section in deck.all("PhysicalBC/MPM") for e in section.iter() if e.tag == "load_curve"
        ):
            number = curve.get("id")
            if number is None or not number.text:
                continue
            before = first.setdefault(number.text, number)
            if before is not number:
                line = before.location.line
                message = f"load curve {number.text} is given twice, first on line {line}"
                yield self.error(message, number, "give each curve its own id")
