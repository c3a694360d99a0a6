"""UPS424."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix, register_code
from ups.rules.rule import DeckView, Rule

_OF_PARTICLES = ("amrmpm", "mpm", "mpmice", "rmpmice", "impm", "smpm", "shmpm", "sfmpm")


class NoPositions(Rule):
    """Variables of particles are saved, and not where the particles are.

    **Why.** Without ``p.x`` nobody can show them; Uintah stops: ``You must save p.x when saving other particle
    variables``.

    **Example.** A ``<DataArchiver>`` with ``<save label="p.stress"/>`` and without ``<save label="p.x"/>``.

    **Repair.** Save ``p.x``; ``--fix`` adds it.
    """

    code = register_code("UPS424", "positions of particles are not saved")
    title = "positions of particles are not saved"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look for p.x among the saved variables of particles."""
        if deck.component not in _OF_PARTICLES or not deck.deck.document.complete:
            return
        saves = [(s, s.attributes.get("label")) for s in deck.all("DataArchiver/save")]
        labels = [
            (save, label)
            for save, label in saves
            if label is not None and label.value.strip().startswith("p.")
        ]
        if not labels or any(label.value.strip() == "p.x" for _, label in labels):
            return
        save, label = labels[0]
        insert = save.source.edit(save.start, save.start, '<save label="p.x"/> ')
        message = f"{label.value.strip()} is saved, and p.x, where the particles are, is not"
        yield self.error(message, label, 'add <save label="p.x"/>', Fix((insert,)))
