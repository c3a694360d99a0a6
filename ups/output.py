"""Filling an archive while a deck runs: time steps, histories, and when they are written."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from solver.grid import Grid
from ups.archive import ArchiveWriter, Box, ReductionFormat, Variable
from ups.archive import Grid as ArchiveGrid
from ups.archive.variables import GLOBAL_MATERIAL
from ups.deck import DataArchiver, Deck, Save, Specification
from ups.diagnostics import Diagnostics, suggestion_for
from ups.element import Element
from ups.labels import KNOWN_LABELS
from ups.quantities import (
    ACCUMULATED,
    IDENTITY,
    POSITION,
    STRESS_AT_NODES,
    TRACTIONS,
    Quantity,
    Sum,
    nodal_quantities,
    particle_quantities,
    sums,
)
from ups.run import Observer, Run
from ups.schedule import Schedule

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
    stress : recorder of the stress at the nodes (NodalStress), where that is saved.
    faces : faces whose tractions are saved.
    """

    fields: list[Quantity] = field(default_factory=list)
    histories: list[Sum] = field(default_factory=list)
    stress: Any = None
    faces: tuple[str, ...] = ()


class _StressHolder:
    """Stands between the plan, made without compiling anything, and the recorder, which needs kernels."""

    def __init__(self) -> None:
        self.recorder: Any = None

    @property
    def values(self) -> Any:
        return self.recorder.values


def plan_output(specification: Specification, place: Place, diagnostics: Diagnostics) -> Plan:
    """Find what the ``<save>`` tags of a deck mean; problems become diagnostics.

    An unknown label is an error. One that Uintah knows, but that this deck or program does not provide, is a
    warning, and the variable is left out. ``p.x`` and ``p.particleID`` are added where particles are saved.
    """
    section = specification.DataArchiver
    holder = _StressHolder()
    known_fields = particle_quantities(specification) | nodal_quantities(specification, holder)
    known_sums = sums(specification)
    plan = Plan(stress=holder)
    _check_intervals(section, place, diagnostics)
    for save in section.save:
        materials = _chosen(save, "material", place, diagnostics)
        levels = _chosen(save, "levels", place, diagnostics)
        _check_materials(save, materials, specification, place, diagnostics)
        if levels is not None and not levels & {0, -1}:
            continue
        if save.label in known_fields:
            quantity = known_fields[save.label]
            variable = replace(quantity.variable, compression=save.compression)
            kept = _kept(save, quantity.materials, materials, place, diagnostics)
            plan.fields.append(replace(quantity, variable=variable, materials=kept))
        elif save.label in known_sums:
            history = known_sums[save.label]
            plan.histories.append(replace(history, materials=_kept(save, history.materials, materials, place, diagnostics)))
        else:
            _say_unknown(save, {*known_fields, *known_sums}, place, diagnostics)
    _merge(plan)
    _add_identity(plan, known_fields)
    plan.faces = tuple(
        face
        for face in specification.MPM.boundary_traction_faces
        if any(h.variable.name in {f"{name}_{face}" for name in TRACTIONS} for h in plan.histories)
    )
    return plan


def _check_intervals(section: DataArchiver, place: Place, diagnostics: Diagnostics) -> None:
    at = place(section)
    outputs = bool(section.outputInterval), bool(section.outputTimestepInterval)
    if all(outputs):
        diagnostics.error("UPS405", "both <outputInterval> and <outputTimestepInterval> are given; keep one", at)
    if any(outputs) and not section.save:
        diagnostics.error(
            "UPS101", "an output interval is given, and no <save label=...> says what to write", at
        )
    checkpoint = section.checkpoint
    if checkpoint is not None and not Schedule.of_checkpoints(checkpoint).is_active and not checkpoint.lastTimestep:
        diagnostics.warning(
            "UPS106", "<checkpoint> gives no interval: no checkpoint is written", place(checkpoint) or at
        )


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


def _chosen(save: Save, attribute: str, place: Place, diagnostics: Diagnostics) -> set[int] | None:
    try:
        return parse_indices(getattr(save, attribute))
    except ValueError as problem:
        diagnostics.error("UPS204", f"attribute {attribute!r}: {problem}", _attribute(save, attribute, place))
        return None


def _attribute(save: Save, name: str, place: Place) -> Any:
    element = place(save)
    return element.attributes.get(name, element) if element is not None else None


def _check_materials(
    save: Save, materials: set[int] | None, specification: Specification, place: Place, diagnostics: Diagnostics
) -> None:
    """See that chosen materials exist; one more than the last stands for all together."""
    count = len(specification.MaterialProperties.MPM.material)
    missing = sorted(m for m in materials or () if not GLOBAL_MATERIAL <= m <= count)
    if missing:
        diagnostics.error(
            "UPS402",
            f"there is no material {missing[0]}: the deck has 0 to {count - 1}",
            _attribute(save, "material", place),
        )


def _kept(
    save: Save, provided: tuple[int, ...], asked: set[int] | None, place: Place, diagnostics: Diagnostics
) -> tuple[int, ...]:
    if asked is None:
        return provided
    lacking = sorted(asked - set(provided))
    if lacking:
        numbers = ", ".join(map(str, lacking))
        diagnostics.warning(
            "UPS406",
            f"{save.label} is not there for material {numbers}: it is left out",
            _attribute(save, "material", place),
        )
    return tuple(m for m in provided if m in asked)


