"""Writing archives.

An archive is written so that it can be read at any moment: a time step is put into a folder of
another name, which gets its own name once it is complete, and only then does ``index.xml``, replaced
as a whole, name the step.

>>> import numpy as np, tempfile
>>> from pathlib import Path
>>> from ups.archive import ArchiveWriter, Box, Grid, Variable
>>> X = Variable("p.x", "ParticleVariable", "Point")
>>> MASS = Variable("g.mass", "NCVariable", "double")
>>> ENERGY = Variable("KineticEnergy", "ReductionVariable", "double")
>>> DELT = Variable("delT", "ReductionVariable", "double")
>>> grid = Grid.single_level(Box((0, 0, 0), (4, 2, 1)).split((2, 1, 1)), spacing=(0.5, 0.5, 0.5))
>>> nodes = grid.levels[0].whole("NCVariable").shape
>>> folder = Path(tempfile.mkdtemp()) / "bar.uda.000"
>>> with ArchiveWriter.create(folder, grid, input_xml="<Uintah_specification/>") as writer:
...     writer.append_reductions(1, 0.1, {ENERGY: {-1: 2.5}})
...     fields = {X: {0: np.full((3, 3), 0.25)}, MASS: {0: np.zeros(nodes)}}
...     writer.write_timestep(1, 0.1, 0.1, fields)
...     writer.write_checkpoint(
...         1, 0.1, 0.1, fields, global_values={DELT: {-1: 0.1}}, state={"order": [2, 0, 1]}
...     )
>>> sorted(path.name for path in folder.iterdir() if path.suffix != ".crc32")
['KineticEnergy.dat', 'checkpoints', 'index.xml', 'input.xml', 't00001']
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

import numpy.typing as npt
from lxml import etree

from ups.archive import checksums, reductions
from ups.archive.errors import ArchiveError
from ups.archive.index import ArchiveIndex, Listed, Restart, Timestep, read_index
from ups.archive.layout import Grid
from ups.archive.naming import point_link
from ups.archive.ranks import ALONE, Ranks, together
from ups.archive.reductions import ReductionFile, ReductionFormat
from ups.archive.tree import Content, Fields, Positions, Tree, storing
from ups.archive.variables import Variable

_RESERVED = re.compile(r"index\.xml|input\.xml|checkpoints|t\d+|.*\.dat|.*\.crc32|.*\.partial")


class ArchiveWriter:
    """Writes an archive; made by `create` or `open_existing`, to be closed or used with ``with``.

    Every method that writes raises `ArchiveError` where the disk is full or may not be written; what
    the archive held before stays readable. Values of a wrong shape or kind raise ValueError.

    Several ranks can write one archive, each the data of the patches that the grid gives it, the first all
    else. Every rank then makes a writer of the same grid with the same ``ranks`` and calls every method,
    with its own share of the values (see `Fields`); histories and global values count on the first only.
    What fails on one rank raises on all.

    Attributes
    ----------
    directory
        The archive.
    reduction_format
        Which steps get a line in the histories, and what a line says before the value.
    """

    def __init__(
        self,
        directory: Path,
        output: Tree,
        checkpoints: Tree,
        *,
        double_as_float: bool,
        reduction_format: ReductionFormat,
    ) -> None:
        self.directory = directory
        self.reduction_format = reduction_format
        self._ranks = output.ranks
        self._output = output
        self._checkpoints = checkpoints
        self._double_as_float = double_as_float
        self._histories: dict[str, ReductionFile] = {}
        self._covered: dict[str, tuple[int, int]] = {}

    @classmethod
    def create(
        cls,
        directory: str | Path,
        grid: Grid,
        *,
        input_xml: str | bytes,
        originals: Mapping[str, bytes] | None = None,
        title: str = "",
        compression: str = "",
        double_as_float: bool = False,
        link: str | Path | None = None,
        reduction_format: ReductionFormat | None = None,
        restarted_from: tuple[str, int] | None = None,
        ranks: Ranks = ALONE,
    ) -> ArchiveWriter:
        """Begin a new archive.

        Parameters
        ----------
        directory
            The archive; it must not exist, or be an empty folder.
        grid
            Grid of the time steps, until `use_grid` gives another.
        input_xml
            The deck as it was understood, includes expanded.
        originals
            Files to keep beside it, such as the deck as it was given, by name.
        title
            Title of the run.
        compression
            ``""`` or ``"gzip"``, for variables that do not say otherwise.
        double_as_float
            Store the double variables of time steps (not of checkpoints) in single precision.
        link
            Where to leave a symbolic link to the archive, or None.
        reduction_format
            How histories are written; the default is every step, with its time.
        restarted_from
            Archive and step that the run goes on from, to be noted.
        ranks
            The ranks that write together, such as ``mpi4py.MPI.COMM_WORLD``; by default, this process alone.
        """
        directory = Path(directory)
        processes = grid.number_of_processes
        index, checkpoint_index = ArchiveIndex.new(processes, title), ArchiveIndex.new(processes, title)
        if restarted_from is not None:
            index.restarts.append(Restart(*restarted_from))
        writer = cls(
            directory,
            Tree(directory, index, grid, compression, ranks),
            Tree(directory / "checkpoints", checkpoint_index, grid, compression, ranks),
            double_as_float=double_as_float,
            reduction_format=reduction_format or ReductionFormat(),
        )
        with together(ranks, directory):
            if ranks.rank == 0:
                _create_folder(directory, input_xml, originals or {})
                writer._output.save_index()
                if link is not None:
                    point_link(Path(link), directory)
        return writer

    @classmethod
    def open_existing(
        cls,
        directory: str | Path,
        grid: Grid,
        *,
        step: int,
        time: float,
        compression: str = "",
        double_as_float: bool = False,
        reduction_format: ReductionFormat | None = None,
        ranks: Ranks = ALONE,
    ) -> ArchiveWriter:
        """Go on with an archive from a step that it has reached, usually that of a checkpoint.

        What the archive holds of later steps is removed: time steps, checkpoints and lines of the
        histories. Time steps of other grids stay as they are.

        Parameters
        ----------
        directory
            The archive.
        grid
            Grid of the time steps to come.
        step, time
            The step that the run goes on from, and the time at its end.
        compression, double_as_float, reduction_format, ranks
            As for `create`.
        """
        directory = Path(directory)
        checkpoints = directory / "checkpoints"
        with together(ranks, directory):  # all read before the first changes anything
            index = read_index(directory / "index.xml")
            exists = (checkpoints / "index.xml").exists()
            checkpoint_index = read_index(checkpoints / "index.xml") if exists else ArchiveIndex.new(1)
        index.restarts.append(Restart(directory.resolve().name, step))
        writer = cls(
            directory,
            Tree(directory, index, grid, compression, ranks),
            Tree(checkpoints, checkpoint_index, grid, compression, ranks),
            double_as_float=double_as_float,
            reduction_format=reduction_format or ReductionFormat(),
        )
        writer._output.drop_after(step)
        if exists:
            writer._checkpoints.drop_after(step)
        with together(ranks, directory):
            if ranks.rank == 0:
                writer._cut_histories(step, time)
        return writer

    def use_grid(self, grid: Grid) -> None:
        """Store the time steps to come on another grid, as when ranks share out its patches anew."""
        for tree in (self._output, self._checkpoints):
            tree.grid = grid

    def write_timestep(
        self,
        step: int,
        time: float,
        old_delt: float,
        fields: Fields | Sequence[Fields],
        *,
        positions: Positions | Sequence[Positions] | None = None,
        sections: Sequence[etree._Element] = (),
    ) -> None:
        """Store a time step and bring the histories on the disk up to date.

        Parameters
        ----------
        step
            Number of the step.
        time
            Time at its end.
        old_delt
            Its size.
        fields
            What to store, for the only level or for each.
        positions
            Positions that decide which patch holds a particle; by default those in `fields` under the
            label ``p.x``. Particles beyond the edge of the level go to the nearest patch.
        sections
            XML elements of components to keep in ``timestep.xml``.
        """
        levels, places = _by_level(fields), None if positions is None else _by_level(positions)
        if self._double_as_float:
            levels = [{_as_float(variable): values for variable, values in level.items()} for level in levels]
        self._flush_together()
        self._output.write(Timestep(step, time, old_delt, ""), Content(levels, places, sections))

    def write_checkpoint(
        self,
        step: int,
        time: float,
        old_delt: float,
        fields: Fields | Sequence[Fields],
        *,
        positions: Positions | Sequence[Positions] | None = None,
        global_values: Fields | None = None,
        state: Mapping[str, npt.ArrayLike] | None = None,
        sections: Sequence[etree._Element] = (),
        cycle: int = 0,
    ) -> None:
        """Store a checkpoint, in full precision, and remove the oldest beyond `cycle`.

        Parameters
        ----------
        step, time, old_delt, fields, positions, sections
            As for `write_timestep`; variables are stored in alphabetical order, as Uintah does.
        global_values
            Values that belong to no patch, by variable and material (-1 for none), such as ``delT``.
        state
            Anything else that a restart needs, as arrays by name; other programs do not see it. Each rank
            gets its own back from `Archive.state`.
        cycle
            How many checkpoints to keep; 0 keeps all.
        """
        levels = [
            {variable: level[variable] for variable in sorted(level, key=lambda v: v.name)}
            for level in _by_level(fields)
        ]
        places = None if positions is None else _by_level(positions)
        content = Content(levels, places, sections, global_values or {}, state)
        self._flush_together()
        tree = self._checkpoints
        with (
            together(self._ranks, tree.directory),
            storing(tree.directory, "create the folder of checkpoints"),
        ):
            if tree.is_first:
                tree.directory.mkdir(exist_ok=True)
        tree.write(Timestep(step, time, old_delt, ""), content)
        if 0 < cycle < len(tree.index.timesteps):
            with together(self._ranks, tree.directory), storing(tree.directory, "copy the table of contents"):
                if tree.is_first:
                    shutil.copyfile(tree.directory / "index.xml", tree.directory / "index_backup.xml")
            tree.keep(tree.index.timesteps[-cycle:])

    def append_reductions(
        self,
        step: int,
        time: float,
        values: Mapping[Variable, Mapping[int, npt.ArrayLike]],
        *,
        last: bool = False,
    ) -> None:
        """Add a line to the history of each variable, where `reduction_format` wants the step; on the first rank.

        Lines reach the disk with the next time step, checkpoint, `flush` or `close`.

        Parameters
        ----------
        step, time
            Number of the step and the time at its end.
        values
            One value by variable and material, -1 for a value that belongs to none.
        last
            Whether the run ends with this step, which always gets a line.
        """
        if self._ranks.rank or not self.reduction_format.due(step, last):
            return
        prefix = self.reduction_format.prefix(step, time)
        listed = len(self._output.index.globals_)
        for variable, by_material in values.items():
            for material, value in by_material.items():
                name = reductions.filename(variable.name, material)
                history = self._histories.get(name) or self._open_history(variable, name)
                history.append(prefix + reductions.value_text(variable, value))
        if len(self._output.index.globals_) > listed:
            self._output.save_index()

    def _cut_histories(self, step: int, time: float) -> None:
        """Remove the lines of the histories that are later than a step."""
        for listed in self._output.index.globals_:
            path = self.directory / Path(listed.href).name
            if listed.href and path.exists():
                reductions.cut_history(path, self.reduction_format, step, time)
                self._covered[path.name] = reductions.covered_by(path)
        self._save_sums()

    def _save_sums(self) -> None:
        """Write the checksums of the histories, where there are any."""
        self._covered |= {name: history.covered for name, history in self._histories.items()}
        if self._covered:
            with storing(self.directory, "write the checksums of the histories"):
                checksums.save_histories(self.directory, self._covered)

    def _open_history(self, variable: Variable, name: str) -> ReductionFile:
        history = self._histories[name] = ReductionFile(self.directory / name)
        listed = Listed(variable.name, variable.type_name, href=name)
        if listed not in self._output.index.globals_:
            self._output.index.globals_.append(listed)
        return history

    def _flush_together(self) -> None:
        with together(self._ranks, self.directory):
            self.flush()

    def flush(self) -> None:
        """Bring the histories on the disk up to date; no rank waits for another."""
        for history in self._histories.values():
            history.flush()
        if self._histories:
            self._save_sums()

    def close(self) -> None:
        """Bring the histories up to date and close their files; the archive is complete before, too."""
        failures = []
        for history in self._histories.values():
            try:
                history.close()
            except ArchiveError as error:
                failures.append(error)
        if self._histories and not failures:
            self._save_sums()
        self._histories.clear()
        if failures:
            raise failures[0]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _create_folder(directory: Path, input_xml: str | bytes, originals: Mapping[str, bytes]) -> None:
    """Make the folder of an archive, with the deck in it."""
    with storing(directory, "create the archive"):
        if not directory.is_dir() or any(directory.iterdir()):
            directory.mkdir(parents=True)
        text = input_xml.encode() if isinstance(input_xml, str) else input_xml
        (directory / "input.xml").write_bytes(text)
        for name, content in originals.items():
            plain = Path(name).name
            (directory / (f"{plain}.orig" if _RESERVED.fullmatch(plain) else plain)).write_bytes(content)


_M = TypeVar("_M", bound=Mapping[Any, Any])


def _by_level(given: _M | Sequence[_M]) -> list[_M]:
    """Return what is given for each level, where the only level's may stand alone."""
    return [given] if isinstance(given, Mapping) else list(given)


def _as_float(variable: Variable) -> Variable:
    """Declare a double variable on particles or the grid as one of single precision."""
    inside = variable.is_particle or variable.is_grid
    return replace(variable, element="float") if inside and variable.element == "double" else variable
