"""From a deck to an archive: what ``ups run`` does, as two calls."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from solver.domains.communicator import Alone, Communicator
from solver.domains.decomposition import Domain
from ups.archive import Archive, ArchiveError, ArchiveWriter, next_numbered_directory
from ups.deck import Deck, Specification, read_deck
from ups.diagnostics import DeckError, Diagnostics
from ups.gathering import Gathering
from ups.output import (
    HistoryOutput,
    Plan,
    TimestepOutput,
    plan_output,
    reduction_format,
)
from ups.patches import grid_of
from ups.restart import CheckpointOutput, RunState, domains_of, restore
from ups.result import Result
from ups.run import Observer, Run, StepError
from ups.schedule import Schedule

if TYPE_CHECKING:
    from solver.simulation import Simulation

Answer = TypeVar("Answer")
Checked = Callable[[Deck], None]


def run_deck(
    deck: Deck,
    *,
    output: str | os.PathLike[str] | None = None,
    max_steps: int | None = None,
    threads: int | None = None,
    ranks_a_file: int = 1,
    observers: Iterable[Observer] = (),
    checked: Checked | None = None,
    communicator: Communicator | None = None,
) -> Result:
    """Run a deck and write its archive.

    Parameters
    ----------
    deck : as ``read_deck`` returns it.
    output : the archive, which must not exist or be an empty folder; by default ``<filebase>`` numbered as
        Uintah does, ``name.000``, with a link ``name`` to the newest.
    max_steps : the number of the step after which to stop, or None for what the deck says.
    threads : how many threads share the work, by default one for each core (that no other
        rank uses); results do not depend on it.
    ranks_a_file : how many ranks put their data into one file of a time step.
    observers : who else watches the run (see ``ups.run.Observer``).
    checked : called once the deck is known to be good, before anything is written.
    communicator : the ranks that share the run, each of which has to call this; by default there is one.

    Raises
    ------
    DeckError
        where the deck or its data is at fault, the archive cannot be written, or the run fails; what was
        written until then stays readable.
    """
    specification, plan = _plan(deck)
    ranks = communicator or Alone()
    with _problems(deck):
        directory, link = _on_first(ranks, lambda: _place(specification, output))
        simulation = _build(deck, threads, ranks)
        simulation.balance()
        if checked is not None:
            checked(deck)
        section = specification.DataArchiver
        writer = ArchiveWriter.create(
            directory,
            grid_of(simulation, ranks_a_file),
            input_xml=deck.document.to_xml(),
            originals=_originals(deck),
            title=specification.Meta.title,
            compression=section.compression.replace("none", ""),
            double_as_float=section.outputDoubleAsFloat,
            link=link,
            reduction_format=reduction_format(section),
            ranks=ranks,
        )
        return _go(deck, writer, plan, simulation, None, max_steps, observers, Gathering(ranks_a_file))


def resume_run(
    archive: str | os.PathLike[str],
    *,
    step: int | None = None,
    output: str | os.PathLike[str] | None = None,
    max_steps: int | None = None,
    threads: int | None = None,
    ranks_a_file: int = 1,
    overrides: Sequence[tuple[str, str]] = (),
    observers: Iterable[Observer] = (),
    checked: Checked | None = None,
    communicator: Communicator | None = None,
) -> Result:
    """Go on with the run of an archive from one of its checkpoints.

    Parameters
    ----------
    archive : the archive; its ``input.xml`` is the deck.
    step : the step of the checkpoint, by default the last.
    output : a new archive; by default the old one is continued, and what it holds of later steps is removed.
    max_steps, threads, ranks_a_file, observers, checked, communicator : as for :func:`run_deck`; steps count from
        the start of the first run.
    overrides : (path of tags, new text) pairs, as for ``read_deck``.

    Raises
    ------
    DeckError
        as :func:`run_deck`, and where the archive has no such checkpoint.
    """
    with _problems(None):
        source = Archive(Path(archive).resolve())
        checkpoints, found = _checkpoint(source, step)
    deck = read_deck(source.path / "input.xml", overrides=overrides)
    specification, plan = _plan(deck)
    ranks = communicator or Alone()
    with _problems(deck):
        directory = _on_first(
            ranks, lambda: source.path if output is None else _place(specification, output)[0]
        )
        domains = domains_of(checkpoints, found, ranks)
        simulation = _build(deck, threads, ranks, domains)
        with _problems(None):
            state = restore(simulation, checkpoints, found)
        if not domains:
            simulation.balance()
        if checked is not None:
            checked(deck)
        section = specification.DataArchiver
        options: dict[str, Any] = {
            "compression": section.compression.replace("none", ""),
            "double_as_float": section.outputDoubleAsFloat,
            "reduction_format": reduction_format(section),
            "ranks": ranks,
        }
        grid = grid_of(simulation, ranks_a_file)
        if output is None:
            if overrides and ranks.rank == 0:
                _replace_deck(directory, deck)
            writer = ArchiveWriter.open_existing(directory, grid, step=state.step, time=state.time, **options)
        else:
            writer = ArchiveWriter.create(
                directory,
                grid,
                input_xml=deck.document.to_xml(),
                originals=_kept_originals(source),
                title=specification.Meta.title,
                restarted_from=(source.path.name, state.step),
                **options,
            )
        return _go(deck, writer, plan, simulation, state, max_steps, observers, Gathering(ranks_a_file))


def _plan(deck: Deck) -> tuple[Specification, Plan]:
    """The values of a deck that can be run, and what it saves."""
    specification = deck.require()
    plan = plan_output(specification, deck.reader.place, deck.diagnostics)
    return deck.require(), plan


def _build(
    deck: Deck, threads: int | None, ranks: Communicator, domains: Sequence[Domain] = ()
) -> Simulation:
    from solver.team import Team, available_cores
    from ups.factory import build

    simulation: Simulation = build(deck, ranks, domains)
    simulation.team = Team(threads or max(1, available_cores() // ranks.sharing_cores))
    simulation.compile_ahead(simulation.team.threads - 1)
    return simulation


def _on_first(ranks: Communicator, action: Callable[[], Answer]) -> Answer:
    """What an action gives on the first rank, on all of them; what it raises, all raise."""
    answer: tuple[Answer | None, tuple[Path, str, str] | None] = (None, None)
    if ranks.rank == 0:
        try:
            answer = (action(), None)
        except ArchiveError as problem:
            answer = (None, (problem.path, problem.message, problem.advice))
    given, failure = ranks.from_root(answer)
    if failure is not None:
        path, message, advice = failure
        raise ArchiveError(path, message, advice=advice)
    return given  # type: ignore[return-value]  # None only if that is what the action gives


def _go(
    deck: Deck,
    writer: ArchiveWriter,
    plan: Plan,
    simulation: Simulation,
    state: RunState | None,
    max_steps: int | None,
    watchers: Iterable[Observer],
    gathering: Gathering,
) -> Result:
    """Put the run together, start it, and say how it ended."""
    specification = deck.require()
    section, control = specification.DataArchiver, specification.Time
    if max_steps is not None:
        limit = min(max_steps, control.max_Timesteps) if control.max_Timesteps else max_steps
        control = replace(control, max_Timesteps=limit)
    output = TimestepOutput(
        writer,
        plan,
        Schedule.of_output(section),
        at_start=section.outputInitTimestep,
        gathering=gathering,
    )
    histories = HistoryOutput(writer, plan, at_start=section.outputInitTimestep)
    cycle = section.checkpoint.cycle if section.checkpoint else 0
    checkpoints = CheckpointOutput(
        writer, Schedule.of_checkpoints(section.checkpoint), cycle, output, histories, gathering
    )
    communicator = simulation.exchange.communicator
    observers: Sequence[Observer] = (output, histories, checkpoints, *watchers)
    run = Run(
        simulation,
        control,
        observers,
        title=specification.Meta.title,
        materials=_material_names(deck),
        directory=writer.directory,
        particles=sum(communicator.allgather(sum(len(body.particles) for body in simulation.bodies))),
    )
    if state is not None:
        run.dt, run.next_dt = state.dt, control.override_restart_delt or state.next_dt
        histories.accumulated = state.accumulated
        output.schedule.next_time, output.schedule.next_step = state.next_output
        checkpoints.schedule.next_time, checkpoints.schedule.next_step = state.next_checkpoint
    from solver.simulation import DivergedError

    try:
        with writer:
            run.go()
    except DivergedError as problem:
        advice = "try a smaller factor, and look at the last stored step there"
        raise _failed(deck, "UPS602", str(problem), advice, "timestep_multiplier") from problem
    return Result(writer.directory, simulation.step_number, simulation.time, run.wall_time, run.stop_reason)


def _material_names(deck: Deck) -> list[str]:
    """The constitutive model of each material, after the material's name where it has one."""
    names = []
    for section in deck.require().materials:
        element = deck.reader.place(section.constitutive_model)
        kind = element.attributes.get("type") if element is not None else None
        model = kind.value if kind is not None else type(section.constitutive_model).__name__
        names.append(f"{section.name}: {model}" if section.name else model)
    return names


