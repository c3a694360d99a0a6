"""What a deck can save: Uintah's labels and types, and where a simulation keeps the values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solver.cohesive_zones import ZoneState
from solver.contact.motion import PrescribedMotion
from solver.diffusion.solute import Solute
from solver.materials.constitutive import state_record
from solver.materials.damage import damage_state
from solver.materials.erosion import ErosionState
from solver.particles import Particles, StateVariable, state_variables
from ups.archive import Variable
from ups.archive.variables import GLOBAL_MATERIAL, NODE, PARTICLE, REDUCTION
from ups.deck import Specification
from ups.labels import CONCENTRATIONS, TOTAL_CONCENTRATION
from ups.patches import stored_nodes

if TYPE_CHECKING:
    from solver.nodal_stress import NodalStress
    from solver.simulation import Simulation

Array = NDArray[Any]

POSITION, IDENTITY, STRESS_AT_NODES = "p.x", "p.particleID", "g.stressFS"
ACCUMULATED = "AccStrainEnergy"
"""The sum of StrainEnergy over the steps, which is kept by whoever writes it."""

NODAL_FIELDS: dict[str, tuple[str, str]] = {
    "g.mass": ("mass", "double"),
    "g.volume": ("volume", "double"),
    "g.velocity": ("velocity", "Vector"),
    "g.temperature": ("temperature", "double"),
    "g.velocity_star": ("velocity_star", "Vector"),
    "g.acceleration": ("acceleration", "Vector"),
    "g.internalforce": ("internal_force", "Vector"),
    "g.externalforce": ("external_force", "Vector"),
    "g.temperatureRate": ("temperature_rate", "double"),
}
"""Label -> (field of NodalFields, element type), one value a material."""

SUMS_BY_MATERIAL: dict[str, str] = {
    "KineticEnergy": "double",
    "ThermalEnergy": "double",
    "TotalMass": "double",
    "TotalMomentum": "Vector",
    "CenterOfMassPosition": "Vector",
    "SumTransmittedForce": "Vector",
}
"""Sums over the particles of a material; of all materials together too, and only so where there is one."""

SUMS_OVER_ALL: dict[str, str] = {
    "StrainEnergy": "double",
    ACCUMULATED: "double",
    "TotalVolumeDeformed": "double",
}
REACTIONS: dict[str, str] = {"RigidReactionForce": "Vector", "RigidReactionTorque": "Vector"}
ON_FACES: dict[str, str] = {"BndyForce": "Vector", "BndyContactCellArea": "double"}
TRACTIONS: dict[str, str] = {"BndyTraction": "Vector", "BndyContactArea": "double"}


@dataclass(frozen=True)
class Quantity:
    """A variable on particles or nodes that a deck can save.

    Attributes
    ----------
    variable : how an archive declares it.
    materials : indices that it has values for; for a nodal variable the number of materials stands for all
        materials together, as in Uintah.
    values : from the simulation and one of the materials to the values, as ``ups.archive.Fields`` takes them.
    initially : whether it is known before the first step.
    """

    variable: Variable
    materials: tuple[int, ...]
    values: Callable[[Simulation, int], Array]
    initially: bool = True


@dataclass(frozen=True)
class Sum:
    """A value a step, for each of some materials (-1 for all together)."""

    variable: Variable
    materials: tuple[int, ...]


class StressHolder:
    """Stands for the recorder of nodal stress in a plan, which is made without compiling anything."""

    def __init__(self) -> None:
        self._recorder: NodalStress | None = None

    def attach(self, simulation: Simulation) -> None:
        """Make the recorder, and let it watch a simulation."""
        from solver.nodal_stress import NodalStress

        self._recorder = NodalStress()
        self._recorder.attach(simulation)

    def want(self, wanted: bool) -> None:
        """Say whether the coming step is to be recorded."""
        if self._recorder is not None:
            self._recorder.wanted = wanted

    @property
    def values(self) -> Array:
        """What was recorded last, (M, N, 3, 3).

        Raises
        ------
        RuntimeError : nothing records.
        """
        if self._recorder is None:
            raise RuntimeError("the stress at the nodes is not recorded")
        return self._recorder.values


def particle_quantities(specification: Specification) -> dict[str, Quantity]:
    """Everything that particles carry, by label: what all have, and what their materials' models add."""
    records: dict[int, tuple[type, ...]] = {
        m: (
            Particles,
            state_record(section.constitutive_model),
            damage_state(section.damage),
            *([ErosionState] if section.erosion is not None else []),
        )
        for m, section in enumerate(specification.materials)
    }
    bodies = tuple(records)
    records |= dict.fromkeys(range(len(records), material_count(specification)), (ZoneState,))
    found = {
        label: Quantity(Variable(label, PARTICLE, variable.element), tuple(where), _of_records(where))
        for label, (variable, where) in _kept_in(records).items()
    }
    if specification.MPM.scalar_diffusion:
        for name, variable in state_variables(Solute).items():
            declared = Variable(variable.label, PARTICLE, variable.element)
            found[variable.label] = Quantity(declared, bodies, _of_solute(name))
    found["p.scalefactor"] = Quantity(
        Variable("p.scalefactor", PARTICLE, "Matrix3"), bodies, _particle_edges, False
    )
    return found


def material_count(specification: Specification) -> int:
    """How many materials an archive has: those of particles, and after them those of cohesive zones."""
    flags, section = specification.MPM, specification.MaterialProperties.MPM
    return len(specification.materials) + len(section.cohesive_zone) * flags.use_cohesive_zones


