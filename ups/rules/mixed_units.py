"""UPS504."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.element import Element
from ups.rules.bodies import materials_in_numbers
from ups.rules.rule import DeckView, Rule
from ups.values import numbers

_LARGEST_GRAMS = 25.0
"""No solid has a larger density in g/cm^3."""

_SMALLEST_KILOGRAMS = 500.0
_SI_GRAVITY = (9.7, 10.1)
_SI_SPECIFIC_HEAT = (100.0, 10000.0)
_SI_SOUND = 30000.0
"""No wave in matter is faster, in m/s."""

_SLOW_METAL = 100.0
"""No metal has slower waves, in m/s."""


class MixedUnits(Rule):
    """The constants of a material look as if they were in different systems of units.

    **Why.** Any consistent units will do, but a density in g/cm^3 beside moduli in Pa makes waves thirty
    times too fast and the time step as much too small; moduli in GPa or MPa beside a density in kg/m^3 make
    them far too slow. The first is suspected where the density is below that of any solid in kg/m^3, sound would
    be faster than in any matter, and the specific heat or gravity is as in SI; the second where a metal with the
    density and the specific heat of SI would have slower waves than rubber.

    **Example.** ``<density>7.8</density> ... <bulk_modulus>1.6e11</bulk_modulus>``

    **Repair.** Give all in SI (kg, m, s, K), or all in another system.
    """

    code = register_code("UPS504", "units look mixed")
    title = "units look mixed"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at every material of particles."""
        for material in materials_in_numbers(deck):
            at = material.element.get("density") or material.element
            heat = deck.number_of(material.element, "specific_heat")
            si_heat = heat is not None and _SI_SPECIFIC_HEAT[0] <= heat <= _SI_SPECIFIC_HEAT[1]
            sound = f"sound run at {material.sound_speed:.3g}; the units look mixed"
            too_fast = 0.5 < material.density <= _LARGEST_GRAMS and material.sound_speed > _SI_SOUND
            too_slow = material.density >= _SMALLEST_KILOGRAMS and 0.0 < material.sound_speed < _SLOW_METAL
            if too_fast and (si_heat or _has_si_gravity(deck)):
                message = f"a density of {material.density:g} beside these moduli makes {sound}"
                advice = f"in SI the density would be about {1000.0 * material.density:g}"
                yield self.warning(message, at, advice)
            elif too_slow and si_heat and _is_metal(material.element):
                message = f"these moduli beside a density of {material.density:g} make {sound}"
                yield self.warning(message, at, "are the moduli in Pa?")


def _has_si_gravity(deck: DeckView) -> bool:
    """Whether gravity is that of the earth in m/s^2."""
    found = numbers(deck.text("PhysicalConstants/gravity"))
    return found is not None and _SI_GRAVITY[0] <= math.hypot(*found) <= _SI_GRAVITY[1]


def _is_metal(material: Element) -> bool:
    """Whether the model is one of metals."""
    model = material.get("constitutive_model")
    kind = model.attributes.get("type") if model is not None else None
    return kind is not None and kind.value.strip().startswith(("elastic_plastic", "hypoelastic_plastic"))
