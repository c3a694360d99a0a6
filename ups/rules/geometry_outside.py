"""UPS403."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ups.diagnostics import Diagnostic
from ups.element import Element
from ups.rules.bodies import bounding_box
from ups.rules.rule import DeckView, Domain, Rule


class GeometryOutside(Rule):
    """A body, or the surface that a load acts on, lies outside the grid.

    **Why.** Particles are made in cells of the grid only; what lies outside is cut off without a word, and a
    body that lies outside entirely leaves the material empty.

    **Example.** A grid from 0 to 1 and ``<box> <min>[2, 0, 0]</min> <max>[3, 1, 1]</max> </box>``, as when
    the grid is in metres and the body in millimetres.

    A gas that forms later is put outside the grid on purpose; suppress the warning there.

    **Repair.** Move the body or extend the grid; look at the units of both.
    """

    code = "UPS403"
    title = "geometry outside the grid"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at the shapes of every body and load."""
        domain = deck.domain
        if domain is None:
            return
        loads = [child for section in deck.all("PhysicalBC/MPM") for child in section.children]
        bodies = [
            g
            for owner in (*deck.particle_materials, *deck.gas_materials, *loads)
            for g in owner.all("geom_object")
        ]
        for body in bodies:
            for shape in body.children:
                bounds = bounding_box(deck.record(shape))
                if bounds is not None:
                    yield from self._compare(shape, bounds, domain)

    def _compare(
        self, shape: Element, bounds: tuple[tuple[float, ...], tuple[float, ...]], domain: Domain
    ) -> Iterator[Diagnostic]:
        sides = zip("xyz", *bounds, domain.lower, domain.upper, strict=True)
        outside = [axis for axis, a, b, low, high in sides if a >= high or b <= low]
        if outside:
            own, grid = _span(*bounds), _span(domain.lower, domain.upper)
            message = (
                f"{_name(shape)} from {own} lies outside the grid in {', '.join(outside)}, which spans {grid}"
            )
            yield self.warning(
                message, shape, "move it into the grid, or extend the grid; are both in the same units?"
            )


def _name(shape: Element) -> str:
    label = shape.attributes.get("label")
    return f"<{shape.tag}>" if label is None else f"<{shape.tag}> {label.value!r}"


def _span(lower: Sequence[float], upper: Sequence[float]) -> str:
    corners = ("[" + ", ".join(f"{x:g}" for x in corner) + "]" for corner in (lower, upper))
    return " to ".join(corners)
