"""UPS421."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.element import Element
from ups.rules.bodies import speed_of
from ups.rules.rule import DeckView, Rule
from ups.values import number

_POROUS = ("gurson", "rousselier")
_POROSITY = (
    "initial_mean_porosity",
    "initial_std_porosity",
    "initial_porosity_distrib",
    "frac_nucleation",
    "meanstrain_nucleation",
    "stddevstrain_nucleation",
    "evolve_porosity",
)
_FLOW_OF_SHEAR = {
    "mts_shear": "mts_model",
    "ptw_shear": "preston_tonks_wallace",
    "scg_shear": "steinberg_cochran_guinan",
}
"""Shear modulus model -> the flow stress that it was published with."""

_DENSITY_OF_HEAT = {"copper_Cp": ("copper", 8900.0), "steel_Cp": ("steel", 7850.0)}
"""Specific heat model -> its metal and the density of that in kg/m^3."""

_NEAR = 0.15
"""How far a density may be from that of the metal, as a share of it."""

_SHOCK = 0.25
"""Speed of a body, in speeds of sound, from which pressure is not proportional to strain any more."""

_SAME = 0.2
"""How far the speed of sound of an equation of state may be from that of the bulk modulus."""


class ModelPairs(Rule):
    """Models were chosen together that make no sense together, or of which one does nothing beside the other.

    **Why.** The parts of an ``elastic_plastic`` metal are chosen one by one, and any combination runs. Porosity
    counts only for a yield condition of porous metals (``gurson``, ``rousselier``) and for failure; damage and
    stability only where ``<erosion>`` says what becomes of a failed particle; a shear modulus that was published
    with a flow stress shares its constants; the specific heat of copper is no other metal's; a body that hits at
    a quarter of the speed of sound needs an equation of state that was measured with shocks, and that has to
    have the speed of sound that follows from the bulk modulus.

    **Example.** ``<stability_check type="drucker"/>`` in a material without ``<erosion>``.

    **Repair.** Choose the partner that the message names, or remove what does nothing.
    """

    code = register_code("UPS421", "models that do not go together")
    title = "models that do not go together"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at the models of every metal."""
        for material in deck.particle_materials:
            model = material.get("constitutive_model")
            if model is None or not _type_of(model).startswith("elastic_plastic"):
                continue
            yield from self._failure(material, model)
            yield from self._porosity(material, model)
            yield from self._shear_modulus(model)
            yield from self._specific_heat(deck, material, model)
            yield from self._equation_of_state(material, model)

    def _failure(self, material: Element, model: Element) -> Iterator[Diagnostic]:
        """What makes particles fail, where failed ones are treated as all others."""
        erosion = material.get("erosion")
        if erosion is not None and _type_of(erosion, "algorithm") != "none":
            return
        stability = model.get("stability_check")
        if stability is not None and _type_of(stability) != "none":
            message = "particles do not fail without <erosion>, so that <stability_check> does nothing"
            yield self.warning(message, stability, 'add <erosion algorithm="ZeroStress"/> to the material')
        for section in (material, model):
            damage = section.get("damage_model")
            if damage is not None and _type_of(damage) in ("johnson_cook", "hancock_mackenzie"):
                message = "particles do not fail without <erosion>: the damage is computed and has no effect"
                yield self.warning(message, damage, 'add <erosion algorithm="ZeroStress"/> to the material')

    def _porosity(self, material: Element, model: Element) -> Iterator[Diagnostic]:
        """Porosity that no yield condition reads."""
        condition = model.get("yield_condition")
        porous = condition is not None and _type_of(condition) in _POROUS
        given = [
            child for tag in _POROSITY if (child := model.get(tag)) is not None and child.text != "false"
        ]
        if given and not porous and material.get("erosion") is None:
            name = _type_of(condition) if condition is not None else "vonMises"
            message = f"the yield condition {name} knows no porosity: <{given[0].tag}> has no effect"
            yield self.warning(message, given[0], "choose gurson or rousselier, or remove it")

    def _shear_modulus(self, model: Element) -> Iterator[Diagnostic]:
        """A shear modulus of another flow stress, or with other constants than the same in the flow stress."""
        shear, flow = model.get("shear_modulus_model"), model.get("flow_model")
        if shear is None or flow is None:
            return
        partner = _FLOW_OF_SHEAR.get(_type_of(shear))
        if partner is not None and _type_of(flow) != partner:
            message = (
                f"{_type_of(shear)} belongs to the flow stress {partner}, and this one is {_type_of(flow)}"
            )
            yield self.note(message, shear, "np_shear or constant_shear go with any flow stress")
            return
        for constant in shear.children if partner is not None else ():
            other = flow.get(constant.tag)
            own, its = number(constant.text), number(other.text) if other is not None else None
            if own is not None and its is not None and not math.isclose(own, its, rel_tol=1e-6):
                message = f"<{constant.tag}> is {own:g} here and {its:g} in <flow_model>"
                yield self.warning(message, constant, "give both the same constants")

    def _specific_heat(self, deck: DeckView, material: Element, model: Element) -> Iterator[Diagnostic]:
        """The specific heat of a certain metal, for another one or switched off."""
        heat = model.get("specific_heat_model")
        if heat is None or _type_of(heat) not in _DENSITY_OF_HEAT:
            return
        metal, usual = _DENSITY_OF_HEAT[_type_of(heat)]
        density = deck.number_of(material, "density")
        if density is not None and not any(
            abs(density - scale * usual) <= _NEAR * scale * usual for scale in (1.0, 1e-3, 1e-12)
        ):
            message = f"{_type_of(heat)} is the specific heat of {metal}, and the density is {density:g}"
            yield self.warning(message, heat, "give <specific_heat> and constant_Cp")
        switch = model.get("compute_specific_heat")
        if switch is None or switch.text != "true":
            message = f"{_type_of(heat)} has no effect: <compute_specific_heat> is not true"
            yield self.warning(message, heat, "add <compute_specific_heat>true</compute_specific_heat>")

    def _equation_of_state(self, material: Element, model: Element) -> Iterator[Diagnostic]:
        """An equation of state without shocks for a shock, or of another material."""
        state = model.get("equation_of_state")
        density, bulk = material.get("density"), model.get("bulk_modulus")
        rho = number(density.text) if density is not None else None
        k = number(bulk.text) if bulk is not None else None
        if rho is None or k is None or not rho > 0.0 or not k > 0.0:
            return
        sound = math.sqrt(k / rho)
        constant = state.get("C_0") if state is not None else None
        c0 = number(constant.text) if constant is not None else None
        if constant is not None and c0 is not None and c0 > 0.0 and abs(c0 - sound) > _SAME * sound:
            message = f"C_0 is {c0:g}, and bulk modulus and density make sqrt(K / rho) = {sound:.4g}"
            yield self.warning(message, constant, "are all of the same material and in the same units?")
        if state is None or _type_of(state) in ("default_hypo", "default_hyper"):
            for body in material.all("geom_object"):
                if speed_of(body) > _SHOCK * sound:
                    message = (
                        f"the body moves at {speed_of(body) / sound:.2g} of the speed of sound, and its equation of "
                        "state is none for shocks"
                    )
                    yield self.note(message, state or body.get("velocity") or body, "choose mie_gruneisen")
                    return


def _type_of(element: Element, attribute: str = "type") -> str:
    """The model that an element chooses."""
    found = element.attributes.get(attribute)
    return found.value.strip() if found is not None else ""
