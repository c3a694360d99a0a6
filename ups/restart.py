"""Checkpoints: everything that a run needs to go on bit for bit, and going on from one.

What Uintah knows is stored as it stores it: the particles' variables, and the next time step as ``delT``.
The rest (the order of the particles, what loads and contact laws remember, when output is due next) is kept
beside it, where other programs do not look.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solver.domains.communicator import Communicator
from solver.domains.decomposition import Domain
from solver.grid import Grid
from solver.particles import new_arrays, state_variables
from ups.archive import Archive, ArchiveError, ArchiveWriter, Patch, Variable
from ups.archive.variables import GLOBAL_MATERIAL, PARTICLE, REDUCTION
from ups.gathering import Gathering
from ups.output import HistoryOutput, TimestepOutput
from ups.patches import grid_of
from ups.run import Observer, Run
from ups.schedule import Schedule

if TYPE_CHECKING:
    from solver.simulation import Simulation

Array = NDArray[Any]

DELT = Variable("delT", REDUCTION, "double")
FORM = 2
"""Version of what ``state`` holds; a checkpoint of another version is refused."""


@dataclass(frozen=True)
class RunState:
    """Where a run stood beside its particles.

    Attributes
    ----------
    step, time, dt : the last step, the time at its end, and its size.
    next_dt : size of the step to come.
    accumulated : sum of StrainEnergy over the steps.
    next_output, next_checkpoint : time and number of the step at which each is due next.
    """

    step: int
    time: float
    dt: float
    next_dt: float
    accumulated: float
    next_output: tuple[float, int]
    next_checkpoint: tuple[float, int]


KINDS = ("particles", "state", "damage", "erosion", "solute")
"""The records of a body, in its order; cohesive zones have one, of the first kind."""


@dataclass(frozen=True)
class _Stored:
    """One array of a material: which of its records it is in, and its label in an archive, if any."""

    material: int
    record: int
    name: str
    variable: Variable | None

    @property
    def kind(self) -> str:
        """Which of the records, in a word."""
        return KINDS[self.record]

    @property
    def key(self) -> str:
        """Its name in the checkpoint's ``state``, for an array without a label of its own."""
        return f"{self.kind}/{self.material}/{self.name}"


def _stored_arrays(simulation: Simulation) -> Iterator[_Stored]:
    """Every array that a checkpoint keeps; of two that claim one label the first has it."""
    declared: dict[str, Variable] = {}
    for material in range(len(simulation.materials)):
        taken: set[str] = set()
        for number, record in enumerate(simulation.materials[material].records):
            for name, variable in state_variables(type(record)).items():
                if not variable.restart:
                    continue
                label = variable.label
                mine = Variable(label, PARTICLE, variable.element) if label and label not in taken else None
                if mine is not None and declared.setdefault(label, mine) != mine:
                    mine = None
                taken.add(label)
                yield _Stored(material, number, name, mine)


def write_checkpoint(
    writer: ArchiveWriter, run: Run, state: RunState, cycle: int, gathering: Gathering
) -> None:
    """Store a checkpoint of the present state and remove the oldest beyond ``cycle`` (0 keeps all)."""
    simulation = run.simulation
    own_fields: dict[Variable, dict[int, Array]] = {}
    own_others: dict[str, Array] = {}
    for stored in _stored_arrays(simulation):
        array = getattr(simulation.materials[stored.material].records[stored.record], stored.name)
        if stored.variable is None:
            own_others[stored.key] = array
        else:
            own_fields.setdefault(stored.variable, {})[stored.material] = array
    fields = gathering.fields(simulation, own_fields)
    others: dict[str, Any] = gathering.arrays(simulation, own_others)
    grid = grid_of(simulation, gathering.ranks_a_file)
    positions = next(by_material for variable, by_material in fields.items() if variable.name == "p.x")
    for material, position in positions.items():
        owners = grid.levels[0].nearest_patch(np.asarray(position))
        others[f"order/{material}"] = np.argsort(owners, kind="stable")
    others |= _simulation_state(simulation) | _run_state_arrays(state)
    writer.use_grid(grid)
    writer.write_checkpoint(
        state.step,
        state.time,
        state.dt,
        fields,
        global_values={DELT: {GLOBAL_MATERIAL: state.next_dt}},
        state=others,
        cycle=cycle,
    )


