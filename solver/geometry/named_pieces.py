"""Pieces that a deck names once and uses again by name."""

from __future__ import annotations

from typing import Any


class NamedPieces:
    """The labelled pieces of a deck, in the order of reading.

    A labelled piece with parameters defines the label; one without refers to an earlier definition:
    ``<cylinder label="shell"/>``.
    """

    def __init__(self) -> None:
        self._pieces: dict[str, tuple[str, Any]] = {}

    def define(self, tag: str, piece: Any) -> None:
        """Remember a piece by its label, if it has one; ValueError if the label is taken."""
        if not piece.label:
            return
        if piece.label in self._pieces:
            raise ValueError(
                f"the label {piece.label!r} already names a piece; give this one another label, or leave out "
                "its parameters to use the earlier one"
            )
        self._pieces[piece.label] = (tag, piece)

    def refer(self, tag: str, label: str) -> Any:
        """The piece that a label names; ValueError if there is none, or if its tag is another one."""
        if label not in self._pieces:
            known = ", ".join(repr(name) for name in self._pieces) or "none so far"
            raise ValueError(f"no piece is labelled {label!r} before this place (labels: {known})")
        defined_as, piece = self._pieces[label]
        if defined_as != tag:
            raise ValueError(f"{label!r} names a <{defined_as}>, not a <{tag}>")
        return piece
