"""UPS413."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix, did_you_mean, is_certain, register_code
from ups.element import Element
from ups.rules.rule import DeckView, Rule
from ups.values import number, numbers

LABELS = [
    "Velocity",
    "Symmetric",
    "Temperature",
    "Pressure",
    "Density",
    "SpecificVol",
    "Concentration",
    "Specific_heat",
    "Viscosity",
    "PosCharge",
    "NegCharge",
    "cc_temperature",
]
VALUED = ("Dirichlet", "Neumann")
NUMBERED = (
    "computeFromDensity",
    "LODI",
    "Sine",
    "slip",
    "creep",
    "powerLawProfile",
    "logLawProfile",
    "MMS_1",
)
"""Kinds whose value, where one is given, is a number too, though not what the face gets."""

WITHOUT_VALUE = ("Symmetric",)
KINDS = [
    "Neumann",
    "Dirichlet",
    "symmetry",
    "FreeSlipWall",
    "LODI",
    "computeFromDensity",
    "Sine",
    "slip",
    "Custom",
    "VelocityInlet",
    "StABL",
    "PressureBC",
    "WallBC",
    "OutletBC",
    "NOutletBC",
    "VelocityFileInput",
    "MassFlowInlet",
    "PartMassFlowInlet",
    "Swirl",
    "ScalarSwirl",
    "FromFile",
    "ForcedDirichlet",
    "TurbulentInlet",
    "Tabulated",
    "powerLawProfile",
    "logLawProfile",
    "creep",
    "MMS_1",
    "slipFlow",
]


class BoundaryValue(Rule):
    """A condition on a face has a kind, or a value, that does not fit what it prescribes.

    **Why.** A velocity is a vector, a temperature or a pressure is a number; the kind is ``Dirichlet`` for a
    value and ``Neumann`` for a gradient. Anything else is passed over in silence, and the face stays free.

    **Example.** ``<BCType id="all" label="Velocity" var="Dirichlet"> <value>0.0</value> </BCType>``

    **Repair.** Write ``[vx, vy, vz]`` for velocities, one number for all others.
    """

    code = register_code("UPS413", "boundary condition that cannot be read")
    title = "boundary condition that cannot be read"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at every condition of every face."""
        if deck.component in ("arches", "wasatch"):
            return
        for condition in deck.all("Grid/BoundaryConditions/Face/BCType"):
            yield from self._check_kind(condition)
            yield from self._check_value(condition)

    def _check_kind(self, condition: Element) -> Iterator[Diagnostic]:
        kind = condition.attributes.get("var")
        if kind is not None and kind.value.strip() not in KINDS:
            nearest = did_you_mean(kind.value.strip(), KINDS)
            suggestion = f"did you mean {nearest}?" if nearest else "use Dirichlet, Neumann or symmetry"
            fix = (
                Fix((kind.replaced(nearest),), is_certain(kind.value.strip(), nearest, KINDS))
                if nearest
                else None
            )
            yield self.error(f"unknown kind of condition {kind.value.strip()!r}", kind, suggestion, fix)
        label = condition.attributes.get("label")
        name = label.value.strip() if label is not None else ""
        if label is not None and name and name not in LABELS and not name.startswith(("scalar", "mass")):
            nearest = did_you_mean(name, LABELS)
            if nearest:
                fix = Fix((label.replaced(nearest),), safe=False)
                yield self.warning(
                    f"no method has a condition on {name!r}", label, f"did you mean {nearest}?", fix
                )

    def _check_value(self, condition: Element) -> Iterator[Diagnostic]:
        kind, label = condition.attributes.get("var"), condition.attributes.get("label")
        if kind is None or label is None or label.value in WITHOUT_VALUE:
            return
        value = condition.get("value")
        if kind.value.strip() in VALUED:
            yield from self._check_prescribed(condition, label.value.strip(), value)
        elif kind.value.strip() in NUMBERED and value is not None and not _is_value(value.text):
            message = f"the <value> of {label.value} is {value.text!r}; it must be a number"
            yield self.error(message, value, "write a number")

    def _check_prescribed(
        self, condition: Element, label: str, value: Element | None
    ) -> Iterator[Diagnostic]:
        """The value that a face gets: a vector in brackets or a number."""
        if value is None or not value.texts:
            yield self.error(f"the condition on {label} needs a <value>", value or condition)
            return
        width = 3 if label == "Velocity" else 1
        found = None if value.text.endswith(",") else numbers(value.text)
        form = "[vx, vy, vz]" if width == 3 else "one number"
        bare = width == 3 and not value.text.startswith("[")
        message = f"the <value> of {label} is {value.text!r}; it must be {form}"
        if found is None or (bare and len(found) == width):
            yield self.error(message, value.texts[0], f"write {form}")
        elif len(found) != width:  # Uintah passes over a wrong number of them
            yield self.warning(message, value.texts[0], f"write {form}")


def _is_value(text: str) -> bool:
    """Whether a text is nothing, a number, or a list of them in brackets."""
    return not text or number(text) is not None or (text.startswith("[") and numbers(text) is not None)
