"""UPS414."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix, register_code
from ups.rules.rule import DeckView, Rule

_NEEDING = ("Threshold", "ThresholdVar", "Brittle")


class DamageWithoutErosion(Rule):
    """A damage model that makes particles fail has no erosion beside it.

    **Why.** ``Threshold``, ``ThresholdVar`` and ``Brittle`` say which particles fail; ``<erosion>`` says what
    becomes of their stress. Uintah stops where it is missing.

    **Example.** ``<material> ... <damage_model type="Threshold"> ... </damage_model> </material>``

    **Repair.** Add ``<erosion algorithm="ZeroStress"/>``, or another algorithm, to the material.
    """

    code = register_code("UPS414", "damage model without erosion")
    title = "damage model without erosion"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at every material of particles."""
        for material in deck.particle_materials:
            damage = material.get("damage_model")
            kind = damage.attributes.get("type") if damage is not None else None
            if damage is None or kind is None or kind.value.strip() not in _NEEDING:
                continue
            if material.get("erosion") is None:
                insert = damage.source.edit(damage.start, damage.start, '<erosion algorithm="ZeroStress"/>\n')
                message = f"the damage model {kind.value.strip()} needs <erosion> in its material"
                suggestion = 'add <erosion algorithm="ZeroStress"/>'
                yield self.error(message, damage, suggestion, Fix((insert,), safe=False))
