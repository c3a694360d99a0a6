"""UPS507."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.rules.rule import DeckView, Rule
from ups.values import numbers


class FewParticles(Rule):
    """A body is so thin that hardly a particle fits across it.

    **Why.** Particles lie on a regular lattice, ``<res>`` in each cell; a body thinner than their distance
    may catch none of them and be missing, or have a mass that is far off.

    **Example.** Cells of 1 mm, ``<res>[1, 1, 1]</res>`` and a plate 0.5 mm thick.

    **Repair.** Refine the grid, or raise ``<res>``.
    """

    code = register_code("UPS507", "hardly a particle across a body")
    title = "hardly a particle across a body"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare the bounding box of every body with the distance of particles."""
        domain = deck.domain
        if domain is None or domain.spacing is None:
            return
        for body in (g for m in deck.particle_materials for g in m.all("geom_object")):
            res = body.get("res")
            count = numbers(res.text) if res is not None else None
            if res is None or count is None or len(count) != 3 or any(n < 1 for n in count):
                continue
            for shape in body.children:
                record = deck.record(shape)
                if record is None or not hasattr(record, "bounding_box") or hasattr(record, "particles"):
                    continue
                thin = _thin(record, domain.spacing, count)
                if thin:
                    message = f"<{shape.tag}> is thinner than the distance of particles in {', '.join(thin)}"
                    yield self.warning(message, shape, "refine the grid, or raise <res>")


def _thin(shape: object, spacing: list[float], count: list[float]) -> list[str]:
    """The axes across which a shape is thinner than the distance of particles."""
    try:
        lower, upper = shape.bounding_box()  # type: ignore[attr-defined]  # seen to be there
    except (NotImplementedError, ValueError, ArithmeticError, OSError):
        return []
    sizes = zip("xyz", lower, upper, spacing, count, strict=True)
    return [axis for axis, low, high, cell, n in sizes if 0.0 < high - low < 0.999 * cell / n]
