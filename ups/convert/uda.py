"""A Uintah archive again: some of the time steps, variables and materials of one, or those of several runs.

Blocks that are copied stay as they are, byte by byte; a measure becomes a variable (``p.stress_vonMises``).
Positions and identities go with any particle variable. Histories and the deck are copied, checkpoints are not.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from ups.archive import Archive, ArchiveError, ArchiveWriter, Fields, ReductionFormat, Variable
from ups.archive.tracks import IDENTITY
from ups.archive.variables import PER_PATCH
from ups.convert.registry import Format, Options, register
from ups.convert.selection import Selection


def write(selection: Selection, out: Path, options: Options) -> list[Path]:
    """Write the selection as a new archive."""
    archive = selection.archive
    if selection.region is not None:
        raise ArchiveError(out, "a region cannot be cut out of an archive", advice="leave it out")
    if not selection.timesteps:
        raise ArchiveError(archive.path, "there are no time steps")
    deck = archive.path / "input.xml"
    writer = ArchiveWriter.create(
        out,
        archive.grid(selection.timesteps[0].step),
        input_xml=deck.read_bytes() if deck.is_file() else "<Uintah_specification/>",
        title=archive.index.title,
        reduction_format=_history_format(archive),
    )
    with writer:
        _copy_histories(archive, writer)
        for done, timestep in enumerate(selection.timesteps, 1):
            step = timestep.step
            grid = archive.grid(step)
            fields = [_fields(selection, step, level.index) for level in grid.levels]
            writer.use_grid(grid)
            sections = archive.sections(step)
            writer.write_timestep(step, timestep.time, timestep.old_delt, fields, sections=sections)
            options.progress(done, len(selection.timesteps))
    return [out]


def _fields(selection: Selection, step: int, level: int) -> Fields:
    """Selected variables of a level, in the order of the archive; measures behind them."""
    archive = selection.archive
    stored = archive.fields(step, level)
    wanted = {variable.name for variable in selection.variables}
    if selection.has_particles:
        wanted |= {archive.index.particle_position, IDENTITY} & archive.variables.keys()
    everything = {v.name for v in archive.variables.values() if v.is_particle or v.is_grid} <= wanted
    kept = {
        variable: _of_materials(selection, by_material)
        for variable, by_material in stored.items()
        if variable.name in wanted or (everything and variable.container == PER_PATCH)
    }
    by_name = {variable.name: values for variable, values in stored.items()}
    for name in wanted - archive.variables.keys():
        named = archive.find(name)
        if named.measure is not None and named.source.name in by_name:
            measured = _of_materials(selection, by_name[named.source.name])
            variable = replace(named.declaration, name=name.replace(":", "_"))
            kept[variable] = {m: named.measure.function(values) for m, values in measured.items()}
    return {variable: by_material for variable, by_material in kept.items() if by_material}


def _of_materials(selection: Selection, by_material: Mapping[int, np.ndarray]) -> dict[int, np.ndarray]:
    chosen = selection.materials
    return {m: values for m, values in by_material.items() if chosen is None or m in chosen}


def _history_format(archive: Archive) -> ReductionFormat:
    """Columns of the histories, as the first of them has."""
    for history in archive.reductions.values():
        if len(history.values):
            return ReductionFormat(
                step_column=history.steps is not None, time_column=not np.isnan(history.times).any()
            )
    return ReductionFormat()


def _copy_histories(archive: Archive, writer: ArchiveWriter) -> None:
    types = {listed.name: listed.type_name for listed in archive.index.globals_}
    for history in archive.reductions.values():
        variable = Variable.from_type(history.name, types[history.name])
        steps = np.zeros(len(history.times), dtype=int) if history.steps is None else history.steps
        for step, time, value in zip(steps.tolist(), history.times.tolist(), history.values, strict=True):
            writer.append_reductions(step, time, {variable: {history.material: value}})


register(Format("UDA", (".uda",), write, makes_folder=True))
