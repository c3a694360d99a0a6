"""UPS509."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.element import Element
from ups.rules.bodies import Body, bodies, is_moved_from_outside
from ups.rules.rule import DeckView, Rule

_MOST = 10
"""More particles in a cell, in one direction, gain less than a finer grid of the same cost."""


class ParticlesPerCell(Rule):
    """The number of particles in a cell does not fit the interpolator.

    **Why.** ``<res>`` says how many particles lie in a cell in each direction. With one, a body that is stretched
    to twice its length has empty cells between its particles and falls apart; only ``cpdi`` and ``cpti``, whose
    particles stretch with the body, hold it together. Far more than four cost more than
    a finer grid that gains as much. An
    axisymmetric problem has one particle through its thickness, which stands for a whole ring.

    **Example.** ``<interpolator>linear</interpolator>`` with ``<res>[1, 1, 1]</res>``.

    **Repair.** Two particles in each direction in which the body has cells are usual, and one in the direction in
    which the grid has a single cell.
    """

    code = register_code("UPS509", "particles per cell do not fit the interpolator")
    title = "particles per cell do not fit the interpolator"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at the <res> of every body."""
        if deck.domain is None or deck.domain.spacing is None:
            return
        name = deck.text("MPM/interpolator", "linear")
        deforming = [m for m in deck.particle_materials if not is_moved_from_outside(deck, m)]
        for body in (b for material in deforming for b in bodies(deck, material)):
            at = body.element.get("res")
            if at is not None and body.res is not None:
                yield from self._check(deck, body, body.res, at, name)

    def _check(
        self, deck: DeckView, body: Body, res: tuple[float, ...], at: Element, interpolator: str
    ) -> Iterator[Diagnostic]:
        cells = self._cells(deck, body)
        if deck.switch("MPM/axisymmetric") and res[2] > 1:
            message = f"an axisymmetric problem has one particle in z, here {res[2]:g}"
            yield self.warning(message, at, f"write [{res[0]:g}, {res[1]:g}, 1]")
        many = [axis for axis, n in zip("xyz", res, strict=True) if n > _MOST]
        if many:
            message = f"{max(res):g} particles in a cell in {', '.join(many)}: a finer grid gains more"
            yield self.warning(message, at, "give 2 to 4, and refine the grid")
        single = [axis for axis, n, length in zip("xyz", res, cells, strict=True) if n == 1 and length > 1.5]
        if single and not interpolator.startswith(("cpdi", "fast_cpdi", "cpti")):
            what = f"one particle in a cell in {', '.join(single)}"
            message = f"{what}: with {interpolator} the body tears when it is stretched"
            yield self.note(message, at, "give 2 in each direction, or take cpdi")

    def _cells(self, deck: DeckView, body: Body) -> list[float]:
        """How many cells long a body is in each direction."""
        assert deck.domain is not None
        assert deck.domain.spacing is not None
        sizes = zip(body.lower, body.upper, deck.domain.spacing, strict=True)
        return [(high - low) / cell for low, high, cell in sizes]
