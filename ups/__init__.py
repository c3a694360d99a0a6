"""Reads, checks and runs Uintah ``.ups`` decks, and reads and writes ``.uda`` archives.

>>> import ups
>>> deck = ups.read("disks.ups")                    # doctest: +SKIP
>>> result = deck.run(output="disks.uda")           # doctest: +SKIP
>>> result["p.stress"][-1]                          # doctest: +SKIP
>>> times, energy = result.history("KineticEnergy") # doctest: +SKIP
>>> ups.open("disks.uda").particles(-1, "p.stress:vonMises").max()  # doctest: +SKIP

Everything is imported when it is first used, so that ``import ups`` costs next to nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ups.archive import Archive, ArchiveError
    from ups.archive import Archive as open  # noqa: N813 - ups.open is a function to its users
    from ups.deck import Deck
    from ups.deck import read_deck as read
    from ups.diagnostics import DeckError
    from ups.profile import Profile
    from ups.result import Result
    from ups.session import resume_run as resume

_HOMES = {
    "Archive": ("ups.archive", "Archive"),
    "ArchiveError": ("ups.archive", "ArchiveError"),
    "Deck": ("ups.deck", "Deck"),
    "DeckError": ("ups.diagnostics", "DeckError"),
    "Profile": ("ups.profile", "Profile"),
    "Result": ("ups.result", "Result"),
    "open": ("ups.archive", "Archive"),
    "read": ("ups.deck", "read_deck"),
    "resume": ("ups.session", "resume_run"),
}

__all__ = [
    "Archive",
    "ArchiveError",
    "Deck",
    "DeckError",
    "Profile",
    "Result",
    "open",
    "read",
    "resume",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'ups' has no attribute {name!r}")
    module, attribute = _HOMES[name]
    return getattr(importlib.import_module(module), attribute)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
