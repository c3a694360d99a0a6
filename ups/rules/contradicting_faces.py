"""UPS416."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.element import Element
from ups.rules.rule import DeckView, Rule, periodic_axes

_AXES = "xyz"


class ContradictingFaces(Rule):
    """Conditions on one face of the domain contradict each other, or the grid.

    **Why.** A face has one condition for each quantity and material; of two, the last one wins in silence. On
    a periodic face there is nothing to prescribe.

    **Example.** ``<Face side="x-">`` with a velocity for all materials, given twice with different values.

    **Repair.** Keep one of the conditions; remove those on periodic faces.
    """

    code = register_code("UPS416", "boundary conditions contradict each other")
    title = "boundary conditions contradict each other"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at the conditions on whole faces."""
        periodic = periodic_axes(deck)
        given: dict[tuple[str, str, str], Element] = {}
        for face in deck.all("Grid/BoundaryConditions/Face"):
            side = face.attributes.get("side")
            if side is None or len(side.value.strip()) != 2 or side.value.strip()[0] not in _AXES:
                continue
            name = side.value.strip()
            if periodic[_AXES.index(name[0])] and face.children:
                yield self.warning(
                    f"the conditions on {name} do nothing: the grid is periodic in {name[0]}",
                    face,
                    "remove them",
                )
            for condition in face.all("BCType"):
                yield from self._compare(name, condition, given)

    def _compare(
        self, side: str, condition: Element, given: dict[tuple[str, str, str], Element]
    ) -> Iterator[Diagnostic]:
        label, index = condition.attributes.get("label"), condition.attributes.get("id")
        if label is None:
            return
        key = (side, label.value.strip(), index.value.strip() if index is not None else "all")
        before = given.setdefault(key, condition)
        if before is not condition and _meaning(before) != _meaning(condition):
            message = (
                f"{key[1]} of material {key[2]} on {side} was given otherwise on line {before.location.line}"
            )
            yield self.warning(message, condition, "keep one of the two")


def _meaning(condition: Element) -> tuple[str, str]:
    kind, value = condition.attributes.get("var"), condition.get("value")
    return kind.value.strip() if kind is not None else "", value.text if value is not None else ""
