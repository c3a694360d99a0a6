"""The methods that ``<SimulationComponent>`` chooses from, and the sections that each takes."""

from __future__ import annotations

import importlib
from typing import NamedTuple


class Component(NamedTuple):
    """A method of Uintah."""

    meaning: str
    record: str | None = None
    """Its sections, as ``module:Class``; None where the deck is not checked beyond its form."""
    runs: bool = False
    """Whether this program runs it."""

    def load(self) -> type:
        """The record of its sections."""
        assert self.record is not None
        module, _, name = self.record.partition(":")
        found: type = getattr(importlib.import_module(module), name)
        return found


_MPM = "ups.grammar.methods:MpmLike"
_MPMICE = "ups.grammar.methods:MpmIce"

COMPONENTS: dict[str, Component] = {
    "mpm": Component("the material point method", "ups.deck:Specification", runs=True),
    "mpmice": Component("the coupled gas-solid method", _MPMICE),
    "rmpmice": Component("the coupled gas-solid method with rigid particles", _MPMICE),
    "rigidmpmice": Component("the coupled gas-solid method with rigid particles", _MPMICE),
    "smpmice": Component("the coupled gas-solid method with shells", _MPMICE),
    "shellmpmice": Component("the coupled gas-solid method with shells", _MPMICE),
    "ice": Component("the multi-material method of gas dynamics", "ups.grammar.methods:Ice"),
    "impm": Component("the implicit material point method", _MPM),
    "amrmpm": Component("the material point method on several levels", _MPM),
    "rmpm": Component("the material point method with rigid particles", _MPM),
    "rigidmpm": Component("the material point method with rigid particles", _MPM),
    "smpm": Component("the material point method with shells", _MPM),
    "shellmpm": Component("the material point method with shells", _MPM),
    "shmpm": Component("the material point method with pore water", _MPM),
    "sfmpm": Component("the material point method with a single field", _MPM),
    "switcher": Component("one method after the other"),
    "arches": Component("combustion"),
    "wasatch": Component("reacting flow"),
    "phasefield": Component("phase fields"),
    "esmpm": Component("electrostatics of particles"),
    "esmpm2": Component("electrostatics of particles"),
    "mpnp": Component("ions in solution"),
    "electrostatic_solver": Component("electrostatics"),
    "rmcrt_test": Component("a test of radiation"),
    "postprocessuda": Component("quantities computed from an archive"),
    "particletest": Component("a test of particles"),
    "regriddertest": Component("a test of grid refinement"),
    "solvertest": Component("a test of linear solvers"),
    "unifiedschedulertest": Component("a test of the scheduler"),
    "gauss_solver": Component("a linear solver"),
    "benchmark": Component("an example of Uintah"),
    "dosweep": Component("an example of Uintah"),
    "burger": Component("an example of Uintah"),
    "heat": Component("an example of Uintah"),
    "poisson1": Component("an example of Uintah"),
    "poisson2": Component("an example of Uintah"),
    "poisson3": Component("an example of Uintah"),
    "poisson4": Component("an example of Uintah"),
    "wave": Component("an example of Uintah"),
}
"""Name in lower case -> the method."""
