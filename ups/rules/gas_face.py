"""UPS422."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.element import Element
from ups.rules.rule import DeckView, Rule, periodic_axes

_NEEDED = (("Pressure",), ("Velocity",), ("Temperature", "cc_temperature"), ("Density", "SpecificVol"))
"""What each face prescribes; one of the labels of each kind."""


class GasFace(Rule):
    """A face of the grid does not prescribe all that the method of gas dynamics needs.

    **Why.** Gas reaches every face, and each needs a pressure, a velocity, a temperature and a density (or specific
    volume), or ``Symmetric``, which stands for all. Uintah stops: ``Boundary conditions were not set correctly``.

    **Example.** ``<Face side="x+">`` with conditions on velocity and temperature, and none on the pressure.

    **Repair.** Add the ``<BCType>`` that the message names, mostly ``var="Neumann"`` with the value 0.
    """

    code = register_code("UPS422", "face of a gas without all its conditions")
    title = "face of a gas without all its conditions"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at every face of decks with gases."""
        section = deck.find("Grid/BoundaryConditions")
        if not deck.gas_materials or section is None or not deck.deck.document.complete:
            return
        if deck.find("Grid/Level") is None:
            return
        given = _labels(section)
        for axis, periodic in zip("xyz", periodic_axes(deck), strict=True):
            for side in () if periodic else (f"{axis}-", f"{axis}+"):
                labels, at = given.get(side, (set(), section))
                missing = [" or ".join(kind) for kind in _NEEDED if not labels & {*kind, "Symmetric"}]
                if missing:
                    message = f"the face {side} has no condition on {', '.join(missing)}"
                    yield self.warning(message, at, "add a <BCType> for each, or one on Symmetric")


def _labels(section: Element) -> dict[str, tuple[set[str], Element]]:
    """Face -> the labels that its conditions prescribe, and the element that names it first."""
    found: dict[str, tuple[set[str], Element]] = {}
    for face in section.all("Face"):
        side = next(
            (a.value.strip() for a in face.attributes.values() if a.value.strip()[1:] in ("-", "+")), ""
        )
        labels, _ = found.setdefault(side, (set(), face))
        labels |= {
            a.value.strip() for c in face.all("BCType") if (a := c.attributes.get("label")) is not None
        }
    return found
