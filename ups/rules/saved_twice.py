"""UPS423."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix, register_code
from ups.element import Element
from ups.rules.rule import DeckView, Rule


class SavedTwice(Rule):
    """A variable is saved twice.

    **Why.** Once is enough: the second line adds nothing, or was meant to name another variable.

    **Example.** ``<save label="p.stress"/> ... <save label="p.stress"/>``

    **Repair.** Remove one of the lines; ``--fix`` does it.
    """

    code = register_code("UPS423", "variable saved twice")
    title = "variable saved twice"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare the attributes of every <save>."""
        first: dict[frozenset[tuple[str, str]], Element] = {}
        for save in deck.all("DataArchiver/save"):
            label = save.attributes.get("label")
            if label is None:
                continue
            before = first.setdefault(
                frozenset((n, a.value.strip()) for n, a in save.attributes.items()), save
            )
            if before is not save:
                message = f"{label.value.strip()} is saved on line {before.location.line} already"
                yield self.warning(message, label, "remove one of them", Fix((save.removed(),)))
