"""UPS428."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.element import Element
from ups.rules.rule import DeckView, Rule
from ups.values import numbers


class ContactTwice(Rule):
    """Two contacts act on the same materials.

    **Why.** Each contact changes the velocities that the one before left; of two between the same materials, one is
    mostly a leftover, or meant for others.

    **Example.** ``<contact> <type>friction_bard</type> <materials>[0, 1]</materials> ...`` and another contact with
    the same list.

    **Repair.** Remove one, or correct its list of materials.
    """

    code = register_code("UPS428", "two contacts of the same materials")
    title = "two contacts of the same materials"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare the lists of materials of all contacts."""
        first: dict[frozenset[float], Element] = {}
        for contact in deck.all("MaterialProperties/MPM/contact"):
            given = contact.get("materials")
            found = numbers(given.text) if given is not None else None
            if given is None or not found:
                continue
            before = first.setdefault(frozenset(found), given)
            if before is not given:
                message = (
                    f"a contact of the materials {given.text} is given on line {before.location.line} already"
                )
                yield self.warning(message, given, "remove one of them, or correct its materials")