def _say_unknown(save: Save, provided: Iterable[str], place: Place, diagnostics: Diagnostics) -> None:
    at = _attribute(save, "label", place)
    if save.label in KNOWN_LABELS:
        diagnostics.warning(
            "UPS406", f"{save.label} is known to Uintah, and not computed for this deck: it is left out", at
        )
        return
    candidates = sorted({*provided, *KNOWN_LABELS})
    diagnostics.error(
        "UPS406", f"there is no variable {save.label!r} to save", at, suggestion_for(save.label, candidates)
    )


def _merge(plan: Plan) -> None:
    """Put together labels that are saved more than once, such as once a material; drop what has none left."""
    merged: dict[str, Any] = {}
    for item in [*plan.fields, *plan.histories]:
        before = merged.get(item.variable.name)
        materials = {*item.materials, *(before.materials if before else ())}
        merged[item.variable.name] = replace(before or item, materials=tuple(sorted(materials)))
    kept = [item for item in merged.values() if item.materials]
    plan.fields = [item for item in kept if isinstance(item, Quantity)]
    plan.histories = [item for item in kept if isinstance(item, Sum)]


def _add_identity(plan: Plan, known: dict[str, Quantity]) -> None:
    """Positions and identities belong to any particle variable; positions of all materials that have one."""
    particles = [q for q in plan.fields if q.variable.is_particle]
    if not particles:
        return
    materials = tuple(sorted({m for q in particles for m in q.materials}))
    saved = {q.variable.name: q for q in particles}
    rest = [q for q in plan.fields if q.variable.name not in (POSITION, IDENTITY)]
    heads = [
        replace(known[label], materials=materials, variable=saved.get(label, known[label]).variable)
        for label in (POSITION, IDENTITY)
    ]
    plan.fields = [*heads, *rest]


def archive_grid(grid: Grid) -> ArchiveGrid:
    """The grid as an archive describes it."""
    px, py, pz = (bool(p) for p in grid.periodic)
    return ArchiveGrid.single_level(
        [Box(patch.low, patch.high) for patch in grid.patches],
        spacing=grid.spacing,
        anchor=grid.anchor,
        extra_cells=grid.extra_cells,
        periodic=(px, py, pz),
    )


def reduction_format(section: DataArchiver) -> ReductionFormat:
    """How the histories are written; an ``onTimeStep`` that never comes becomes the first, as in Uintah."""
    on = section.onTimeStep
    if on >= section.frequency:
        on = 1 if section.frequency > 1 else 0
    return ReductionFormat(section.frequency, on, section.timeStep, section.simTime)


class TimestepOutput(Observer):
    """Writes the variables on particles and nodes when they are due."""

    def __init__(self, writer: ArchiveWriter, plan: Plan, schedule: Schedule, *, at_start: bool = False) -> None:
        self.schedule = schedule
        self.written = 0
        self._writer = writer
        self._plan = plan
        self._at_start = at_start
        self._due = False

    def begin(self, run: Run) -> None:
        """Set up recorders, and write the state at the start where the deck asks for it."""
        if any(q.variable.name == STRESS_AT_NODES for q in self._plan.fields):
            from solver.nodal_stress import NodalStress

            self._plan.stress.recorder = NodalStress()
            self._plan.stress.recorder.attach(run.simulation)
        if self._at_start and run.simulation.step_number == 0 and self.schedule.is_active:
            self._due = True
            self._write(run, initial=True)

    def before_step(self, run: Run, dt: float) -> None:
        """See whether the step is to be written, and have recorded what cannot be found afterwards."""
        simulation = run.simulation
        self._due = self.schedule.is_active and self.schedule.due(
            simulation.time + dt, simulation.step_number + 1, run.wall_time, run.is_last
        )
        if self._plan.stress.recorder is not None:
            self._plan.stress.recorder.wanted = self._due

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
        self._writer.write_timestep(simulation.step_number, simulation.time, run.dt, fields)
        self.written += 1
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
            accumulated = [h for h in self._plan.histories if h.variable.name == ACCUMULATED]
            self._writer.append_reductions(0, simulation.time, {h.variable: {GLOBAL_MATERIAL: 0.0} for h in accumulated})

    def after_step(self, run: Run) -> None:
        """Add the lines of the step."""
        simulation = run.simulation
        self.accumulated += float(simulation.reductions.get(("StrainEnergy", GLOBAL_MATERIAL), 0.0))
        simulation.reductions[ACCUMULATED, GLOBAL_MATERIAL] = self.accumulated
        values = {
            h.variable: {m: simulation.reductions.get((h.variable.name, m), _zero(h.variable)) for m in h.materials}
            for h in self._plan.histories
        }
        self._writer.append_reductions(simulation.step_number, simulation.time, values, last=run.is_last)
        if time.monotonic() - self._flushed > FLUSH_SECONDS:
            self._writer.flush()
            self._flushed = time.monotonic()


def _zero(variable: Variable) -> Any:
    return np.zeros(variable.element_type.shape)


def check_output(deck: Deck) -> None:
    """Add to a deck's diagnostics what is wrong with the variables that it saves, without building anything."""
    if deck.specification is not None:
        plan_output(deck.specification, deck.reader.place, deck.diagnostics)
