"""What a run would do, without doing it: materials, particles, cells, first step, memory and size of the archive."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from solver.declare import FAMILIES, fields
from ups.deck import MaterialSection, Specification, read_deck
from ups.sizes import BYTES_A_NODE, BYTES_A_PARTICLE, readable_size, size_of_output

SECONDS_A_PARTICLE_STEP = 2.0e-7
"""Time that a particle takes in a step on one core, of a common model."""


@dataclass(frozen=True)
class MaterialPlan:
    """A material of the run."""

    index: int
    name: str
    model: str
    particles: int
    parts: tuple[str, ...] = ()
    """The models that the deck chose within it: flow stress, equation of state, damage and the like."""


@dataclass(frozen=True)
class RunPlan:
    """What a run would do.

    Attributes
    ----------
    materials : in the order of their indices.
    zones : name and number of the cohesive zones of each file, whose materials come after these.
    interpolator : the shape functions between particles and nodes.
    contacts, loads : the laws and the loads by their names in the deck.
    cells : of the grid in each direction.
    nodes : of the grid, those outside its faces included.
    first_step : the first time step, in the deck's unit of time.
    steps : how many steps are foreseen, at the length that stability asks for at the start.
    outputs : how many times the archive is written.
    memory, archive : in bytes, roughly.
    seconds : of computing on one core, roughly.
    """

    materials: tuple[MaterialPlan, ...]
    zones: tuple[tuple[str, int], ...]
    interpolator: str
    contacts: tuple[str, ...]
    loads: tuple[str, ...]
    cells: tuple[int, int, int]
    nodes: int
    first_step: float
    steps: int
    outputs: int
    memory: int
    archive: int
    seconds: float

    @property
    def particles(self) -> int:
        """Of all materials."""
        return sum(material.particles for material in self.materials)


def plan_run(path: str | os.PathLike[str]) -> RunPlan:
    """Look ahead at the run of a deck.

    Raises
    ------
    DeckError : the deck cannot be run.
    """
    from ups.factory import build

    deck = read_deck(path)
    specification = deck.require()
    simulation = build(deck)
    control = specification.Time
    stable = float(simulation.initial_time_step())
    first = control.limit(stable, control.initTime, 0.0, math.inf)
    usual = control.usual_step(stable)
    steps = control.foreseen_steps(stable, control.initTime)
    materials = tuple(
        MaterialPlan(
            body.index,
            section.name,
            _model_name("constitutive_model", section.constitutive_model),
            len(body.particles),
            tuple(_parts(section)),
        )
        for body, section in zip(simulation.bodies, specification.materials, strict=True)
    )
    zones = tuple((tied.law.name, len(tied.zones.area)) for tied in simulation.cohesive_zones)
    particles = sum(material.particles for material in materials)
    nodes = math.prod(n + 3 for n in simulation.grid.cells)
    outputs = _outputs(specification, steps, usual)
    return RunPlan(
        materials=materials,
        zones=zones,
        interpolator=specification.MPM.interpolator,
        contacts=tuple(_model_name("contact", c) for c in specification.MaterialProperties.MPM.contact),
        loads=tuple(_model_name("load", load) for load in specification.PhysicalBC.MPM.loads),
        cells=simulation.grid.cells,
        nodes=nodes,
        first_step=first,
        steps=steps,
        outputs=outputs,
        memory=particles * BYTES_A_PARTICLE + nodes * len(materials) * BYTES_A_NODE,
        archive=outputs
        * _bytes_an_output(
            specification,
            {"p.": particles, "g.": nodes * len(materials), "cz.": sum(count for _, count in zones)},
        ),
        seconds=particles * steps * SECONDS_A_PARTICLE_STEP,
    )


def _model_name(family: str, model: object) -> str:
    """The name by which a deck chooses a model."""
    names = FAMILIES[family].models.items()
    return next((name for name, record in names if isinstance(model, record)), type(model).__name__)


def _parts(section: MaterialSection) -> Iterator[str]:
    """The models within a material, by tag and name."""
    records: tuple[Any, ...] = (section.constitutive_model, section)
    for record in records:
        for info in fields(record.__class__):
            part = getattr(record, info.name)
            if info.sub_model is None or info.many or part is None or info.name == "constitutive_model":
                continue
            name = _model_name(info.sub_model.family, part)
            if name != "none":
                yield f"{info.tag} {name}"


def _outputs(specification: Specification, steps: int, step: float) -> int:
    """How often the archive is written."""
    section = specification.DataArchiver
    if section.outputTimestepInterval:
        return steps // section.outputTimestepInterval
    if section.outputInterval:
        return int(steps * step / max(section.outputInterval, step))
    return 0


def _bytes_an_output(specification: Specification, counts: dict[str, int]) -> int:
    """Size of one output; ``counts`` has the number of values of labels by what these begin with."""
    archiver = specification.DataArchiver
    return int(
        size_of_output((save.label for save in archiver.save), counts, single=archiver.outputDoubleAsFloat)
    )


def _lines(plan: RunPlan) -> Iterator[str]:
    cells = " x ".join(map(str, plan.cells))
    yield f"grid        {cells} cells, {plan.nodes} nodes"
    for material in plan.materials:
        name = f" ({material.name})" if material.name else ""
        yield f"material {material.index}  {material.model}{name}, {material.particles} particles"
        yield from (f"              {part}" for part in material.parts)
    for number, (name, count) in enumerate(plan.zones, len(plan.materials)):
        yield f"material {number}  {count} cohesive zones{f' ({name})' if name else ''}"
    yield f"weights     {plan.interpolator}"
    if plan.contacts:
        yield f"contact     {', '.join(plan.contacts)}"
    if plan.loads:
        yield f"loads       {', '.join(plan.loads)}"
    yield f"particles   {plan.particles}"
    yield f"first step  {plan.first_step:.4g}"
    yield f"steps       about {plan.steps}"
    yield f"outputs     about {plan.outputs}, {readable_size(plan.archive)}"
    yield f"memory      about {readable_size(plan.memory)}"
    yield f"computing   about {_duration(plan.seconds)} on one core"


def _duration(seconds: float) -> str:
    for length, name in ((86400.0, "days"), (3600.0, "hours"), (60.0, "minutes")):
        if seconds >= 2.0 * length:
            return f"{seconds / length:.0f} {name}"
    return f"{max(seconds, 1.0):.0f} seconds"


def plan_command(path: str) -> tuple[str, int]:
    """What ``ups plan DECK`` prints.

    Raises
    ------
    DeckError : the deck cannot be run.
    """
    return "\n".join(_lines(plan_run(path))), 0