def _place(specification: Specification, output: str | os.PathLike[str] | None) -> tuple[Path, Path | None]:
    """Where the archive goes, and the link to it.

    Raises
    ------
    ArchiveError
        where something is there already.
    """
    if output is None:
        filebase = Path(specification.DataArchiver.filebase)
        return next_numbered_directory(filebase), filebase
    directory = Path(output)
    empty = directory.is_dir() and not any(directory.iterdir())
    if os.path.lexists(directory) and not empty:
        raise ArchiveError(
            directory, "exists already; nothing was overwritten", advice="choose another name or remove it"
        )
    return directory, None


def _checkpoint(archive: Archive, step: int | None) -> tuple[Archive, int]:
    checkpoints = archive.checkpoints
    if checkpoints is None or not checkpoints.timesteps:
        raise ArchiveError(
            archive.path,
            "has no checkpoint to go on from",
            advice='run the deck with <checkpoint timestepInterval="..."/> in <DataArchiver>',
        )
    return checkpoints, checkpoints.timestep(-1 if step is None else step).step


def _replace_deck(directory: Path, deck: Deck) -> None:
    """Put the deck as it is now in the place of an archive's ``input.xml``."""
    partial = directory / "input.xml.partial"
    try:
        partial.write_text(deck.document.to_xml(), encoding="utf-8")
        partial.replace(directory / "input.xml")
    except OSError as problem:
        raise ArchiveError.from_os_error(
            directory / "input.xml", "keep the changed deck", problem
        ) from problem