def _kept_in(
    records: Mapping[int, tuple[type, ...]],
) -> dict[str, tuple[StateVariable, dict[int, tuple[int, str]]]]:
    """Label -> declaration, and material -> number and field of the record that keeps it; the first has it."""
    found: dict[str, tuple[StateVariable, dict[int, tuple[int, str]]]] = {}
    for m, kept in records.items():
        for number, record in enumerate(kept):
            for name, variable in state_variables(record).items():
                first, where = found.setdefault(variable.label, (variable, {}))
                if first.element == variable.element:
                    where.setdefault(m, (number, name))
    found.pop("", None)
    return found


def _of_records(where: Mapping[int, tuple[int, str]]) -> Callable[[Simulation, int], Array]:
    def values(simulation: Simulation, m: int) -> Array:
        number, name = where[m]
        return np.asarray(getattr(simulation.materials[m].records[number], name))

    return values


def _of_solute(name: str) -> Callable[[Simulation, int], Array]:
    return lambda simulation, m: np.asarray(getattr(simulation.bodies[m].solute, name))


def _particle_edges(simulation: Simulation, m: int) -> Array:
    """Deformed edge vectors of the particles as columns, F diag(h) R: (n, 3, 3), lengths of the deck."""
    particles = simulation.bodies[m].particles
    edges = np.array(simulation.grid.spacing)[:, None] * particles.size
    return np.asarray(particles.deformation_gradient @ edges)


def nodal_quantities(specification: Specification, stress: StressHolder) -> dict[str, Quantity]:
    """Everything at the nodes, by label; ``stress`` records the stress there."""
    each = tuple(range(len(specification.materials)))
    with_all = (*each, material_count(specification))
    found = {}
    for label, (field, element) in NODAL_FIELDS.items():
        mean = _MEANS.get(field)
        found[label] = Quantity(
            Variable(label, NODE, element), with_all if mean else each, _of_nodes(field, mean), False
        )
    found[STRESS_AT_NODES] = Quantity(
        Variable(STRESS_AT_NODES, NODE, "Matrix3"), with_all, _stress_at_nodes(stress), False
    )
    if specification.MPM.scalar_diffusion:
        for label, field in CONCENTRATIONS.items():
            found[label] = Quantity(Variable(label, NODE, "double"), each, _of_diffusion(field), False)
    found["NC_CCweight"] = Quantity(Variable("NC_CCweight", NODE, "double"), (0,), _node_to_cell_weight)
    return found


def _of_nodes(field: str, mean: Callable[[Any, Array], Array] | None) -> Callable[[Simulation, int], Array]:
    def values(simulation: Simulation, m: int) -> Array:
        nodal = getattr(simulation.nodal, field)
        if mean is not None and m >= len(simulation.bodies):
            return on_lattice(simulation, mean(simulation.nodal, nodal))
        return on_lattice(simulation, nodal[m])

    return values


def _of_diffusion(field: str) -> Callable[[Simulation, int], Array]:
    def values(simulation: Simulation, m: int) -> Array:
        return on_lattice(simulation, getattr(simulation.diffusion.nodal, field)[m])

    return values


def _stress_at_nodes(stress: StressHolder) -> Callable[[Simulation, int], Array]:
    def values(simulation: Simulation, m: int) -> Array:
        if m < len(simulation.bodies):
            return on_lattice(simulation, stress.values[m])
        return on_lattice(simulation, _weighted(simulation.nodal.volume, stress.values))

    return values


def _node_to_cell_weight(simulation: Simulation, m: int) -> Array:
    return on_lattice(simulation, simulation.boundary_conditions.node_to_cell_weight())


def _total(nodal: Any, field: Array) -> Array:
    return np.asarray(field.sum(axis=0))


def _mean_by_mass(nodal: Any, field: Array) -> Array:
    return _weighted(nodal.mass, field)


def _weighted(weight: Array, field: Array) -> Array:
    """The mean over materials, sum_m w_m f_m / sum_m w_m, of (M, N, ...)."""
    w = weight.reshape(weight.shape + (1,) * (field.ndim - 2))
    return np.asarray((w * field).sum(axis=0) / w.sum(axis=0))


_MEANS: dict[str, Callable[[Any, Array], Array]] = {
    "mass": _total,
    "volume": _total,
    "velocity": _mean_by_mass,
    "temperature": _mean_by_mass,
}
"""How the nodal fields of all materials together follow from those of each."""


def on_lattice(simulation: Simulation, nodal: Array) -> Array:
    """The nodes that an archive stores, of a field (N, ...) over all stored nodes: a view [x, y, z, ...].

    Those are the nodes of the domain and its extra cells; where it is periodic, the last node is the first. A
    rank of several has those of its patches.
    """
    box = stored_nodes(simulation).within(simulation.grid.index.first)
    return np.asarray(simulation.grid.as_box(nodal)[box])


def sums(specification: Specification) -> dict[str, Sum]:
    """Every history that a deck can save, by label."""
    section = specification.MaterialProperties.MPM
    count = len(specification.materials)
    everything = (GLOBAL_MATERIAL, *range(count)) if count > 1 else (GLOBAL_MATERIAL,)
    by_material = dict(SUMS_BY_MATERIAL)
    if any(isinstance(law, PrescribedMotion) for law in section.contact):
        by_material |= REACTIONS
    over_all = dict(SUMS_OVER_ALL)
    if specification.MPM.scalar_diffusion:
        over_all[TOTAL_CONCENTRATION] = "double"
    for face in specification.MPM.boundary_traction_faces:
        over_all |= {f"{name}_{face}": element for name, element in (ON_FACES | TRACTIONS).items()}
    found = {n: Sum(Variable(n, REDUCTION, element), everything) for n, element in by_material.items()}
    found |= {n: Sum(Variable(n, REDUCTION, e), (GLOBAL_MATERIAL,)) for n, e in over_all.items()}
    return found
