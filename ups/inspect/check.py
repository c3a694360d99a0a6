"""Finding out whether an archive is whole, and making one readable that a crash cut off."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ups.archive import Archive, ArchiveError, Timestep, checksums
from ups.archive.index import ArchiveIndex, Listed, read_index
from ups.archive.markup import Node
from ups.archive.reductions import ReductionFormat, covered_by, cut_history, read_history
from ups.archive.stored import StoredTimestep
from ups.archive.table import Entry, read_table
from ups.archive.tree import replace_index
from ups.archive.variables import GLOBAL_MATERIAL

_FOLDER = re.compile(r"t(\d{5,})")
_HISTORY_TYPES = {1: "double", 3: "Vector", 9: "Matrix3"}
_KEPT = "index.xml.damaged"


@dataclass
class Health:
    """What was found in an archive and its checkpoints.

    Attributes
    ----------
    problems
        What is wrong, in the order found.
    whole, damaged
        Numbers of the time steps, those of checkpoints not counted.
    """

    problems: list[ArchiveError] = field(default_factory=list)
    whole: list[int] = field(default_factory=list)
    damaged: list[int] = field(default_factory=list)

    @property
    def is_sound(self) -> bool:
        """Whether nothing is wrong."""
        return not self.problems


def check_archive(
    path: str | Path, *, values: bool = True, progress: Callable[[int, int], None] | None = None
) -> Health:
    """Look for what is missing, cut off or damaged in an archive.

    Parameters
    ----------
    path
        The archive.
    values
        Whether to read every block; else only tables and sizes of files are compared.
    progress
        Called after each time step with the number done and the number of all.

    Raises
    ------
    ArchiveError
        Where there is no archive.
    """
    folder = _folder_of(path)
    health = Health()
    try:
        archive = Archive(folder)
    except ArchiveError as error:
        health.problems.append(error)
        return health
    for done, timestep in enumerate(archive.timesteps, 1):
        found = archive.problems(timestep.step, values=values)
        (health.damaged if found else health.whole).append(timestep.step)
        health.problems += found
        if progress is not None:
            progress(done, len(archive.timesteps))
    unlisted = [path for path in _unlisted(folder, archive.index) if not _step_problems(path, archive.index)]
    health.problems += [
        ArchiveError(path, "a whole time step that index.xml does not list", advice="list it with --repair")
        for path in unlisted
    ]
    health.problems += _history_problems(folder, archive.index)
    if (folder / "checkpoints").is_dir():
        health.problems += check_archive(folder / "checkpoints", values=values).problems
    return health


def repair_archive(path: str | Path) -> list[str]:
    """Make an archive that was cut off readable up to its last whole step.

    ``index.xml`` is rewritten to list the time steps that are whole, and made anew where it cannot be
    read; the old one stays as ``index.xml.damaged``. Unfinished files and lines are removed; histories that are
    not as their checksums say are kept as they are, and told. Folders of damaged time steps stay where they
    are, unlisted. Checkpoints are treated likewise.

    Returns
    -------
    list[str]
        What was done, a sentence each; nothing where the archive was whole.

    Raises
    ------
    ArchiveError
        Where there is no archive, no time step can be saved, or the disk may not be written.
    """
    folder = _folder_of(path)
    try:
        done = _repair_tree(folder)
        if (folder / "checkpoints").is_dir():
            done += _repair_tree(folder / "checkpoints", optional=True)
    except OSError as error:
        raise ArchiveError.from_os_error(folder, "repair the archive", error) from error
    return done


def _folder_of(path: str | Path) -> Path:
    folder = Path(path).parent if Path(path).name == "index.xml" else Path(path)
    stored = folder.is_dir() and any(_FOLDER.fullmatch(child.name) for child in folder.iterdir())
    if not stored and not (folder / "index.xml").is_file():
        raise ArchiveError(folder, "not an archive: there is no index.xml", advice="check the path")
    return folder


def _unlisted(folder: Path, index: ArchiveIndex) -> list[Path]:
    """Folders of time steps later than the last that the table of contents lists, ascending."""
    last = max((timestep.step for timestep in index.timesteps), default=-1)
    steps = [child for child in folder.iterdir() if _FOLDER.fullmatch(child.name)]
    return sorted((child for child in steps if int(child.name[1:]) > last), key=lambda child: child.name)


def _timestep_of(folder: Path) -> Timestep:
    """Time step that a folder holds, as its own ``timestep.xml`` says."""
    node = Node.root(folder / "timestep.xml", "Uintah_timestep").need("Time")
    old_delt = node.child("oldDelt")
    return Timestep(
        node.need("timestepNumber").integer(),
        node.need("currentTime").real(),
        0.0 if old_delt is None else old_delt.real(),
        f"{folder.name}/timestep.xml",
    )


def _step_problems(folder: Path, index: ArchiveIndex) -> list[ArchiveError]:
    try:
        timestep = _timestep_of(folder)
    except ArchiveError as error:
        return [error]
    return list(StoredTimestep(folder / "timestep.xml", index, timestep).problems(values=True))


def _history_problems(folder: Path, index: ArchiveIndex) -> list[ArchiveError]:
    found = []
    for listed in index.globals_:
        path = folder / listed.href
        if not listed.href:
            continue
        try:
            history = read_history(path, listed.name, GLOBAL_MATERIAL)
        except ArchiveError as error:
            found.append(error)
            continue
        if index.timesteps and _ends_early(history.times, index.timesteps[-1].time):
            message = f"the history ends at time {history.times[-1]:.9g}, before the last time step"
            found.append(ArchiveError(path, message, advice="what is missing is lost"))
        if _has_loose_end(path):
            found.append(ArchiveError(path, "the last line is unfinished", advice="cut it with --repair"))
    return found


def _ends_early(times: np.ndarray, last: float) -> bool:
    """Whether a history ends more than two of its longest intervals before a time."""
    return len(times) > 1 and bool(times[-1] + 2.0 * np.diff(times).max() < last)


def _has_loose_end(path: Path) -> bool:
    with path.open("rb") as file:
        length = file.seek(0, 2)
        file.seek(max(0, length - 1))
        return length > 0 and file.read(1) != b"\n"


def _repair_tree(folder: Path, *, optional: bool = False) -> list[str]:
    """Repair a directory of time steps and its table of contents; an optional one may stay without steps."""
    done = [f"removed the unfinished {path.name}" for path in sorted(folder.glob("*.partial"))]
    for path in folder.glob("*.partial"):
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    try:
        index = read_index(folder / "index.xml")
        rebuilt = False
    except ArchiveError as error:
        index, rebuilt = _index_from_folders(folder), True
        done.append(f"made index.xml anew, as {error.message}")
    whole = []
    for timestep in index.timesteps:
        problems = list(StoredTimestep(folder / timestep.href, index, timestep).problems(values=True))
        if problems:
            done.append(f"took step {timestep.step} off the list: {problems[0].message}")
        else:
            whole.append(timestep)
    for path in _unlisted(folder, index):
        if not rebuilt and not _step_problems(path, index):
            whole.append(_timestep_of(path))
            done.append(f"listed step {whole[-1].step}, which was whole but not listed")
    if not whole and index.timesteps and not optional:
        raise ArchiveError(folder, "no time step is whole", advice="run the deck again")
    if rebuilt or whole != index.timesteps:
        index.timesteps = whole
        _replace_index(folder, index)
    for path in sorted(folder.glob("*.dat")):
        if _has_loose_end(path):
            cut_history(path, ReductionFormat(time_column=False), 0, 0.0)
            done.append(f"cut the unfinished last line of {path.name}")
    return done + _accept_histories(folder)


def _accept_histories(folder: Path) -> list[str]:
    """Write the checksums of the histories anew where one is not as they say."""
    if not (folder / checksums.HISTORIES).exists():
        return []
    done, covered = [], {}
    for path in sorted(folder.glob("*.dat")):
        covered[path.name] = covered_by(path)
        try:
            checksums.check_history(path, path.read_bytes(), checksums.of_history(path))
        except ArchiveError as error:
            done.append(f"kept {path.name} as it is: {error.message}")
    if done:
        checksums.save_histories(folder, covered)
    return done


def _replace_index(folder: Path, index: ArchiveIndex) -> None:
    current = folder / "index.xml"
    if current.exists():
        shutil.copyfile(current, folder / _KEPT)
    replace_index(current, index)


def _index_from_folders(folder: Path) -> ArchiveIndex:
    """Table of contents as the folders of the time steps and the histories tell it."""
    index = ArchiveIndex.new(1)
    variables: dict[str, dict[str, set[int]]] = {}
    for path in sorted(folder.iterdir()):
        if not _FOLDER.fullmatch(path.name):
            continue
        try:
            index.timesteps.append(_timestep_of(path))
            entries = [entry for table in sorted(path.glob("l*/p*.xml")) for entry in read_table(table)]
        except ArchiveError:
            continue  # what cannot be read of a step is found again, and said, when the steps are checked
        for entry in entries:
            variables.setdefault(entry.name, {}).setdefault(entry.type_name, set()).add(entry.material)
        ranks = {int(table.stem[1:]) for table in path.glob("l*/p*.xml")}
        index.processes = max(index.processes, 1 + max(ranks, default=0))
    if not index.timesteps:
        raise ArchiveError(folder, "no time step is whole", advice="run the deck again")
    index.variables = [
        Listed(name, type_name, len(materials))
        for name, types in variables.items()
        for type_name, materials in list(types.items())[:1]
    ]
    index.globals_ = _histories(folder) or _globals_of(folder, index)
    return index


def _histories(folder: Path) -> list[Listed]:
    """Histories by their files, with the type that the count of their numbers tells."""
    found = []
    for path in sorted(folder.glob("*.dat")):
        name = re.sub(r"_\d+$", "", path.stem)
        try:
            values = read_history(path, name, GLOBAL_MATERIAL).values
        except ArchiveError:
            continue  # not a history
        element = _HISTORY_TYPES.get(values.shape[1] if values.ndim == 2 else 1)
        if element is not None:
            found.append(Listed(name, f"ReductionVariable<{element}>", href=path.name))
    return found


def _globals_of(folder: Path, index: ArchiveIndex) -> list[Listed]:
    """Global values of checkpoints, as the last table of them that can be read lists them."""
    for timestep in reversed(index.timesteps):
        path = (folder / timestep.href).with_name("global.xml")
        try:
            entries: list[Entry] = read_table(path) if path.exists() else []
        except ArchiveError:
            continue  # an earlier one will do
        return [Listed(entry.name, entry.type_name, 1) for entry in entries]
    return []
