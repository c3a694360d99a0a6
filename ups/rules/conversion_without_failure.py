"""UPS426."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.element import Element
from ups.rules.rule import DeckView, Rule

_SWITCHES = ("create_new_particles", "manual_new_material")


class ConversionWithoutFailure(Rule):
    """Failed particles are to be converted, and none can fail.

    **Why.** ``create_new_particles`` and ``manual_new_material`` convert particles that failed, and particles
    fail only in materials with an ``<erosion>`` other than ``none``.

    **Example.** ``<create_new_particles>true</create_new_particles>`` and no ``<erosion>`` in the deck.

    **Repair.** Give the materials ``<erosion algorithm="ZeroStress"/>``, or ``PreserveStress`` to keep the
    stress of what was converted, and something to fail by: a damage model, or a metal's stability check.
    """

    code = register_code("UPS426", "conversion without failure")
    title = "failed particles are converted, and none fails"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look for an erosion in any material."""
        switch = next((tag for tag in _SWITCHES if deck.switch(f"MPM/{tag}")), None)
        if switch is None or any(_lets_fail(material) for material in deck.particle_materials):
            return
        message = f"<{switch}> converts nothing: no particle fails, as no material has an <erosion>"
        at = deck.find(f"MPM/{switch}")
        if at is not None:
            yield self.warning(message, at, 'add <erosion algorithm="ZeroStress"/> to a material')


def _lets_fail(material: Element) -> bool:
    """Whether particles of a material fail; yes where its erosion cannot be read."""
    erosion = material.get("erosion")
    algorithm = erosion.attributes.get("algorithm") if erosion is not None else None
    return erosion is not None and (algorithm is None or algorithm.value.strip() != "none")
