"""VTKHDF for ParaView: all time steps in one file, particles with one part a material, grids as images.

``x.vtkhdf`` holds the particles; each level of the grid goes to ``x_grid.vtkhdf``, ``x_grid_l1.vtkhdf`` and so
on. Files grow step by step, so that one step is in memory at a time. The layout is that of the VTK File
Formats document, section "VTKHDF file format", version 2.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from ups.archive import ArchiveError, Level
from ups.archive.variables import NODE
from ups.convert.registry import Format, Options, atomically, register
from ups.convert.selection import ParticleSet, Selection, plain_title
from ups.convert.vtkpieces import HIDDEN, hidden_cells, interior_values

_CHUNK = 1 << 16
_CELL_KINDS = ("Vertices", "Lines", "Polygons", "Strips")


def _h5py(out: Path) -> Any:
    try:
        import h5py
    except ImportError:
        advice = "pip install 'ups-mpm[archive]', or write a .pvd"
        raise ArchiveError(out, "VTKHDF needs h5py, which is not installed", advice=advice) from None
    return h5py


class _Growing:
    """Arrays of a group that grow along their first axis."""

    def __init__(self, group: Any) -> None:
        self._group = group

    def add_parts(self, name: str, parts: Iterable[np.ndarray], empty: np.ndarray) -> int:
        """Append rows part by part, made like `empty` where there are none; return how many it had before."""
        before = self.add(name, empty)
        for part in parts:
            self.add(name, part)
        return before

    def add(self, name: str, values: np.ndarray) -> int:
        """Append rows to an array; return how many it had before."""
        if name not in self._group:
            row = max(1, int(np.prod(values.shape[1:])))
            self._group.create_dataset(
                name,
                shape=(0, *values.shape[1:]),
                maxshape=(None, *values.shape[1:]),
                dtype=values.dtype,
                chunks=(max(1, _CHUNK // row), *values.shape[1:]),
                compression="gzip",
                compression_opts=1,
            )
        dataset = self._group[name]
        before = int(dataset.shape[0])
        dataset.resize(before + len(values), axis=0)
        dataset[before:] = values
        return before


class _Particles:
    """The file of the particles."""

    def __init__(self, file: Any) -> None:
        self._root = _root(file, "PolyData")
        for kind in _CELL_KINDS:
            self._root.create_group(kind)
        self._root.create_group("PointData")
        self._steps = _steps_group(self._root)
        self._steps.create_group("PointDataOffsets")
        self._parts = 0

    def add(self, particles: ParticleSet, time: float) -> None:
        """Append a time step."""
        steps, root = _Growing(self._steps), _Growing(self._root)
        counts = np.array(particles.counts, dtype=np.int64)
        steps.add("Values", np.array([time]))
        steps.add("PartOffsets", np.array([self._parts]))
        steps.add("NumberOfParts", np.array([len(counts)]))
        self._parts += len(counts)
        root.add("NumberOfPoints", counts)
        first = root.add_parts("Points", particles.position_parts(), np.empty((0, 3)))
        steps.add("PointOffsets", np.array([first]))
        self._add_cells(steps, counts)
        self._add_data("material", particles.material_parts(), np.empty(0, np.int32))
        for variable in particles.variables:
            element = variable.element_type
            width = (element.components,) if element.shape else ()
            empty = np.empty((0, *width), element.dtype.newbyteorder("="))
            rows = (part.reshape(-1, *width) for part in particles.value_parts(variable))
            self._add_data(plain_title(variable.name), rows, empty)
        self._steps.attrs["NSteps"] = self._steps["Values"].shape[0]

    def _add_cells(self, steps: _Growing, counts: np.ndarray) -> None:
        """Append a vertex a particle, and no other cells."""
        first_cells, first_numbers = [], []
        for kind in _CELL_KINDS:
            group = _Growing(self._root[kind])
            own = counts if kind == "Vertices" else np.zeros_like(counts)
            numbers = [np.arange(count) for count in own]
            ends = [np.arange(count + 1) for count in own]
            before = group.add("NumberOfCells", own)
            group.add("NumberOfConnectivityIds", own)
            first_numbers.append(group.add("Connectivity", np.concatenate([np.empty(0, np.int64), *numbers])))
            offsets = group.add("Offsets", np.concatenate([np.empty(0, np.int64), *ends]))
            first_cells.append(offsets - before)  # readers add one for each part before
        steps.add("CellOffsets", np.array([first_cells]))
        steps.add("ConnectivityIdOffsets", np.array([first_numbers]))

    def _add_data(self, name: str, parts: Iterable[np.ndarray], empty: np.ndarray) -> None:
        first = _Growing(self._root["PointData"]).add_parts(name, parts, empty)
        _Growing(self._steps["PointDataOffsets"]).add(name, np.array([first]))


class _Image:
    """The file of one level of the grid."""

    def __init__(self, file: Any, selection: Selection, level: Level) -> None:
        self._selection = selection
        self._lattice = level.interior, level.spacing, level.anchor
        self._cells = selection.cells(level)
        self._root = _root(file, "ImageData")
        low, high = self._cells
        extent = [end for pair in zip(low, high, strict=True) for end in pair]
        self._root.attrs.create("WholeExtent", np.array(extent, dtype=np.int64))
        self._root.attrs.create("Origin", np.array(level.anchor))
        self._root.attrs.create("Spacing", np.array(level.spacing))
        self._root.attrs.create("Direction", np.eye(3).ravel())
        self._steps = _steps_group(self._root)
        for data in ("PointData", "CellData"):
            self._root.create_group(data)
            self._steps.create_group(f"{data}Offsets")

    def add(self, step: int, level: Level, time: float) -> None:
        """Append a time step.

        Raises
        ------
        ArchiveError
            Where the level is not as in the first step.
        """
        if (level.interior, level.spacing, level.anchor) != self._lattice:
            message = f"level {level.index} is another grid at step {step} than in the first"
            raise ArchiveError(self._selection.archive.path, message, advice="write a .pvd, or fewer steps")
        _Growing(self._steps).add("Values", np.array([time]))
        hidden = hidden_cells(self._selection.archive.grid(step).levels, level, self._cells)
        if hidden.any():
            marks = (HIDDEN * hidden).astype(np.uint8).transpose(2, 1, 0)
            before = _Growing(self._root["CellData"]).add("vtkGhostType", marks[None])
            _Growing(self._steps["CellDataOffsets"]).add("vtkGhostType", np.array([before]))
        for material, found in self._selection.grid_fields(step, level.index):
            values = interior_values(found, self._cells)
            data = "PointData" if found.variable.container == NODE else "CellData"
            rows = values.transpose(2, 1, 0, *range(3, values.ndim))
            if values.ndim > 4:
                rows = rows.reshape(*rows.shape[:3], -1)
            name = f"{plain_title(found.variable.name)}_{material}"
            before = _Growing(self._root[data]).add(name, rows[None])
            _Growing(self._steps[f"{data}Offsets"]).add(name, np.array([before]))
        self._steps.attrs["NSteps"] = self._steps["Values"].shape[0]


def _root(file: Any, kind: str) -> Any:
    root = file.create_group("VTKHDF")
    root.attrs.create("Version", np.array([2, 0], dtype=np.int64))
    text = kind.encode("ascii")
    root.attrs.create("Type", text, dtype=f"S{len(text)}")
    return root


def _steps_group(root: Any) -> Any:
    group = root.create_group("Steps")
    group.attrs.create("NSteps", 0, dtype=np.int64)
    return group


def write(selection: Selection, out: Path, options: Options) -> list[Path]:
    """Write the selection; see the module for the names of the files."""
    h5py = _h5py(out)
    if not selection.has_particles and not selection.has_grid:
        raise ArchiveError(selection.archive.path, "there is no particle or grid variable to convert")
    out.parent.mkdir(parents=True, exist_ok=True)
    paths: list[Path] = []
    with ExitStack() as stack:

        def create(path: Path) -> Any:
            paths.append(path)
            return stack.enter_context(h5py.File(stack.enter_context(atomically(path)), "w"))

        particles = _Particles(create(out)) if selection.has_particles else None
        images: dict[int, _Image] = {}
        for done, timestep in enumerate(selection.timesteps, 1):
            if particles is not None:
                particles.add(selection.particles(timestep.step), timestep.time)
            for level in selection.archive.grid(timestep.step).levels if selection.has_grid else ():
                if not selection.cells(level).size:
                    continue
                if level.index not in images:
                    suffix = f"_l{level.index}" if level.index else ""
                    path = out.with_name(f"{out.stem}_grid{suffix}{out.suffix}")
                    images[level.index] = _Image(create(path), selection, level)
                images[level.index].add(timestep.step, level, timestep.time)
            options.progress(done, len(selection.timesteps))
    return paths


register(Format("VTKHDF", (".vtkhdf",), write))
