"""UPS406."""

from __future__ import annotations

import re
from collections.abc import Iterator

from solver.declare import Section
from ups.diagnostics import Diagnostic, Fix, did_you_mean
from ups.element import Attribute, Element
from ups.grammar.saved_labels import LABELS, PATTERNS
from ups.labels import CONCENTRATIONS, TOTAL_CONCENTRATION
from ups.rules.rule import DeckView, Rule

_ALWAYS = """
    p.scalefactor p.JThermal g.mass g.volume g.velocity g.velocity_star g.acceleration g.internalforce
    g.externalforce g.temperature g.temperatureRate g.stressFS g.color g.massall g.surfnorm g.position
    g.normtraction g.externalHeatRate g.dTdt g.contact g.thermalContactTemperatureRate g.velocityBC
    g.alphaMaterial g.zoi g.temperaturenobc g.temperatureStar g.matlProminence g.normAlphaToBeta g.surf
    g.displacement NC_CCweight KineticEnergy StrainEnergy AccStrainEnergy ThermalEnergy TotalMass
    TotalMomentum TotalVolumeDeformed CenterOfMassPosition RigidReactionForce RigidReactionTorque
    SumTransmittedForce SumTransmittedTorque TotalMomentOfInertia TotalLocalizedParticle frictionalWork
"""
"""What every deck of the method can save."""

_WITH_GASES = ("mpmice", "rmpmice", "rigidmpmice")
_WITH_STATE = ("constitutive_model", "damage_model", "erosion")


class SavedLabel(Rule):
    """A variable to save does not exist, or is not computed for this deck.

    **Why.** Uintah stops when the first step is done: ``variable not found to save`` for a name that nothing
    has, ``variable not computed for saving`` for one that no chosen model provides.

    **Example.** ``<save label="p.plasticStrain"/>`` in a deck whose materials are all elastic.

    **Repair.** Take a label that the deck's models provide (``ups explain`` lists them), or remove the line.
    """

    code = "UPS406"
    title = "variable is not computed by this deck"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at every <save>."""
        provided = _provided(deck)
        for save in deck.all("DataArchiver/save"):
            label = save.attributes.get("label")
            name = label.value.strip() if label is not None else ""
            if label is None or not name or any(re.fullmatch(p, name) for p in PATTERNS):
                continue
            if name not in LABELS and name not in provided:
                yield self._unknown(name, label, provided)
            elif name not in provided and _must_be_provided(name, deck):
                yield self._not_computed(name, save, label, provided)

    def _unknown(self, name: str, label: Attribute, provided: set[str]) -> Diagnostic:
        nearest = did_you_mean(name, sorted(provided)) or did_you_mean(name, LABELS)
        fix = Fix((label.replaced(nearest),), safe=False) if nearest else None
        suggestion = f"did you mean {nearest}?" if nearest else "remove it"
        return self.error(f"there is no variable {name!r} to save", label, suggestion, fix)

    def _not_computed(self, name: str, save: Element, label: Attribute, provided: set[str]) -> Diagnostic:
        nearest = did_you_mean(name, sorted(provided))
        kind = name.partition(".")[0] + "." if "." in name else ""
        same = sorted(p for p in provided if p.startswith(kind) and (kind or "." not in p))
        message = f"no model of this deck computes {name!r}; those that it has are {', '.join(same)}"
        suggestion = (
            f"did you mean {nearest}?" if nearest else "remove it, or choose a model that computes it"
        )
        return self.warning(message, label, suggestion, Fix((save.removed(),), safe=False))


def _must_be_provided(name: str, deck: DeckView) -> bool:
    """Whether a label that nothing of the method computes cannot come from elsewhere either."""
    if deck.switch("MPM/coupled_flow_analysis") or deck.component not in ("mpm", *_WITH_GASES):
        return False
    if not name.startswith("p."):
        return deck.component == "mpm"
    parts = [e for m in deck.particle_materials for e in m.children if e.tag in _WITH_STATE]
    return all(_is_run(deck.record(part)) for part in parts)


def _is_run(model: object) -> bool:
    """Whether a model could be read and is one that this program runs, so that its labels are known."""
    return model is not None and not isinstance(model, Section)


def _provided(deck: DeckView) -> set[str]:
    """The labels that the material point method has for the deck's models."""
    from solver.diffusion.solute import Solute
    from solver.materials.constitutive import state_record
    from solver.materials.erosion import ErosionState
    from solver.particles import Particles, state_variables

    found = {variable.label for variable in state_variables(Particles).values()} | {*_ALWAYS.split()}
    parts = (e for m in deck.particle_materials for e in m.children if e.tag in _WITH_STATE)
    states = {state_record(model) for part in parts if (model := deck.record(part)) is not None}
    if any(m.get("erosion") for m in deck.particle_materials):
        states.add(ErosionState)
    found |= {variable.label for state in states for variable in state_variables(state).values()}
    if deck.text("MPM/boundary_traction_faces"):
        found |= {name for name in LABELS if name.startswith("Bndy")}
    if deck.component in _WITH_GASES:
        found.add("p.pressure")
    if deck.switch("MPM/use_cohesive_zones"):
        found |= {name for name in LABELS if name.startswith("cz.")}
    if deck.switch("MPM/do_scalar_diffusion"):
        found |= {variable.label for variable in state_variables(Solute).values()} | {*CONCENTRATIONS}
        found.add(TOTAL_CONCENTRATION)
    return found - {""}
