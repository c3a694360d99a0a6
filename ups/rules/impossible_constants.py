"""UPS502."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic
from ups.element import Element
from ups.rules.bodies import is_moved_from_outside, temperature_of
from ups.rules.rule import DeckView, Rule
from ups.values import number

_BULK = ("bulk_modulus", "K")
_SHEAR = ("shear_modulus", "G")


class ImpossibleConstants(Rule):
    """Constants of a material contradict each other.

    **Why.** Bulk modulus K and shear modulus G give Poisson's ratio (3 K - 2 G) / (6 K + 2 G); where G
    exceeds 1.5 K it is negative, which few materials are, and the two were probably exchanged. A body that
    starts above the melting temperature of its material has no strength.

    **Example.** ``<bulk_modulus>26e9</bulk_modulus> <shear_modulus>76e9</shear_modulus>`` (exchanged)

    **Repair.** Correct the constants.
    """

    code = "UPS502"
    title = "constants contradict each other"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at the moduli and temperatures of every material of particles."""
        for material in deck.particle_materials:
            if not is_moved_from_outside(deck, material):
                yield from self._poisson_ratio(material)
            yield from self._melting(material)
            yield from self._cold(material)

    def _poisson_ratio(self, material: Element) -> Iterator[Diagnostic]:
        model = material.get("constitutive_model")
        if model is None:
            return
        bulk, shear = _first(model, _BULK), _first(model, _SHEAR)
        k = number(bulk.text) if bulk is not None else None
        g = number(shear.text) if shear is not None else None
        if k is None or g is None or shear is None or not k > 0.0 or not g > 1.5 * k:
            return
        ratio = (3.0 * k - 2.0 * g) / (6.0 * k + 2.0 * g)
        message = f"the shear modulus exceeds 1.5 times the bulk modulus: Poisson's ratio is {ratio:.2g}"
        yield self.warning(message, shear, "are the two exchanged?")

    def _melting(self, material: Element) -> Iterator[Diagnostic]:
        """Bodies that start above the melting temperature of the material, or of its flow stress."""
        model = material.get("constitutive_model")
        flow = model.get("flow_model") if model is not None else None
        for melting in (material.get("melt_temp"), flow.get("T_m") if flow is not None else None):
            limit = number(melting.text) if melting is not None else None
            if limit is None:
                continue
            for body in material.all("geom_object"):
                child, temperature = body.get("temperature"), temperature_of(body)
                if child is not None and temperature is not None and temperature >= limit:
                    message = f"the body starts at {temperature:g} K, its material melts at {limit:g} K"
                    yield self.warning(message, child)

    def _cold(self, material: Element) -> Iterator[Diagnostic]:
        for body in material.all("geom_object"):
            child = body.get("temperature")
            temperature = number(child.text) if child is not None else None
            if child is not None and temperature is not None and temperature < 0.0:
                yield self.warning(f"the body starts at {temperature:g}: temperatures are absolute", child)


def _first(model: Element, tags: tuple[str, ...]) -> Element | None:
    return next((found for tag in tags if (found := model.get(tag)) is not None), None)
