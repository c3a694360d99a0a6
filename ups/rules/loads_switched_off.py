"""UPS415."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix, register_code
from ups.rules.rule import DeckView, Rule


class LoadsSwitchedOff(Rule):
    """Loads are given and not used, or used and not given.

    **Why.** The loads of ``<PhysicalBC>`` act only with ``<use_load_curves>true</use_load_curves>`` in
    ``<MPM>``; without it the bodies stay unloaded, and nobody says so.

    **Example.** A deck with ``<PhysicalBC><MPM><pressure>`` and without ``<use_load_curves>``.

    **Repair.** Switch the loads on, or remove them.
    """

    code = register_code("UPS415", "loads are given and not used")
    title = "loads are given and not used"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare <PhysicalBC> with the switch."""
        loads = [load for section in deck.all("PhysicalBC/MPM") for load in section.children]
        switch = deck.find("MPM/use_load_curves")
        on = switch is not None and switch.text == "true"
        if loads and not on:
            fix = Fix((switch.texts[0].replaced("true"),), safe=False) if switch and switch.texts else None
            message = f"<{loads[0].tag}> has no effect: <use_load_curves> is not true"
            yield self.warning(message, loads[0], "set <use_load_curves>true</use_load_curves> in <MPM>", fix)
        elif on and not loads and switch is not None and not deck.text("MPM/interpolator").startswith("cpti"):
            yield self.note("<use_load_curves> is true, and <PhysicalBC> has no load", switch, "add a load")
