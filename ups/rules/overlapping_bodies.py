"""UPS508."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ups.diagnostics import Diagnostic, register_code
from ups.element import Element
from ups.rules.rule import DeckView, Rule

_SAMPLES = 16
"""Points in each direction of the box in which two bodies may overlap."""

_MOST_BODIES = 40
"""With more the comparison would take longer than a check should."""

_SHARE = 0.02
"""Share of the smaller body that must lie in the other one; touching bodies share a layer of points."""


class OverlappingBodies(Rule):
    """Two bodies overlap at the start.

    **Why.** Where they overlap, particles of both lie in the same place: mass is counted twice, and if they are of
    different materials, contact drives them apart at once. Uintah and this program fill both.

    **Example.** A box from 0 to 1 of one material and a cylinder through it of another, without a
    ``<difference>`` that makes room.

    **Repair.** Cut one out of the other with ``<difference>``, or move it.
    """

    code = register_code("UPS508", "bodies overlap at the start")
    title = "bodies overlap at the start"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare the shapes of different bodies, two by two, by points in their common box."""
        bodies = [
            (index, body, shape, record)
            for index, material in enumerate(deck.particle_materials)
            for body in material.all("geom_object")
            for shape in body.children
            if (record := deck.record(shape)) is not None and _is_filled(record)
        ]
        if len(bodies) > _MOST_BODIES:
            return
        for number, (first, owner, _, a) in enumerate(bodies):
            for second, other, shape, b in bodies[number + 1 :]:
                share = _overlap(a, b) if owner is not other else 0.0
                if share > _SHARE:
                    yield self._finding_of(shape, first, second, share)

    def _finding_of(self, shape: Element, first: int, second: int, share: float) -> Diagnostic:
        which = f"another body of material {first}" if first == second else f"a body of material {first}"
        what = f"<{shape.tag}> of material {second} overlaps {which}"
        message = f"{what} by {share:.0%} of the smaller one"
        return self.warning(message, shape, "cut one out of the other with <difference>")


def _is_filled(record: Any) -> bool:
    """Whether a shape is filled with a lattice, so that it can be compared."""
    return hasattr(record, "bounding_box") and hasattr(record, "inside") and not hasattr(record, "particles")


def _overlap(a: Any, b: Any) -> float:
    """Share of the smaller of two shapes that lies in the other, from sample points; 0 where none does."""
    import numpy as np

    try:
        boxes = [np.array(shape.bounding_box(), float) for shape in (a, b)]
        lower, upper = np.maximum(boxes[0][0], boxes[1][0]), np.minimum(boxes[0][1], boxes[1][1])
        if not np.all(np.isfinite([lower, upper])) or not np.all(upper > lower):
            return 0.0
        steps = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
        axes = [low + (high - low) * steps for low, high in zip(lower, upper, strict=True)]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        common = float((a.inside(points) & b.inside(points)).mean()) * float(np.prod(upper - lower))
        smaller = min(float(np.prod(box[1] - box[0])) for box in boxes)
    except (NotImplementedError, ValueError, ArithmeticError, OSError):
        return 0.0
    return common / smaller if smaller > 0.0 else 0.0
