"""UPS402."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ups.diagnostics import Diagnostic
from ups.element import Attribute, Element, Text
from ups.rules.rule import DeckView, Rule

_CONTACT_TAGS = ("materials", "master_material", "rigid_material", "ExcludeMaterial", "stiff_material")
_ANY_MATERIAL = -99
_INTEGER = re.compile(r"-?\d+")
_RANGE = re.compile(r"(-?\d+)(?:\s*-\s*(\d+))?")


class MaterialIndex(Rule):
    """An index names a material that the deck does not have.

    **Why.** Materials are counted from 0 in the order of the deck, those of ``<MPM>`` first and those of
    ``<ICE>`` after them. In the list of a contact an index too many does nothing, so that bodies may pass
    through each other unnoticed: a warning. Elsewhere it stops the run or reads what is not there.

    **Example.** ``<contact> <type>friction_bard</type> <materials>[0, 2]</materials>`` with two materials.

    **Repair.** Give indices below the number of materials. ``all`` or leaving out the tag means every one.
    """

    code = "UPS402"
    title = "material index out of range"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at contact, loads, boundary conditions and saved variables."""
        particles, every = deck.particle_material_count, deck.material_count
        if not every:
            return
        for contact in deck.all("MaterialProperties/MPM/contact"):
            for tag in _CONTACT_TAGS:
                for element in contact.all(tag):
                    yield from self._check(element, particles, severe=tag != "materials")
        for curve in (c for load in deck.all("PhysicalBC/MPM") for c in load.iter() if c.tag == "load_curve"):
            for element in curve.all("material"):
                yield from self._check(element, particles, allowed=(_ANY_MATERIAL,))
        for condition in deck.all("Grid/BoundaryConditions/Face/BCType"):
            index = condition.attributes.get("id")
            if index is not None and index.value.strip() != "all":
                if not _INTEGER.fullmatch(index.value.strip()):
                    yield self.error(f"id is {index.value!r}; it must be a material index, or all", index)
                yield from self._check_text(index, "id", every)
        for save in deck.all("DataArchiver/save"):
            chosen = save.attributes.get("material")
            if chosen is not None:
                count = every + deck.zone_count + 1
                yield from self._check_text(chosen, "material", count, allowed=(-1,), ranges=True)

    def _check(
        self, element: Element, count: int, allowed: tuple[int, ...] = (), severe: bool = True
    ) -> Iterator[Diagnostic]:
        if element.texts:
            yield from self._check_text(element.texts[0], f"<{element.tag}>", count, allowed, severe=severe)

    def _check_text(
        self,
        at: Attribute | Text,
        what: str,
        count: int,
        allowed: tuple[int, ...] = (),
        *,
        ranges: bool = False,
        severe: bool = True,
    ) -> Iterator[Diagnostic]:
        if ranges:
            found = [int(n) for pair in _RANGE.findall(at.value) for n in pair if n]
        else:
            found = [int(n) for n in _INTEGER.findall(at.value)]
        wrong = [n for n in found if not 0 <= n < count and n not in allowed]
        if wrong:
            last = count - 1 - ranges
            message = (
                f"{what} names material {wrong[0]}; the deck has {'only 0' if not last else f'0 to {last}'}"
            )
            yield (self.error if severe else self.warning)(message, at)
