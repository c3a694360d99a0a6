"""No contact law: each material moves in its own velocity field."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from solver.contact.law import ContactLaw, ContactScene
from solver.declare import Parameter, model


@model("contact", "null")
@dataclass(kw_only=True)
class NullContact(ContactLaw):
    """Bodies pass through each other: nodal velocities stay as they are."""

    mu: Annotated[float, Parameter("coefficient of friction", ignored="there is no contact")] = 0.0

    def apply(self, part: int, scene: ContactScene) -> None:
        """Leave the velocities alone."""
