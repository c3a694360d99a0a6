"""Brittle damage."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section
from ups.grammar import known


@known("damage", "Brittle")
class Brittle(Section):
    """Damage that grows with the elastic energy of tension."""

    brittle_damage_initial_threshold: Annotated[float, Parameter("energy from which damage grows")] = 57.0
    brittle_damage_fracture_energy: Annotated[float, Parameter("energy that fracture takes")] = 11.2
    brittle_damage_constant_D: Annotated[float, Parameter("slope of the damage")] = 0.1
    brittle_damage_max_damage_increment: Annotated[float, Parameter("greatest damage of a step")] = 0.1
    brittle_damage_allowRecovery: Annotated[bool, Parameter("let stiffness return in compression")] = False
    brittle_damage_recoveryCoeff: Annotated[float, Parameter("share that returns", ge=0.0, le=1.0)] = 1.0
    brittle_damage_printDamage: Annotated[bool, Parameter("print the damage")] = False
