"""VTK XML for ParaView: particles as .vtp (or boxes as .vtu), grids as .vti, a .pvd that names them by time.

Data are appended to the XML as compressed binary. Names are those of Uintah without the ``p.`` or
``g.``; a grid variable carries its material behind (``mass_0``). Grids are written without their extra
cells; a node that a periodic level stores once appears on both sides; a face variable is given at the
cell, as the mean of its two faces there.
"""

from __future__ import annotations

import sys
import zlib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ups.archive import ArchiveError, Box, GridField, Level, Timestep
from ups.archive.markup import HEADER, attributes, number
from ups.archive.variables import ELEMENTS, FACES, NODE
from ups.convert.glyphs import box_corners
from ups.convert.registry import Format, Options, register
from ups.convert.selection import ParticleSet, Selection, as_rows, plain_title

_HEXAHEDRON = 12
"""VTK's number of this cell."""

_BLOCK = 1 << 20
_ZLIB_LEVEL = 1  # the next levels take twice the time for a few percent of most fields
_TYPES = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32", "i2": "Int16", "u1": "UInt8"}


_Entry = tuple[float, int, Path]
"""Time, part and file of a series."""


@dataclass
class _VtkFile:
    """A VTK XML file under construction: its arrays are compressed as they are added."""

    kind: str
    appended: list[bytes] = field(default_factory=list)
    offset: int = 0

    def array(
        self, name: str, values: np.ndarray, components: Sequence[str] = (), *, tuples: bool = False
    ) -> str:
        """Append an array of shape (n, ...) and return the element that describes it."""
        flat = np.ascontiguousarray(as_rows(values))
        described = {"type": _TYPES[flat.dtype.str[1:]], "Name": name, "NumberOfComponents": flat.shape[1]}
        described |= {f"ComponentName{i}": component for i, component in enumerate(components)}
        if tuples:
            described["NumberOfTuples"] = len(flat)
        described |= {"format": "appended", "offset": self.offset}
        for part in _compressed(flat):
            self.appended.append(part)
            self.offset += len(part)
        return f"<DataArray{attributes(**described)}/>"

    def save(self, path: Path, time: float, body: Sequence[str]) -> None:
        """Write the file; `body` are the lines inside the element called `kind`, including its tags."""
        stamp = self.array("TimeValue", np.array([time]), tuples=True)
        order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
        described = {"type": self.kind, "version": "1.0", "byte_order": order, "header_type": "UInt64"}
        lines = [HEADER, f"<VTKFile{attributes(**described, compressor='vtkZLibDataCompressor')}>"]
        lines += [body[0], f"<FieldData>{stamp}</FieldData>", *body[1:], '<AppendedData encoding="raw">']
        partial = path.with_name(path.name + ".partial")
        with partial.open("wb") as file:
            file.write(("\n".join(lines) + "\n_").encode())
            file.writelines(self.appended)
            file.write(b"\n</AppendedData>\n</VTKFile>\n")
        partial.replace(path)


def _compressed(flat: np.ndarray) -> list[bytes]:
    """VTK's compressed form: count and size of blocks, size of a short last one, compressed sizes, blocks."""
    raw = flat.data.cast("B") if flat.size else b""
    blocks = [zlib.compress(raw[start : start + _BLOCK], _ZLIB_LEVEL) for start in range(0, len(raw), _BLOCK)]
    header = np.array([len(blocks), _BLOCK, len(raw) % _BLOCK, *map(len, blocks)], dtype=np.uint64)
    return [header.tobytes(), *blocks]


def _write_particles(path: Path, particles: ParticleSet, time: float) -> None:
    """Write the particles of a time step as vertices."""
    file = _VtkFile("PolyData")
    points = file.array("Points", particles.positions, ELEMENTS["Point"].component_names)
    count = sum(particles.counts)
    connectivity = file.array("connectivity", np.arange(count))
    offsets = file.array("offsets", np.arange(1, count + 1))
    data = _particle_data(file, particles)
    piece = attributes(
        NumberOfPoints=count, NumberOfVerts=count, NumberOfLines=0, NumberOfStrips=0, NumberOfPolys=0
    )
    body = [
        "<PolyData>",
        f"<Piece{piece}>",
        "<PointData>",
        *data,
        "</PointData>",
        f"<Points>{points}</Points>",
        f"<Verts>{connectivity}{offsets}</Verts>",
        "</Piece>",
        "</PolyData>",
    ]
    file.save(path, time, body)


def _write_boxes(path: Path, particles: ParticleSet, time: float) -> None:
    """Write the particles of a time step as the boxes they fill, deformed as their material is."""
    file = _VtkFile("UnstructuredGrid")
    count = sum(particles.counts)
    corners = box_corners(particles.positions, particles.edges).reshape(-1, 3)
    points = file.array("Points", corners, ELEMENTS["Point"].component_names)
    cells = file.array("connectivity", np.arange(8 * count))
    cells += file.array("offsets", np.arange(8, 8 * count + 1, 8))
    cells += file.array("types", np.full(count, _HEXAHEDRON, dtype=np.uint8))
    body = [
        "<UnstructuredGrid>",
        f"<Piece{attributes(NumberOfPoints=8 * count, NumberOfCells=count)}>",
        "<CellData>",
        *_particle_data(file, particles),
        "</CellData>",
        f"<Points>{points}</Points>",
        f"<Cells>{cells}</Cells>",
        "</Piece>",
        "</UnstructuredGrid>",
    ]
    file.save(path, time, body)


