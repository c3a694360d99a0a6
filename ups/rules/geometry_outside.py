"""UPS403."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ups.diagnostics import Diagnostic
from ups.element import Element
from ups.rules.rule import DeckView, Rule


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
                bounds = _bounds(deck.record(shape))
                if bounds is None:
                    continue
                lower, upper = bounds
                outside = [
                    axis
                    for axis, a, b, low, high in zip(
                        "xyz", lower, upper, domain.lower, domain.upper, strict=True
                    )
                    if a >= high or b <= low
                ]
                if outside:
                    span = f"{_point(domain.lower)} to {_point(domain.upper)}"
                    where = ", ".join(outside)
                    message = f"{_name(shape)} lies outside the grid in {where}: the grid spans {span}"
                    yield self.warning(message, shape)


def _bounds(shape: Any) -> tuple[Any, Any] | None:
    """The bounding box of a shape, or None where it has none that is finite."""
    try:
        lower, upper = shape.bounding_box()
    except (AttributeError, NotImplementedError, ValueError, ArithmeticError, OSError):
        return None
    return (lower, upper) if all(b >= a for a, b in zip(lower, upper, strict=True)) else None


def _name(shape: Element) -> str:
    label = shape.attributes.get("label")
    return f"<{shape.tag}>" if label is None else f"<{shape.tag}> {label.value!r}"


def _point(point: list[float]) -> str:
    return "[" + ", ".join(f"{x:g}" for x in point) + "]"
