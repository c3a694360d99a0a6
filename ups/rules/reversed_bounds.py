"""UPS401."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix
from ups.element import Element
from ups.rules.rule import DeckView, Rule
from ups.values import numbers


class ReversedBounds(Rule):
    """The lower corner of a block of the grid does not lie below the upper one.

    **Why.** A block spans from ``<lower>`` to ``<upper>`` in each direction. With the corners exchanged, or
    equal, it holds no cell. A plane problem needs one cell of some thickness.

    **Example.** ``<lower>[0, 0, 1]</lower> <upper>[1, 1, 0]</upper>``

    **Repair.** Exchange the corners; ``--fix --unsafe`` does it where all components are exchanged.
    """

    code = "UPS401"
    title = "lower and upper bounds are reversed or equal"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at every block of every level."""
        for box in deck.all("Grid/Level/Box"):
            lower, upper = box.get("lower"), box.get("upper")
            low = numbers(lower.text) if lower else None
            high = numbers(upper.text) if upper else None
            if not lower or not upper or not low or not high or len(low) != 3 or len(high) != 3:
                continue
            wrong = [axis for axis, a, b in zip("xyz", low, high, strict=True) if not b > a]
            if wrong:
                all_exchanged = all(a >= b for a, b in zip(low, high, strict=True))
                fix = _exchange(lower, upper) if all_exchanged and low != high else None
                message = f"<upper> is not above <lower> in {', '.join(wrong)}"
                yield self.error(message, upper, "exchange <lower> and <upper>" if fix else None, fix)


def _exchange(lower: Element, upper: Element) -> Fix:
    return Fix((lower.texts[0].replaced(upper.text), upper.texts[0].replaced(lower.text)), safe=False)