def _particle_data(file: _VtkFile, particles: ParticleSet) -> list[str]:
    """Append the material and the selected variables of particles; return the elements that describe them."""
    data = [file.array("material", particles.material_indices)]
    for variable, values in particles.values():
        names = variable.element_type.component_names
        data.append(file.array(plain_title(variable.name), values, names))
    return data


def _write_grid(path: Path, selection: Selection, step: int, level: Level, time: float) -> None:
    """Write the grid variables of a level as an image with node and cell data."""
    file = _VtkFile("ImageData")
    nodes: list[str] = []
    cells: list[str] = []
    cells_box = selection.cells(level)
    for material, grid_field in selection.grid_fields(step, level.index):
        variable = grid_field.variable
        values = interior_values(grid_field, cells_box)
        by_x_first = values.transpose(2, 1, 0, *range(3, values.ndim))
        listing = nodes if variable.container == NODE else cells
        name, components = f"{plain_title(variable.name)}_{material}", variable.element_type.component_names
        listing.append(file.array(name, by_x_first.reshape(-1, *values.shape[3:]), components))
    low, high = cells_box
    extent = " ".join(f"{a} {b}" for a, b in zip(low, high, strict=True))
    origin, spacing = (" ".join(map(number, triple)) for triple in (level.anchor, level.spacing))
    image = attributes(WholeExtent=extent, Origin=origin, Spacing=spacing)
    body = [
        f"<ImageData{image}>",
        f"<Piece{attributes(Extent=extent)}>",
        "<PointData>",
        *nodes,
        "</PointData>",
        "<CellData>",
        *cells,
        "</CellData>",
        "</Piece>",
        "</ImageData>",
    ]
    file.save(path, time, body)


def interior_values(grid_field: GridField, cells: Box) -> np.ndarray:
    """Values at the nodes of a box of cells of the interior, or in them; of faces the mean of a cell's two."""
    container, level = grid_field.variable.container, grid_field.level
    faces = FACES.index(container) if container in FACES else None
    closing = [axis for axis in range(3) if container == NODE or axis == faces]
    values, (low, high) = grid_field.values, cells
    for axis in closing:
        if level.periodic[axis]:
            values = np.concatenate([values, values.take([0], axis=axis)], axis=axis)
    i, j, k = (high[axis] + (axis in closing) for axis in range(3))
    values = values[Box(low, (i, j, k)).within(grid_field.origin)]
    if faces is None:
        return values
    behind = values.take(range(values.shape[faces] - 1), axis=faces)
    ahead = values.take(range(1, values.shape[faces]), axis=faces)
    return (behind / 2 + ahead / 2).astype(values.dtype)


def _write_series(path: Path, entries: Sequence[_Entry]) -> None:
    """Write the .pvd that names files by time and part."""
    lines = [HEADER, '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">', "<Collection>"]
    for time, part, file in entries:
        href = file.relative_to(path.parent).as_posix()
        lines.append(f"<DataSet{attributes(timestep=number(time), group='', part=part, file=href)}/>")
    lines += ["</Collection>", "</VTKFile>"]
    partial = path.with_name(path.name + ".partial")
    partial.write_text("\n".join(lines) + "\n", encoding="utf-8")
    partial.replace(path)


def write(selection: Selection, out: Path, options: Options) -> list[Path]:
    """Write the selection for ParaView.

    ``x.pvd`` gets the particles, ``x_grid.pvd`` the grid, both with their files in the folder ``x``; a
    folder gets ``particles.pvd`` and ``grid.pvd``. A series is complete after every time step.
    """
    if out.suffix.lower() == ".pvd" and not out.is_dir():
        folder, series = (
            out.with_suffix(""),
            {"particles": out, "grid": out.with_name(f"{out.stem}_grid.pvd")},
        )
        if not selection.has_particles:
            series["grid"] = out
    else:
        folder, series = out, {kind: out / f"{kind}.pvd" for kind in ("particles", "grid")}
    if not selection.has_particles and not selection.has_grid:
        raise ArchiveError(selection.archive.path, "there is no particle or grid variable to convert")
    folder.mkdir(parents=True, exist_ok=True)
    entries: dict[str, list[_Entry]] = {"particles": [], "grid": []}
    with ThreadPoolExecutor(options.jobs) as pool:  # threads suffice: zlib runs outside Python's lock
        written = pool.map(
            lambda step: _write_step(selection, folder, step, options.glyphs), selection.timesteps
        )
        for done, step_entries in enumerate(written, 1):
            for kind, listed in entries.items():
                listed += step_entries[kind]
                if listed:
                    _write_series(series[kind], listed)
            options.progress(done, len(selection.timesteps))
    return [series[kind] for kind, listed in entries.items() if listed]


def _write_step(
    selection: Selection, folder: Path, timestep: Timestep, glyphs: bool
) -> dict[str, list[_Entry]]:
    """Write the files of one time step."""
    step, time = timestep.step, timestep.time
    entries: dict[str, list[_Entry]] = {"particles": [], "grid": []}
    if selection.has_particles:
        path = folder / f"particles_{step:05d}.{'vtu' if glyphs else 'vtp'}"
        write_particles = _write_boxes if glyphs else _write_particles
        write_particles(path, selection.particles(step), time)
        entries["particles"].append((time, 0, path))
    if selection.has_grid:
        for level in selection.archive.grid(step).levels:
            if selection.cells(level).size:
                path = folder / f"grid_l{level.index}_{step:05d}.vti"
                _write_grid(path, selection, step, level, time)
                entries["grid"].append((time, level.index, path))
    return entries


register(Format("VTK XML", (".pvd", ""), write))