def _originals(deck: Deck) -> dict[str, bytes]:
    """The deck as it was given, under its own name and under that which Uintah gives it."""
    try:
        raw = deck.path.read_bytes()
    except OSError:  # it was given as text
        raw = deck.document.files[0].text.encode()
    return {deck.path.name: raw, "input.xml.orig": raw}


def _kept_originals(archive: Archive) -> dict[str, bytes]:
    """The deck as it was first given, where an archive still has it."""
    original = archive.path / "input.xml.orig"
    return {original.name: original.read_bytes()} if original.is_file() else {}


@contextmanager
def _problems(deck: Deck | None) -> Iterator[None]:
    """Turn what goes wrong in a run into diagnostics, at the place of the deck that may cure it."""
    try:
        yield
    except ArchiveError as problem:
        code = "UPS603" if deck is None else "UPS604"
        raise _failed(deck, code, f"{problem.path}: {problem.message}", problem.advice) from problem
    except StepError as problem:
        advice = "see what moves so fast: a load, a contact or a velocity of the deck"
        raise _failed(deck, "UPS601", str(problem), advice, "delt_min") from problem
    except MemoryError as problem:
        message = f"not enough memory: {problem or 'the arrays do not fit'}"
        raise _failed(deck, "UPS601", message, "use fewer particles or larger cells") from problem


def _failed(deck: Deck | None, code: str, message: str, advice: str, tag: str = "") -> DeckError:
    """The error to raise, marking a tag of ``<Time>`` where one is named."""
    if deck is None:
        diagnostics = Diagnostics()
        diagnostics.error(code, message, None, advice or None)
        return DeckError(diagnostics)
    time = deck.reader.place(deck.require().Time) if tag else None
    deck.diagnostics.error(code, message, time and (time.get(tag) or time), advice or None)
    return DeckError(deck.diagnostics, deck.sources)
