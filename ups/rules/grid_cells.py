"""UPS419."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.element import Element
from ups.rules.rule import DeckView, Rule
from ups.values import numbers

_TOLERANCE = 1.0e-3


class GridCells(Rule):
    """A block of the grid does not say its cells, or does not consist of whole ones.

    **Why.** A block is cut into cells by ``<resolution>`` (how many) or ``<spacing>`` (how large, on the block or
    the level); with spacing the block must be a whole number of cells long. Its patches hold one cell at least.

    **Example.** A block 1 m long with ``<spacing>[0.3, 0.3, 0.3]</spacing>``

    **Repair.** Give a resolution, or a spacing that divides the block; ask for fewer patches.
    """

    code = register_code("UPS419", "block of the grid without whole cells")
    title = "block of the grid without whole cells"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at every block of every level."""
        for level in deck.all("Grid/Level"):
            for box in level.all("Box"):
                yield from self._check(level, box, deck.deck.document.complete)

    def _check(self, level: Element, box: Element, complete: bool) -> Iterator[Diagnostic]:
        resolution, spacing = box.get("resolution"), box.get("spacing") or level.get("spacing")
        if resolution is None and spacing is None:
            if complete:
                yield self.error("the block needs <resolution> or <spacing>", box, "add <resolution>")
            return
        cells = _three(resolution)
        if cells is None and spacing is not None:
            cells = _cells_of(box, spacing)
            if cells is not None and any(abs(n - round(n)) > _TOLERANCE for n in cells):
                shown = " x ".join(f"{n:g}" for n in cells)
                yield self.error(f"the block is {shown} cells of <spacing>: not whole ones", spacing)
                return
        patches = box.get("patches")
        asked = _three(patches)
        if cells and asked and patches is not None:
            wrong = [a for a, n, p in zip("xyz", cells, asked, strict=True) if p > round(n) > 0]
            if wrong:
                yield self.error(f"there are more patches than cells in {', '.join(wrong)}", patches)


def _three(element: Element | None) -> list[float] | None:
    found = numbers(element.text) if element is not None else None
    return found if found is not None and len(found) == 3 and all(map(math.isfinite, found)) else None


def _cells_of(box: Element, spacing: Element) -> list[float] | None:
    """How many cells of a size a block is long in each direction."""
    lower, upper, size = _three(box.get("lower")), _three(box.get("upper")), _three(spacing)
    if not lower or not upper or not size or any(not s > 0.0 for s in size):
        return None
    return [(high - low) / s for low, high, s in zip(lower, upper, size, strict=True)]
