"""UPS503."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ups.diagnostics import Diagnostic
from ups.element import Element
from ups.rules.bodies import is_moved_from_outside, materials_in_numbers, speed_of
from ups.rules.rule import DeckView, Rule
from ups.values import numbers

_FACTOR = 3.0


class FastBody(Rule):
    """A body, or a face of the grid, moves several times faster than sound in the material.

    **Why.** Impacts reach the speed of sound; three times as much is rarely meant, and mostly says that
    velocity and moduli are in different units.

    **Example.** ``<velocity>[0, 0, 25000]</velocity>`` for a rubber with a wave speed of 50 m/s.

    **Repair.** Look at the units of both.
    """

    code = "UPS503"
    title = "value is physically implausible"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare the speed of every body, and of every face, with the wave speed."""
        materials = list(materials_in_numbers(deck))
        for material in materials:
            if is_moved_from_outside(deck, material.element):
                continue
            for body in material.element.all("geom_object"):
                yield from self._compare(
                    speed_of(body), material.sound_speed, body.get("velocity"), "the body"
                )
        fastest = max((m.sound_speed for m in materials), default=0.0)
        for condition in deck.all("Grid/BoundaryConditions/Face/BCType"):
            label, value = condition.attributes.get("label"), condition.get("value")
            found = numbers(value.text) if value is not None else None
            if label is not None and label.value.strip() == "Velocity" and found is not None:
                yield from self._compare(math.hypot(*found), fastest, value, "the face")

    def _compare(self, speed: float, sound: float, at: Element | None, what: str) -> Iterator[Diagnostic]:
        if at is None or not sound > 0.0 or not speed > _FACTOR * sound:
            return
        ratio = f"{speed / sound:.2g} times the speed of sound in the material ({sound:.3g})"
        message = f"{what} moves at {speed:g}, {ratio}"
        yield self.warning(message, at, "are both in the same units?")
