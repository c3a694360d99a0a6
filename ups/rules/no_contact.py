"""UPS417."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.rules.rule import DeckView, Rule


class NoContact(Rule):
    """Several materials are given and no contact between them.

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
        if count > 1 and deck.find("MaterialProperties/MPM/contact") is None:
            message = f"{count} materials and no <contact>: they pass through each other"
            yield self.warning(message, materials[-1], "add <contact>")
