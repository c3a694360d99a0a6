"""UPS427."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix, register_code
from ups.rules.rule import DeckView, Rule

_SWELLING = ("rf_elastic_plastic", "gao_elastic")


class DiffusionSwitchedOff(Rule):
    """Diffusion is described and not switched on, or switched on and not described.

    **Why.** Concentrations spread with ``<do_scalar_diffusion>true</do_scalar_diffusion>`` in ``<MPM>``, and
    then every material needs a ``<diffusion_model>``; without the switch the model is not even read, and
    materials that swell stay as they are (Uintah refuses them).

    **Example.** A deck with ``<diffusion_model type="jg">`` and without ``<do_scalar_diffusion>``.

    **Repair.** Switch diffusion on, give the missing laws, or remove them.
    """

    code = register_code("UPS427", "diffusion is described and not switched on, or the reverse")
    title = "diffusion is described and not switched on, or the reverse"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare the materials with the switch."""
        switch = deck.find("MPM/do_scalar_diffusion")
        on = deck.switch("MPM/do_scalar_diffusion")
        for material in deck.particle_materials:
            law = material.get("diffusion_model")
            if on and law is None:
                message = "this material needs a <diffusion_model>: <do_scalar_diffusion> is true"
                yield self.error(message, material, "add a <diffusion_model>, for example of type jg")
            elif law is not None and not on:
                fix = (
                    Fix((switch.texts[0].replaced("true"),), safe=False) if switch and switch.texts else None
                )
                message = "<diffusion_model> has no effect: <do_scalar_diffusion> is not true"
                suggestion = "set <do_scalar_diffusion>true</do_scalar_diffusion> in <MPM>"
                yield self.warning(message, law, suggestion, fix)
            model = material.get("constitutive_model")
            kind = model.attributes.get("type") if model is not None else None
            if kind is not None and kind.value.strip() in _SWELLING and not on:
                message = f"{kind.value.strip()} swells by diffusion, and <do_scalar_diffusion> is not true"
                yield self.warning(
                    message, kind, "set <do_scalar_diffusion>true</do_scalar_diffusion> in <MPM>"
                )