def _run_state_arrays(state: RunState) -> dict[str, Any]:
    return {
        "form": FORM,
        "step": state.step,
        "time": state.time,
        "dt": state.dt,
        "next_dt": state.next_dt,
        "accumulated": state.accumulated,
        "next_output": np.array(state.next_output, dtype=float),
        "next_checkpoint": np.array(state.next_checkpoint, dtype=float),
    }


def _simulation_state(simulation: Simulation) -> dict[str, Any]:
    """What the simulation keeps beside the arrays of its particles."""
    found: dict[str, Any] = {"domains": np.array(simulation.exchange.domains, np.int64).reshape(-1, 2, 3)}
    for face, force in simulation.face_forces.items():
        found[f"face_force/{face}"] = np.array(force)
    for number, law in enumerate(simulation.contact_laws):
        met = getattr(law, "condition_met_at", None)
        if met is not None:
            found[f"condition_met_at/{number}"] = met
    loads = getattr(simulation, "loads", None)
    if loads is not None:
        found["load_counts"] = np.array(sorted(loads.counts.items()), dtype=np.int64).reshape(-1, 2)
    return found


def restore(simulation: Simulation, checkpoints: Archive, step: int) -> RunState:
    """Put a simulation that was just built into the state of a checkpoint.

    Raises
    ------
    ArchiveError
        where the checkpoint is damaged, of another program, or does not fit the simulation.
    """
    state = checkpoints.state(step)
    if int(state.get("form", -1)) != FORM:
        raise ArchiveError(
            checkpoints.path, f"the checkpoint of step {step} was not written by this version of ups"
        )
    try:
        _restore_particles(simulation, checkpoints, step, state)
    except KeyError as missing:
        raise ArchiveError(
            checkpoints.path, f"the checkpoint of step {step} does not fit the deck: {missing} is missing"
        ) from None
    _restore_laws(simulation, state)
    simulation.time, simulation.step_number = float(state["time"]), int(state["step"])
    return RunState(
        step=simulation.step_number,
        time=simulation.time,
        dt=float(state["dt"]),
        next_dt=float(state["next_dt"]),
        accumulated=float(state["accumulated"]),
        next_output=_due(state["next_output"]),
        next_checkpoint=_due(state["next_checkpoint"]),
    )


def _due(pair: Array) -> tuple[float, int]:
    return float(pair[0]), int(pair[1])


def _restore_particles(
    simulation: Simulation, checkpoints: Archive, step: int, state: dict[str, Array]
) -> None:
    low, high = (np.array(corner) for corner in simulation.grid.own_cells)
    arrays: dict[_Stored, list[Array]] = {stored: [] for stored in _stored_arrays(simulation)}
    counts = dict.fromkeys(range(len(simulation.materials)), 0)
    for rank, patches in _patches_by_rank(checkpoints, step).items():
        if not any((np.maximum(p.low, low) < np.minimum(p.high, high)).all() for p in patches):
            continue
        theirs = checkpoints.state(step, rank) if rank else state
        chosen = {}
        for material in counts:
            position = _in_order(checkpoints, step, material, patches, theirs[f"order/{material}"], "p.x")
            cells = simulation.grid.cell_of(position)
            chosen[material] = np.flatnonzero(_nearest_inside(simulation.grid, cells, low, high))
            counts[material] += len(chosen[material])
        for stored, parts in arrays.items():
            if stored.variable is None:
                array = theirs[stored.key]
            else:
                order = theirs[f"order/{stored.material}"]
                array = _in_order(checkpoints, step, stored.material, patches, order, stored.variable.name)
            parts.append(array[chosen[stored.material]])
    for material, count in counts.items():
        records = []
        for number, record in enumerate(simulation.materials[material].records):
            own = {s.name: a for s, a in arrays.items() if (s.material, s.record) == (material, number)}
            mine = {name: np.concatenate(parts) for name, parts in own.items() if parts}
            records.append(_filled(type(record), count, mine))
        simulation.materials[material].records = tuple(records)


def _in_order(
    checkpoints: Archive, step: int, material: int, patches: Sequence[Patch], order: Array, label: str
) -> Array:
    """A variable of the particles in some patches, in the order in which the rank of the patches had them."""
    parts = [checkpoints.particles(step, label, material, patch.id) for patch in patches]
    by_patch = np.concatenate(parts)
    array = np.empty_like(by_patch, dtype=by_patch.dtype.newbyteorder("="))
    array[order] = by_patch
    return array


