"""No damage."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.declare import model
from solver.dispatch import implements, lanewise
from solver.materials.constitutive import Material, Step
from solver.materials.damage import DamagePoint, DamageUpdate, damages, update_damage


@model("damage", "none")
class NoDamage(NamedTuple):
    """The material is not damaged."""


@implements(damages, NoDamage)
def _(model: NoDamage) -> bool:
    return False


@implements(update_damage, NoDamage)
@lanewise
def _(
    model: NoDamage, state: Any, p: int, point: DamagePoint, material: Material, step: Step
) -> DamageUpdate:
    return DamageUpdate(point.stress, point.localized)
