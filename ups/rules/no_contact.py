"""UPS417."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.rules.rule import DeckView, Rule
from ups.values import numbers

_MOST = 6
_ONE_FIELD = "sfmpm"
"""The method whose materials share one velocity field."""


class NoContact(Rule):
    """Several materials are given and no contact between them, or none with one of them.

    **Why.** Without ``<contact>`` each material moves on a grid of its own, and bodies pass through each
    other.

    **Example.** Two ``<material>`` and no ``<contact>`` in ``<MaterialProperties><MPM>``.

    **Repair.** Add a contact, e.g. ``<contact> <type>single_velocity</type> <materials>[0, 1]</materials>
    </contact>``, or one of type ``null`` to say that none is meant.
    """

    code = register_code("UPS417", "materials without contact")
    title = "materials without contact"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Count materials and contacts."""
        materials, count = deck.particle_materials, deck.particle_material_count
        if count < 2 or deck.component == _ONE_FIELD:
            return
        contacts = list(deck.all("MaterialProperties/MPM/contact"))
        if not contacts:
            message = f"{count} materials and no <contact>: they pass through each other"
            yield self.warning(message, materials[-1], "add <contact>")
            return
        lists = [numbers(given.text) if (given := c.get("materials")) is not None else None for c in contacts]
        if not all(lists):
            return  # one without a list is for all materials
        named = {int(n) for given in lists for n in given or () if math.isfinite(n)}
        apart = [index for index in range(len(materials)) if index not in named]
        if apart:
            which = f"material {apart[0]} is" if len(apart) == 1 else f"materials {_listed(apart)} are"
            message = f"{which} in no <contact>: the others pass through"
            yield self.warning(message, materials[apart[0]], "add to the <materials> of a contact")


def _listed(indices: list[int]) -> str:
    """Some indices, the many in the middle left out."""
    return ", ".join(map(str, indices)) if len(indices) <= _MOST else f"{indices[0]}, ..., {indices[-1]}"