def _nearest_inside(grid: Grid, cells: Array, low: Array, high: Array) -> Array:
    """Whether cells (n, 3), or those of the domain next to them, lie in low <= c < high."""
    nearest = np.clip(cells, 0, np.array(grid.cells) - 1)
    return np.asarray(((nearest >= low) & (nearest < high)).all(axis=1))


def _patches_by_rank(checkpoints: Archive, step: int) -> dict[int, list[Patch]]:
    """The patches that each rank wrote, by ascending number."""
    found: dict[int, list[Patch]] = {}
    for patch in checkpoints.grid(step).levels[0].patches:
        found.setdefault(patch.proc, []).append(patch)
    return found


def domains_of(checkpoints: Archive, step: int, communicator: Communicator) -> tuple[Domain, ...]:
    """The domains that as many ranks had when they wrote a checkpoint; none where there were fewer or more."""
    stored = checkpoints.state(step).get("domains", np.zeros((0, 2, 3), np.int64))
    if communicator.size == 1 or len(stored) != communicator.size:
        return ()
    corners = [tuple(tuple(corner) for corner in pair) for pair in stored.tolist()]
    return tuple(Domain(*pair) for pair in corners)


def _filled(record: type, count: int, arrays: dict[str, Array]) -> Any:
    """A record of arrays: those that were kept, and new ones for what every step makes anew."""
    fresh: Any = new_arrays(record, count)
    return record(**{**fresh._asdict(), **arrays})


def _restore_laws(simulation: Simulation, state: dict[str, Array]) -> None:
    for key, value in state.items():
        what, _, which = key.partition("/")
        if what == "face_force":
            x, y, z = value.tolist()
            simulation.face_forces[which] = (x, y, z)
        elif what == "condition_met_at":
            law: Any = simulation.contact_laws[int(which)]
            law.condition_met_at = float(value)
    loads = getattr(simulation, "loads", None)
    if loads is not None:
        materials = [body.particles for body in simulation.bodies]
        loads.resume(materials, dict(state["load_counts"].tolist()), simulation.exchange.communicator)


class CheckpointOutput(Observer):
    """Writes checkpoints when they are due, and one where somebody stopped the run.

    Attributes
    ----------
    last_step : step of the last checkpoint, or None.
    """

    def __init__(
        self,
        writer: ArchiveWriter,
        schedule: Schedule,
        cycle: int,
        output: TimestepOutput,
        histories: HistoryOutput,
        gathering: Gathering | None = None,
    ) -> None:
        self._gathering = gathering or Gathering()
        self.schedule = schedule
        self.last_step: int | None = None
        self._writer = writer
        self._cycle = cycle
        self._output = output
        self._histories = histories
        self._due = False

    def before_step(self, run: Run, dt: float) -> None:
        """See whether the step is to be kept."""
        simulation = run.simulation
        self._due = self.schedule.due(
            simulation.time + dt, simulation.step_number + 1, run.wall_time, run.is_last
        )

    def after_step(self, run: Run) -> None:
        """Write a checkpoint if one is due."""
        if self._due:
            self._write(run)

    def end(self, run: Run) -> None:
        """Write a checkpoint where the run was stopped before its end."""
        if (
            run.stop_reason
            and not run.failed
            and run.steps_done
            and self.last_step != run.simulation.step_number
        ):
            self._write(run)

    def end_of_step(self) -> float:
        """The next time of a checkpoint; none where the step that just ended is kept, as in Uintah."""
        return float("inf") if self._due else self.schedule.end_of_step()

    def _write(self, run: Run) -> None:
        simulation, mine, outputs = run.simulation, self.schedule, self._output.schedule
        mine.done(simulation.time, simulation.step_number, run.wall_time)
        state = RunState(
            step=simulation.step_number,
            time=simulation.time,
            dt=run.dt,
            next_dt=run.next_dt,
            accumulated=self._histories.accumulated,
            next_output=(outputs.next_time, outputs.next_step),
            next_checkpoint=(mine.next_time, mine.next_step),
        )
        write_checkpoint(self._writer, run, state, self._cycle, self._gathering)
        self.last_step = simulation.step_number
