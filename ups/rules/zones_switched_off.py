"""UPS425."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix, register_code
from ups.rules.rule import DeckView, Rule


class ZonesSwitchedOff(Rule):
    """Cohesive zones are given and not used.

    **Why.** The zones of ``<cohesive_zone>`` act only with ``<use_cohesive_zones>true</use_cohesive_zones>`` in
    ``<MPM>``; without it nothing ties the bodies, and nobody says so.

    **Example.** A deck with ``<cohesive_zone>`` and without ``<use_cohesive_zones>``.

    **Repair.** Switch the zones on, or remove them.
    """

    code = register_code("UPS425", "cohesive zones are given and not used")
    title = "cohesive zones are given and not used"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare the materials with the switch."""
        zones = deck.find("MaterialProperties/MPM/cohesive_zone")
        switch = deck.find("MPM/use_cohesive_zones")
        if zones is None or deck.switch("MPM/use_cohesive_zones"):
            return
        fix = Fix((switch.texts[0].replaced("true"),), safe=False) if switch and switch.texts else None
        message = "<cohesive_zone> has no effect: <use_cohesive_zones> is not true"
        yield self.warning(message, zones, "set <use_cohesive_zones>true</use_cohesive_zones> in <MPM>", fix)
