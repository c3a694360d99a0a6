"""UPS503."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic
from ups.rules.bodies import materials_in_numbers
from ups.rules.rule import DeckView, Rule

_FACTOR = 3.0


class FastBody(Rule):
    """A body moves several times faster than sound in its own material.

    **Why.** Impacts reach the speed of sound; three times as much is rarely meant, and mostly says that
    velocity and moduli are in different units.

    **Example.** ``<velocity>[0, 0, 25000]</velocity>`` for a rubber with a wave speed of 50 m/s.

    **Repair.** Look at the units of both.
    """

    code = "UPS503"
    title = "value is physically implausible"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare the speed of every body with the wave speed."""
        for material in materials_in_numbers(deck):
            if material.sound_speed > 0.0 and material.speed > _FACTOR * material.sound_speed:
                body = material.element.get("geom_object")
                at = body.get("velocity") if body is not None else None
                ratio = material.speed / material.sound_speed
                message = (
                    f"the body moves at {material.speed:g}, {ratio:.2g} times the speed of sound in its "
                    f"material ({material.sound_speed:.3g})"
                )
                yield self.warning(message, at or material.element, "are both in the same units?")
