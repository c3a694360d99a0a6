"""UPS504."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.rules.bodies import materials_in_numbers
from ups.rules.rule import DeckView, Rule
from ups.values import number

_LARGEST_GRAMS = 25.0
_SI_SPECIFIC_HEAT = (100.0, 10000.0)
_SI_SOUND = 30000.0
"""No wave in matter is faster, in m/s."""


class MixedUnits(Rule):
    """The constants of a material look as if they were in different systems of units.

    **Why.** Any consistent units will do, but a density in g/cm^3 beside moduli in Pa makes waves thirty
    times too fast and the time step as much too small. It is suspected where the density is below that of any
    solid in kg/m^3, the specific heat is as in SI, and sound would be faster than in any matter.

    **Example.** ``<density>7.8</density> ... <bulk_modulus>1.6e11</bulk_modulus>``

    **Repair.** Give all in SI (kg, m, s, K), or all in another system.
    """

    code = register_code("UPS504", "units look mixed")
    title = "units look mixed"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at every material of particles."""
        for material in materials_in_numbers(deck):
            heat = material.element.get("specific_heat")
            value = number(heat.text) if heat is not None else None
            if value is None or not _SI_SPECIFIC_HEAT[0] <= value <= _SI_SPECIFIC_HEAT[1]:
                continue
            if material.density <= _LARGEST_GRAMS and material.sound_speed > _SI_SOUND:
                at = material.element.get("density") or material.element
                message = (
                    f"a density of {material.density:g} beside these moduli makes sound run at "
                    f"{material.sound_speed:.3g}; the units look mixed"
                )
                yield self.warning(
                    message, at, f"in SI the density would be about {1000.0 * material.density:g}"
                )
