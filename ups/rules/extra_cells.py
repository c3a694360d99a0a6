"""UPS409."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix
from ups.element import Element
from ups.rules.rule import DeckView, Rule
from ups.values import numbers

_REACHING_ONE_CELL = ("gimp", "cpdi", "fast_cpdi", "cpti", "3rdorderBS")


class ExtraCells(Rule):
    """The extra cells around the grid do not fit the interpolator.

    **Why.** The linear interpolator reaches the nodes of a particle's own cell and takes no extra cells. All
    others reach one cell further: at each face they need a layer of extra cells, or periodicity. An
    axisymmetric grid needs none in z.

    **Example.** ``<interpolator>gimp</interpolator>`` with ``<extraCells>[0, 0, 0]</extraCells>``.

    **Repair.** Set ``<extraCells>`` to 1 where the grid is not periodic, or to [0, 0, 0] for ``linear``; nothing else
    goes with the interpolator, so that ``--fix`` does it.
    """

    code = "UPS409"
    title = "extra cells do not fit the interpolator"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare every block of the first level with the interpolator."""
        if deck.component not in ("mpm", "mpmice"):
            return
        name = deck.text("MPM/interpolator", "linear")
        axisymmetric = deck.switch("MPM/axisymmetric")
        level = deck.find("Grid/Level")
        for box in level.all("Box") if level is not None else ():
            extra, periodic = _cells(level, box, "extraCells"), _cells(level, box, "periodic")
            if extra is None or periodic is None:
                continue
            if name == "linear":
                if any(extra) and deck.component == "mpm":
                    yield self._finding_at(box, [0, 0, 0], "the linear interpolator takes no extra cells")
                continue
            if name not in _REACHING_ONE_CELL:
                continue
            total = [e + p for e, p in zip(extra, periodic, strict=True)]
            if total != [1, 1, 1] and not (axisymmetric and total == [1, 1, 0]):
                message = f"{name} needs extraCells and periodic to add up to [1, 1, 1], here {total}"
                yield self._finding_at(box, [1 - int(p) for p in periodic], message)

    def _finding_at(self, box: Element, needed: list[int], message: str) -> Diagnostic:
        given = box.get("extraCells")
        fix = Fix((given.texts[0].replaced(str(needed)),)) if given and given.texts else None
        return self.error(message, given or box, f"set <extraCells>{needed}</extraCells>", fix)


def _cells(level: Element | None, box: Element, tag: str) -> list[int] | None:
    """Three integers of the block, else of the level, else zeros; None where they cannot be read."""
    child = box.get(tag) or (level.get(tag) if level is not None else None)
    if child is None:
        return [0, 0, 0]
    found = numbers(child.text)
    if found is None or len(found) != 3 or not all(map(math.isfinite, found)):
        return None
    return [int(n) for n in found]
