"""Filling an archive while a deck runs: time steps, histories, and when they are written."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ups.archive import ArchiveWriter, ReductionFormat, Variable
from ups.archive.variables import GLOBAL_MATERIAL, NODE
from ups.deck import DataArchiver, Save, Specification
from ups.diagnostics import Diagnostics, suggestion_for
from ups.element import Element
from ups.gathering import Gathering
from ups.labels import KNOWN_LABELS
from ups.patches import grid_of
from ups.quantities import (
    ACCUMULATED,
    IDENTITY,
    POSITION,
    STRESS_AT_NODES,
    TRACTIONS,
    Quantity,
    StressHolder,
    Sum,
    material_count,
    nodal_quantities,
    particle_quantities,
    sums,
)
from ups.run import Observer, Run
from ups.schedule import Schedule

if TYPE_CHECKING:
    from solver.simulation import Simulation

FLUSH_SECONDS = 2.0
"""How long lines of the histories may wait in memory."""

_RANGES = re.compile(r"\s*(?:all|-?\d+(?:\s*-\s*-?\d+)?(?:[\s,]+-?\d+(?:\s*-\s*-?\d+)?)*)?\s*")
_RANGE = re.compile(r"(-?\d+)(?:\s*-\s*(-?\d+))?")

Place = Callable[[Any], Element | None]


@dataclass
class Plan:
    """What a deck saves.

    Attributes
    ----------
    fields : variables on particles and nodes, in the deck's order, with the materials that are kept.
    histories : the same for values of which there is one a step.
    stress : holds the recorder of the stress at the nodes, once a run has made it.
    faces : faces whose tractions are saved.
    """

    fields: list[Quantity] = field(default_factory=list)
    histories: list[Sum] = field(default_factory=list)
    stress: StressHolder = field(default_factory=StressHolder)
    faces: tuple[str, ...] = ()


def plan_output(specification: Specification, place: Place, diagnostics: Diagnostics) -> Plan:
    """Find what the ``<save>`` tags of a deck mean; problems become diagnostics.

    An unknown label is an error. One that Uintah knows, but that this deck or program does not provide, is a
    warning, and the variable is left out. ``p.x`` and ``p.particleID`` are added where particles are saved.
    """
    return _Planner(specification, place, diagnostics).plan()


def parse_indices(text: str) -> set[int] | None:
    """The numbers that a text such as ``0, 2-4`` or ``-2--1`` names; None for all.

    Raises
    ------
    ValueError : the text is no such list.
    """
    if not _RANGES.fullmatch(text):
        raise ValueError(f"{text!r} is not a list of numbers and ranges such as 0,2-4")
    found: set[int] = set()
    for low, high in _RANGE.findall(text):
        found |= set(range(int(low), int(high or low) + 1))
    return found or None


class _Planner:
    """Reads the ``<save>`` tags of one deck."""

    def __init__(self, specification: Specification, place: Place, diagnostics: Diagnostics) -> None:
        self.section = specification.DataArchiver
        self.materials = material_count(specification)
        self.faces = specification.MPM.boundary_traction_faces
        self.place = place
        self.diagnostics = diagnostics
        self.stress = StressHolder()
        self.known_fields = particle_quantities(specification) | nodal_quantities(specification, self.stress)
        self.known_sums = sums(specification)
        self.fields: dict[str, Quantity] = {}
        self.histories: dict[str, Sum] = {}

    def plan(self) -> Plan:
        self._check_intervals()
        for save in self.section.save:
            self._add(save)
        wanted = {
            face for face in self.faces if {f"{name}_{face}" for name in TRACTIONS} & self.histories.keys()
        }
        return Plan(
            fields=[q for q in self._with_identity().values() if q.materials],
            histories=[h for h in self.histories.values() if h.materials],
            stress=self.stress,
            faces=tuple(face for face in self.faces if face in wanted),
        )

    def _check_intervals(self) -> None:
        section, at = self.section, self.place(self.section)
        if (section.outputInterval or section.outputTimestepInterval) and not section.save:
            message = "an output interval is given, and no <save label=...> says what to write"
            self.diagnostics.error("UPS101", message, at)
        checkpoint = section.checkpoint
        if checkpoint is None or checkpoint.lastTimestep or Schedule.of_checkpoints(checkpoint).is_active:
            return
        message = "<checkpoint> gives no interval: no checkpoint is written"
        self.diagnostics.warning("UPS106", message, self.place(checkpoint) or at)

    def _add(self, save: Save) -> None:
        asked = self._indices(save, "material")
        levels = self._indices(save, "levels")
        self._check_materials(save, asked)
        if levels is not None and not levels & {0, -1}:
            return
        label = save.label
        if label in self.known_fields:
            field_ = self.known_fields[label]
            kept = self._kept(save, field_.materials, asked, self.fields.get(label))
            variable = replace(field_.variable, compression=save.compression)
            self.fields[label] = replace(field_, variable=variable, materials=kept)
        elif label in self.known_sums:
            history = self.known_sums[label]
            kept = self._kept(save, history.materials, asked, self.histories.get(label))
            self.histories[label] = replace(history, materials=kept)
        else:
            self._say_unknown(save)

    def _indices(self, save: Save, attribute: str) -> set[int] | None:
        try:
            return parse_indices(getattr(save, attribute))
        except ValueError as problem:
            at = self._attribute(save, attribute)
            self.diagnostics.error("UPS204", f"attribute {attribute!r}: {problem}", at)
            return None

    def _attribute(self, save: Save, name: str) -> Any:
        element = self.place(save)
        return element.attributes.get(name, element) if element is not None else None

    def _check_materials(self, save: Save, asked: set[int] | None) -> None:
        """See that chosen materials exist; one more than the last stands for all together."""
        missing = sorted(m for m in asked or () if not GLOBAL_MATERIAL <= m <= self.materials)
        if missing:
            message = f"there is no material {missing[0]}: the deck has 0 to {self.materials - 1}"
            self.diagnostics.error("UPS402", message, self._attribute(save, "material"))

    def _kept(
        self, save: Save, provided: tuple[int, ...], asked: set[int] | None, before: Quantity | Sum | None
    ) -> tuple[int, ...]:
        """The materials to save for: those asked for that have the variable, and those of an earlier tag."""
        lacking = sorted((asked or set()) - set(provided))
        if lacking:
            message = f"{save.label} is not there for material {', '.join(map(str, lacking))}: it is left out"
            advice = "it is stored for all materials together" if provided == (GLOBAL_MATERIAL,) else None
            self.diagnostics.warning("UPS406", message, self._attribute(save, "material"), advice)
        chosen = set(provided) if asked is None else asked
        return tuple(m for m in provided if m in chosen or (before is not None and m in before.materials))

    def _say_unknown(self, save: Save) -> None:
        label, at = save.label, self._attribute(save, "label")
        if label in KNOWN_LABELS:
            message = f"{label} is known to Uintah, and not computed for this deck: it is left out"
            self.diagnostics.warning("UPS406", message, at)
            return
        candidates = sorted({*self.known_fields, *self.known_sums, *KNOWN_LABELS})
        message = f"there is no variable {label!r} to save"
        self.diagnostics.error("UPS406", message, at, suggestion_for(label, candidates))

    def _with_identity(self) -> dict[str, Quantity]:
        """Positions and identities go with any particle variable, for all materials that have them."""
        particles = [q for q in self.fields.values() if q.variable.is_particle]
        if not particles:
            return self.fields
        materials = sorted({m for q in particles for m in q.materials})
        heads = {}
        for label in (POSITION, IDENTITY):
            known = self.known_fields[label].materials
            head = self.fields.get(label, self.known_fields[label])
            heads[label] = replace(head, materials=tuple(m for m in materials if m in known))
        return heads | {label: q for label, q in self.fields.items() if label not in heads}


def reduction_format(section: DataArchiver) -> ReductionFormat:
    """How the histories are written; an ``onTimeStep`` that never comes becomes the first, as in Uintah."""
    on = section.onTimeStep
    if on >= section.frequency:
        on = 1 if section.frequency > 1 else 0
    return ReductionFormat(section.frequency, on, section.timeStep, section.simTime)


class TimestepOutput(Observer):
    """Writes the variables on particles and nodes when they are due."""

    def __init__(
        self,
        writer: ArchiveWriter,
        plan: Plan,
        schedule: Schedule,
        *,
        at_start: bool = False,
        gathering: Gathering | None = None,
    ) -> None:
        self.schedule = schedule
        self._gathering = gathering or Gathering()
        self._writer = writer
        self._plan = plan
        self._at_start = at_start
        self._due = False

    def begin(self, run: Run) -> None:
        """Set up recorders, and write the state at the start where the deck asks for it."""
        if any(q.variable.container == NODE for q in self._plan.fields):
            run.simulation.whole_grid = True  # as sus writes them, empty nodes included
        if any(q.variable.name == STRESS_AT_NODES for q in self._plan.fields):
            self._plan.stress.attach(run.simulation)
        if self._at_start and run.simulation.step_number == 0 and self.schedule.is_active:
            self._due = True
            self._write(run, initial=True)

    def before_step(self, run: Run, dt: float) -> None:
        """See whether the step is to be written, and have recorded what cannot be found afterwards."""
        simulation = run.simulation
        self._due = self.schedule.is_active and self.schedule.due(
            simulation.time + dt, simulation.step_number + 1, run.wall_time, run.is_last
        )
        self._plan.stress.want(self._due)

    def after_step(self, run: Run) -> None:
        """Write the step if it is due."""
        if self._due:
            self._write(run)

    def end_of_step(self) -> float:
        """The next time of output; none where the step that just ended is written, as in Uintah."""
        return float("inf") if self._due else self.schedule.end_of_step()

    def _write(self, run: Run, initial: bool = False) -> None:
        simulation = run.simulation
        fields = {
            q.variable: {m: q.values(simulation, m) for m in q.materials}
            for q in self._plan.fields
            if q.initially or not initial
        }
        self._writer.use_grid(grid_of(simulation, self._gathering.ranks_a_file))
        gathered = self._gathering.fields(simulation, fields)
        self._writer.write_timestep(simulation.step_number, simulation.time, run.dt, gathered)
        self.schedule.done(simulation.time, simulation.step_number, run.wall_time)


class HistoryOutput(Observer):
    """Adds a line to each ``.dat`` file after each step.

    Attributes
    ----------
    accumulated : the sum of StrainEnergy over the steps, which a checkpoint has to keep.
    """

    def __init__(self, writer: ArchiveWriter, plan: Plan, *, at_start: bool = False) -> None:
        self.accumulated = 0.0
        self._writer = writer
        self._plan = plan
        self._at_start = at_start
        self._flushed = time.monotonic()

    def begin(self, run: Run) -> None:
        """Set up the recording of tractions; the state at the start has a line of what is summed up only."""
        simulation = run.simulation
        if self._plan.faces:
            from solver.nodal_stress import FaceTractions

            FaceTractions(self._plan.faces).attach(simulation)
        if self._at_start and simulation.step_number == 0:
            known = [h.variable for h in self._plan.histories if h.variable.name == ACCUMULATED]
            values = {variable: {GLOBAL_MATERIAL: 0.0} for variable in known}
            self._writer.append_reductions(0, simulation.time, values)

    def after_step(self, run: Run) -> None:
        """Add the lines of the step."""
        simulation = run.simulation
        self.accumulated += float(simulation.reductions.get(("StrainEnergy", GLOBAL_MATERIAL), 0.0))
        simulation.reductions[ACCUMULATED, GLOBAL_MATERIAL] = self.accumulated
        values = {
            h.variable: {m: _value(simulation, h.variable, m) for m in h.materials}
            for h in self._plan.histories
        }
        self._writer.append_reductions(simulation.step_number, simulation.time, values, last=run.is_last)
        if time.monotonic() - self._flushed > FLUSH_SECONDS:
            self._writer.flush()
            self._flushed = time.monotonic()


def _value(simulation: Simulation, variable: Variable, material: int) -> Any:
    """The value of the last step; zero where nothing acted, such as a contact law before its time."""
    value = simulation.reductions.get((variable.name, material))
    return np.zeros(variable.element_type.shape) if value is None else value
